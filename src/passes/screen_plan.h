// How many samples each level of technique screen_space takes for an error target, frame by frame. Chosen on the device and read
// there: the host learns it with the stats only.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "passes/mip_pyramid.h"
#include "shared/screen_plan_types.h"

namespace lightwell {

struct ScreenPlanOptions {
    float error = 0.1f;  // relative, of the picture: above 0
    std::uint32_t samples = 64, levels = 4, interleave = 4;
    bool bounded = true;
};

class ScreenPlanPass {
public:
    explicit ScreenPlanPass(Device& device, const ScreenPlanOptions& options);

    // How often the samples may be halved: as often as patterns of 8 and more allow, at most LW_SCREEN_HALVINGS times.
    static std::uint32_t halvings(std::uint32_t samples);

private:
    friend class ScreenPlan;
    ScreenPlanOptions options_;
    Kernel &rows_, &probe_, &choose_;
};

// Of one picture.
class ScreenPlan {
public:
    explicit ScreenPlan(Device& device);

    // Passes "screen_plan.rows", ".probe", ".choose". pyramid: planes of senders, from the first level that is gathered on; radius: of
    // a level's ring in its texels; wholeDisc, wholeRing: sum of the numbers of samples with which the first level's disc and the
    // others' rings are taken whole.
    void record(Executor& executor, ScreenPlanPass& pass, const PyramidLevels& pyramid, double radius, std::uint32_t wholeDisc,
                std::uint32_t wholeRing);
    // Nothing is known of the frame before.
    void forget() { isKnown_ = false; }
    const Buffer& plan() const { return plan_; }  // int: samples of each level, 0 for none
    const Buffer& probed() const { return probed_; }  // LW_PROBED_FLOATS, by level

    // Counts and choices "samples_used" (of the first level) and "levels_used".
    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const { return plan_.bytes() + brightest_.bytes() + probed_.bytes(); }
    static std::uint64_t estimateBytes();

private:
    Buffer plan_, brightest_, probed_;
    bool isKnown_ = false;
};

// Level of a pyramid whose texels are asked, and every how many of them.
struct ProbedLevel {
    std::uint32_t level, step;
};
ProbedLevel probedLevel(std::uint32_t baseRows, std::uint32_t baseColumns, LevelRange range);
// The rings of `levels` levels from the first on, as texels of the probed one see them.
LwScreenRings screenRings(LevelRange range, std::uint32_t probed, double radius);

}  // namespace lightwell
