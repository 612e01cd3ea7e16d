// Technique fallback's light at points: both techniques' at all of them, joined as pixels are.
#pragma once

#include <cstdint>

#include "techniques/point_light.h"

namespace lightwell {

// Planes of the device as an image that techniques write in place.
LWImage imageOver(const Planes& planes, LWFormat format);

class FallbackPoints {
public:
    FallbackPoints(Device& device, Kernel& join);

    void startFrame() { isFresh_ = true; }
    void render(Executor& executor, const Points& points, Technique& first, Technique& second);

    // Launches what joins in two bands, and what techniques alone do not.
    void exercise(Executor& executor) const;

    void report(Report& report) const;  // saturated_points
    std::uint64_t bytes() const;

private:
    // One technique's light, kept on the device; memory only for what has been asked for.
    struct Part {
        PlanarImage irradiance, harmonics, validity;
        std::uint64_t bytes() const { return irradiance.bytes() + harmonics.bytes() + validity.bytes(); }
    };
    LWPointOutput reserve(Part& part, const Points& points);
    void join(Executor& executor, std::uint32_t count);
    void joinHarmonics(Executor& executor, const Planes& validity, const Harmonics& first, const Harmonics& second,
                       const Harmonics& sum) const;

    Device& device_;
    Kernel &join_, &joinHarmonics_;
    Part first_, second_;
    PointOutputs outputs_;
    Buffer saturated_;
    bool isFresh_ = true;
};

}  // namespace lightwell
