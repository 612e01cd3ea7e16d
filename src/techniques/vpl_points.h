// Light of VPLs at points: of all VPLs at each, without interleaving, filter or history.
#pragma once

#include "passes/interleaved_gather.h"
#include "techniques/point_light.h"

namespace lightwell {

class VplPoints final : private PointGather {
public:
    explicit VplPoints(Device& device);

    void startFrame() { light_.startFrame(); }
    // vpls: lw_vpl by slot, dealt out as `order` says.
    void render(Executor& executor, const Points& points, const Buffer& vpls, lw_subset_order order);

    void report(Report& report) const { light_.report(device_, report, {2, {}}); }
    std::uint64_t bytes() const { return light_.bytes() + tiles_.bytes(); }

private:
    void recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                          const Planes& validity, const Buffer& counts) override;
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts) override;

    Device& device_;
    PointLight light_;
    InterleavedGather gather_;
    VplHarmonics harmonics_;
    VplTiles tiles_;
    const Buffer* vpls_ = nullptr;  // of the call
    lw_subset_order order_{};
};

}  // namespace lightwell
