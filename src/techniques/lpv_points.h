// Technique lpv's light at points: what its volume gives surfaces at full resolution, and places without one.
#pragma once

#include "techniques/lpv_volume.h"
#include "techniques/point_light.h"

namespace lightwell {

class LpvPoints final : private PointGather {
public:
    explicit LpvPoints(Device& device) : device_(device), light_(device) {}

    void startFrame() { light_.startFrame(); }
    void render(Executor& executor, const Points& points, LpvVolume& volume) {
        volume_ = &volume;
        light_.render(executor, points, *this);
    }

    void report(Report& report) const { light_.report(device_, report, {1, 2}); }
    std::uint64_t bytes() const { return light_.bytes(); }

private:
    void recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                          const Planes& validity, const Buffer& counts) override {
        volume_->recordGather(executor, position, normal, irradiance, validity, counts);
    }
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts) override {
        volume_->recordHarmonics(executor, position, normal, harmonics, validity, counts);
    }

    Device& device_;
    PointLight light_;
    LpvVolume* volume_ = nullptr;  // of the call
};

}  // namespace lightwell
