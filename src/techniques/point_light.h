// What a technique keeps for lwRenderPoints: the points, where their light goes, and the passes around its own gathers. A part of
// the techniques' frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "compute/report.h"
#include "inputs/output_target.h"
#include "inputs/points_input.h"
#include "passes/harmonics.h"
#include "techniques/technique.h"

namespace lightwell {

// A technique's light at points, which are given as images of rows. What is not wanted is empty. Validity, where wanted, is 1 at
// points that can be used when the gather gets it; one that has no light for some of them writes it anew.
class PointGather {
public:
    virtual ~PointGather() = default;
    virtual void recordIrradiance(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                  const Planes& validity, const Buffer& counts) = 0;
    // `normal` may be empty.
    virtual void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                 const Planes& validity, const Buffer& counts) = 0;
};

// Where the light goes.
class PointOutputs {
public:
    // The planes that kernels write, of count x 1 points, harmonics of count x 4; empty where not wanted.
    Planes irradiance, harmonics, validity;

    void begin(Executor& executor, const Points& points);
    void end(Executor& executor);
    void report(Report& report) const;
    std::uint64_t bytes() const;

private:
    std::array<OutputTarget, 3> targets_;
    std::uint32_t capacity_ = 0;
};
// Their planes in a part of the list.
Harmonics harmonicsOf(const PointRows& rows, const Planes& harmonics);

class PointLight {
public:
    explicit PointLight(Device& device);

    void startFrame() { isFresh_ = true; }  // once per update: counts are those of all calls since
    // From the host's images to the host's images.
    void render(Executor& executor, const Points& points, PointGather& gather);

    // Where a gather's counts (ints) stand: points whose light was brought down, and those that it has no light for.
    struct Counts {
        std::size_t saturated;
        std::optional<std::size_t> outside;
    };
    void report(Device& device, Report& report, const Counts& counts) const;
    std::uint64_t bytes() const;

private:
    void light(Executor& executor, PointGather& gather);

    PointsInput points_;
    PointOutputs outputs_;
    Buffer counts_, harmonicsCounts_, rejected_;
    std::uint64_t count_ = 0;  // of points since the last update
    bool isFresh_ = true;
};

// Of points: throws what lwRenderPoints says of bad images, and changes nothing.
void checkPoints(Device& device, const Points& points);

}  // namespace lightwell
