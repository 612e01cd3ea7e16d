// Where technique screen_space starts and how many samples each of its levels takes for an error target, frame by frame. Chosen on
// the device and read there: the host learns it with the stats only.
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
    std::uint32_t start = 0, samples = 64, levels = 4, interleave = 4;  // start: the finest, as LWStart
    bool bounded = true;
};

class ScreenPlanPass {
public:
    explicit ScreenPlanPass(Device& device, const ScreenPlanOptions& options);

    // How often the samples may be halved: as often as patterns of 8 and more allow, at most LW_SCREEN_HALVINGS times.
    static std::uint32_t halvings(std::uint32_t samples);
    // Starts that there are: the finest, and coarser ones down to a quarter of the picture's resolution.
    static std::uint32_t starts(std::uint32_t start, std::uint32_t levels);

private:
    friend class ScreenPlan;
    ScreenPlanOptions options_;
    Kernel &rows_, &probe_, &detail_, &errors_, &choose_;
};

// Of one picture.
class ScreenPlan {
public:
    explicit ScreenPlan(Device& device);

    // Passes "screen_plan.rows", ".probe", ".detail", ".errors", ".choose". pyramid: planes of senders, from the first level that is gathered on; radius: of
    // a level's ring in its texels; wholeDisc, wholeRing: sum of the numbers of samples with which the first level's disc and the
    // others' rings are taken whole.
    void record(Executor& executor, ScreenPlanPass& pass, const PyramidLevels& pyramid, double radius, std::uint32_t wholeDisc,
                std::uint32_t wholeRing);
    // Nothing is known of the frame before.
    void forget() { isKnown_ = false; }
    const Buffer& plan() const { return plan_; }      // int: LW_SCREEN_PLAN_*
    const Buffer& probed() const { return probed_; }  // LW_PROBED_FLOATS, by level
    const Buffer& detail() const { return detail_; }  // int: of work-items of LW_WIDTH texels
    const Buffer& errors() const { return errors_; }  // LW_ERROR_FLOATS

    // Counts and choices "start_used" (LWStart), "samples_used" (of the first level used) and "levels_used"; counts
    // "auto_lost_permille", "auto_noise_permille" and "auto_detail_permille": what the choice is taken to cost, in thousandths of the picture's light.
    void report(Device& device, Report& report) const;
    std::uint64_t bytes() const {
        return plan_.bytes() + brightest_.bytes() + probed_.bytes() + detail_.bytes() + errors_.bytes();
    }
    static std::uint64_t estimateBytes();

private:
    Buffer plan_, brightest_, probed_, detail_, errors_;
    bool isKnown_ = false;
    std::uint32_t width_ = 0, height_ = 0;  // of the picture that is known
    std::uint32_t turn_ = 0;  // of LW_PROBE_TURNS, of the receivers that are asked next
};

// Level of a pyramid whose texels are asked, and every how many of them.
struct ProbedLevel {
    std::uint32_t level, step;
};
ProbedLevel probedLevel(std::uint32_t baseRows, std::uint32_t baseColumns, LevelRange range);
// The rings of `levels` levels from the first on, as texels of the probed one see them.
LwScreenRings screenRings(LevelRange range, std::uint32_t probed, double radius);

}  // namespace lightwell
