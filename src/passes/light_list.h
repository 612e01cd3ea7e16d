// Static VPLs that are strong enough as lists of VPLs, and these as no more than so many lights.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "passes/world_shift.h"
#include "shared/static_vpl_types.h"
#include "shared/subset_order.h"

namespace lightwell {

struct LightListOptions {
    float threshold = 1e-3f;    // of a VPL's intensity
    bool relative = true;       // ... as a share of the frame's strongest, else W/sr
    float hysteresis = 2.0f;    // how much stronger a VPL must be to come back
    std::uint32_t subsets = 1;  // of the gather
    std::uint32_t lights = 16;  // at most
};

class LightList {
public:
    LightList(Device& device, const LightListOptions& options);

    // Of a frame with so many VPLs beside the static ones. lists: 2 where receivers with baked light get
    // others.
    void reserve(std::uint32_t places, std::uint32_t others, std::uint32_t lists);
    // Pass "light_list.cull": static VPLs that are strong enough, first in the lists; slots of the
    // others are emptied. restart: what was kept in the frame before is no matter.
    void recordCull(Executor& executor, const Buffer& inputs, const lw_static_frame& frame,
                    const Buffer& lit, bool restart);
    // Pass "light_list.sites", once the lists are whole, of lists for one subset: from where the first
    // `count` VPLs look, each raised off its surface by `lift` radii of its disc, as VPLs of the same
    // numbers; without flux those that are out.
    void recordSites(Executor& executor, std::uint32_t count, float lift, const Buffer& sites);
    // Passes "light_list.assign", ".begin", ".sum", once the lists are whole: the lights of this frame.
    // diagonal: of the places, m.
    void recordLights(Executor& executor, double diagonal);

    const Buffer& vpls() const { return vpls_; }  // lw_vpl by slot
    const Buffer& baked() const {
        return lists_ > 1 ? baked_ : vpls_;
    }  // for receivers with baked light
    std::uint32_t lists() const { return lists_; }
    lw_subset_order order() const { return order_; }
    const Buffer& listed() const { return listed_; }  // lw_listed_light, options.lights of them
    std::uint64_t bytes() const;
    // Of the lists; recordLights, where it is asked for, takes more.
    static std::uint64_t estimateBytes(const LightListOptions& options, std::uint32_t places,
                                       std::uint32_t others, std::uint32_t lists);
    static lw_subset_order orderOf(const LightListOptions& options, std::uint32_t places,
                                   std::uint32_t others);

private:
    Device& device_;
    LightListOptions options_;
    Kernel &cull_, &sites_, &assign_, &begin_, &sum_;
    Buffer kept_, vpls_, baked_;
    Buffer centres_, assignment_, losses_, listed_;
    lw_subset_order order_{};
    std::uint32_t lists_ = 1;
    std::uint32_t places_ = ~0u;  // whose states kept_ holds
    bool centresKnown_ = false;
    KeptPlaces follows_;  // centres_
};

}  // namespace lightwell
