// Technique cone_tracing's light at points: all cones at each, and at places without a surface those of the whole sphere.
#pragma once

#include "passes/cone_gather.h"
#include "techniques/point_light.h"

namespace lightwell {

class ConeTracingPoints final : private PointGather {
public:
    ConeTracingPoints(Device& device, const ConeGatherOptions& options) : device_(device), light_(device), gather_(device, whole(options)) {}

    void startFrame() { light_.startFrame(); }
    void render(Executor& executor, const Points& points, const ConeWorld& world) {
        world_ = &world;
        light_.render(executor, points, *this);
        world_ = nullptr;
    }

    void report(Report& report) const { light_.report(device_, report, {1, 2}); }
    std::uint64_t bytes() const { return light_.bytes() + gather_.bytes(); }

private:
    // A list has no neighbours that cones could be shared out to.
    static ConeGatherOptions whole(ConeGatherOptions options) {
        options.interleaved = false;
        return options;
    }
    void recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                          const Planes& validity, const Buffer& counts) override {
        gather_.recordTrace(executor, position, normal, *world_, irradiance, validity, {}, counts);
    }
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts) override {
        gather_.recordHarmonics(executor, position, normal, *world_, harmonics, validity, counts);
    }

    Device& device_;
    PointLight light_;
    ConeGather gather_;
    const ConeWorld* world_ = nullptr;  // of the call
};

}  // namespace lightwell
