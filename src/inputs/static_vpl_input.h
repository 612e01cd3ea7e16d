// A frame's static VPLs, the lights that light them and the spheres that block, in one array on the
// device.
#pragma once

#include <cstdint>
#include <vector>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/frame_shape.h"
#include "lightwell/lightwell.h"
#include "shared/static_vpl_types.h"

namespace lightwell {

class StaticVplInput {
public:
    static constexpr std::uint32_t kMostBlockers = 1024;

    // Throws INVALID_ARGUMENT naming what a frame has too much of, and lights that cannot be used.
    static void check(const LWFrame& frame);
    // Records the copy (pass "static_vpl_input.upload"). unitArea: of a weight of 1. automatic: no place
    // has an area of its own. phantoms: of spot lights that then light no static VPL.
    void import(Executor& executor, const LWFrame& frame, float unitArea, bool automatic,
                const std::vector<lw_phantom>& phantoms);

    const Buffer& memory() const { return memory_; }
    const lw_static_frame& frame() const { return frame_; }
    bool anyAutomatic() const { return anyAutomatic_; }  // some place goes by its distance to others
    // Some lights or places are not for all receivers: those with baked light have a list of VPLs of
    // their own.
    bool bakedReceivers() const { return bakedReceivers_; }
    double diagonal() const { return diagonal_; }  // of the places' bounding box, m
    double meanSide() const { return meanSide_; }
    std::uint64_t bytes() const { return memory_.bytes(); }
    static std::uint64_t estimateBytes(const FrameShape& shape, bool phantoms);

private:
    void packPlaces(const LWFrame& frame, float unitArea);
    void packLights(const LWFrame& frame, const std::vector<lw_phantom>& phantoms);
    void measure(const LWFrame& frame);

    Buffer memory_;
    std::vector<float> packed_;
    lw_static_frame frame_{};
    bool anyAutomatic_ = false, bakedReceivers_ = false;
    double diagonal_ = 0.0, meanSide_ = 0.0;
};

}  // namespace lightwell
