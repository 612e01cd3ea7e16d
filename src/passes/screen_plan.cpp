#include "passes/screen_plan.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "compute/device.h"
#include "compute/error.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kLeastSamples = 8;  // that screen_gather has patterns of
// Rows that a level must have for its texels to tell a ring's inside from its outside: at 720 rows and the default radius the first disc
// has a radius of 2.5 texels.
constexpr std::uint32_t kLeastRows = 40;
constexpr std::size_t kPlanBytes = LW_SCREEN_PLAN_WORDS * sizeof(cl_int), kRowBytes = LW_PROBE_MOST_ROWS * sizeof(cl_float),
                      kProbedBytes = LW_PROBED_FLOATS * sizeof(cl_float);

Defines definesOf(std::uint32_t levels) { return {{"LW_LEVELS", std::to_string(levels)}}; }

// By LW_SCREEN_WHY_*.
constexpr const char* kSampleReasons[] = {"the most: the error target would take as many or more", "fewer than the most: they meet the error target",
                                          "fewer than the most: nothing is lit"};
constexpr const char* kLevelReasons[] = {"the most: each brings light or shows more of the hemisphere than the error target",
                                         "fewer than the most: the others bring less than the error target",
                                         "fewer than the most: nothing is lit"};

}  // namespace

ProbedLevel probedLevel(std::uint32_t baseRows, std::uint32_t baseColumns, LevelRange range) {
    std::uint32_t level = range.first;
    while (level < range.last && levelSize(baseRows, level + 1) >= kLeastRows) ++level;
    const std::uint32_t rows = levelSize(baseRows, level), columns = levelSize(baseColumns, level);
    const std::uint32_t byRows = (rows + LW_PROBE_MOST_ROWS - 1) / LW_PROBE_MOST_ROWS;
    // Twice as wide as high at most: a panorama's columns are stepped over, too.
    const std::uint32_t byColumns = (columns + 2 * LW_PROBE_MOST_ROWS - 1) / (2 * LW_PROBE_MOST_ROWS);
    return {level, std::max(byRows, byColumns)};
}

LwScreenRings screenRings(LevelRange range, std::uint32_t probed, double radius) {
    LwScreenRings rings{};
    for (std::uint32_t k = 0; k <= range.last - range.first; ++k) {
        const double size = std::ldexp(1.0, int(range.first + k) - int(probed));  // of a texel
        rings.outer2[k] = float(std::pow(2.0 * radius * size, 2.0));
        rings.texels[k] = float((k == 0 ? 4.0 : 3.0) * kPi * radius * radius);
        rings.area[k] = float(double(rings.texels[k]) * size * size);
    }
    return rings;
}

ScreenPlanPass::ScreenPlanPass(Device& device, const ScreenPlanOptions& options)
    : options_(options),
      rows_(device.programs().kernel("screen_plan/screen_plan", "screen_plan_rows", definesOf(options.levels))),
      probe_(device.programs().kernel("screen_plan/screen_plan", "screen_plan_probe", definesOf(options.levels))),
      choose_(device.programs().kernel("screen_plan/screen_choose", "screen_plan_choose", definesOf(options.levels))) {
    if (!(options.error > 0.0f && std::isfinite(options.error)))
        fail(LW_ERROR_INVALID_ARGUMENT, "error: expected more than 0, got ", options.error);
}

std::uint32_t ScreenPlanPass::halvings(std::uint32_t samples) {
    std::uint32_t count = 0;
    while (count < LW_SCREEN_HALVINGS && (samples >> (count + 1)) >= kLeastSamples) ++count;
    return count;
}

ScreenPlan::ScreenPlan(Device& device)
    : plan_(device, kPlanBytes, "plan of the frame"),
      brightest_(device, kRowBytes, "brightest texels"),
      probed_(device, kProbedBytes, "light of a few receivers") {}

void ScreenPlan::record(Executor& executor, ScreenPlanPass& pass, const PyramidLevels& pyramid, double radius, std::uint32_t wholeDisc,
                        std::uint32_t wholeRing) {
    constexpr float kBound = 0.25f / float(kPi);
    const ScreenPlanOptions& options = pass.options_;
    const LevelRange range{pyramid.options().firstLevel, pyramid.options().firstLevel + options.levels - 1};
    const Planes first = pyramid.level(range.first);
    const ProbedLevel probed = probedLevel(first.height << range.first, first.width << range.first, range);
    const Planes level = pyramid.level(probed.level);
    const cl_int width = cl_int(level.width), height = cl_int(level.height), step = cl_int(probed.step);
    const LwScreenRings rings = screenRings(range, probed.level, radius);
    executor.run("screen_plan.rows", pass.rows_, {(level.height + probed.step - 1) / probed.step, 1}, {4, 1}, level, width, height, step,
                 brightest_);
    executor.run("screen_plan.probe", pass.probe_, {LW_PROBE_COLUMNS / pass.probe_.width(), LW_PROBE_ROWS}, {1, 1}, level, width, height,
                 step, brightest_, cl_int(options.samples), options.bounded ? kBound : 0.0f, rings, probed_);
    executor.run("screen_plan.choose", pass.choose_, {1, 1}, {1, 1}, probed_, rings, cl_int(options.samples),
                 cl_int(ScreenPlanPass::halvings(options.samples)), cl_int(options.interleave * options.interleave), cl_int(wholeDisc),
                 cl_int(wholeRing), options.error,
                 cl_int(isKnown_ ? 0 : 1), plan_);
    isKnown_ = true;
}

void ScreenPlan::report(Device& device, Report& report) const {
    if (!isKnown_) return;
    const auto read = [&](const char* name, int count, int why, const char* const* reasons) {
        report.read(device, name, plan_, std::size_t(count) * sizeof(cl_int));
        report.readChoice(device, name, plan_, std::size_t(why) * sizeof(cl_int), reasons, LW_SCREEN_WHY_DARK + 1);
    };
    read("samples_used", LW_SCREEN_PLAN_FIRST, LW_SCREEN_PLAN_WHY_SAMPLES, kSampleReasons);
    read("levels_used", LW_SCREEN_PLAN_USED, LW_SCREEN_PLAN_WHY_LEVELS, kLevelReasons);
}

std::uint64_t ScreenPlan::estimateBytes() { return kPlanBytes + kRowBytes + kProbedBytes; }

}  // namespace lightwell
