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
                      kProbedBytes = LW_PROBED_FLOATS * sizeof(cl_float),
                      kDetailBytes = LW_DETAIL_COLUMNS * LW_DETAIL_ROWS * sizeof(cl_int),
                      kErrorBytes = LW_ERROR_FLOATS * sizeof(cl_float);

Defines definesOf(std::uint32_t levels) { return {{"LW_LEVELS", std::to_string(levels)}}; }

Defines askingDefines(const ScreenPlanOptions& options) {
    Defines defines = definesOf(options.levels);
    if (ScreenPlanPass::starts(options.start, options.levels) == 1) defines.push_back({"LW_ASKED_HALVINGS", std::to_string(LW_SCREEN_HALVINGS)});
    return defines;
}

// By LW_SCREEN_WHY_*.
constexpr const char* kStartReasons[] = {"the finest: a coarser one would miss more than the error target, or save nothing",
                                         "coarser than the finest: it meets the error target", "coarser than the finest: nothing is lit"};
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
      rows_(device.programs().kernel("screen_plan/screen_plan", "screen_plan_rows", askingDefines(options))),
      probe_(device.programs().kernel("screen_plan/screen_plan", "screen_plan_probe", askingDefines(options))),
      detail_(device.programs().kernel("screen_plan/screen_errors", "screen_plan_detail", definesOf(options.levels))),
      errors_(device.programs().kernel("screen_plan/screen_errors", "screen_plan_errors", definesOf(options.levels))),
      choose_(device.programs().kernel("screen_plan/screen_choose", "screen_plan_choose", definesOf(options.levels))) {
    if (!(options.error > 0.0f && std::isfinite(options.error)))
        fail(LW_ERROR_INVALID_ARGUMENT, "error: expected more than 0, got ", options.error);
}

std::uint32_t ScreenPlanPass::halvings(std::uint32_t samples) {
    std::uint32_t count = 0;
    while (count < LW_SCREEN_HALVINGS && (samples >> (count + 1)) >= kLeastSamples) ++count;
    return count;
}

std::uint32_t ScreenPlanPass::starts(std::uint32_t start, std::uint32_t levels) {
    return std::min<std::uint32_t>(levels, LW_START_QUARTER - std::min<std::uint32_t>(start, LW_START_QUARTER) + 1);
}

ScreenPlan::ScreenPlan(Device& device)
    : plan_(device, kPlanBytes, "plan of the frame"),
      brightest_(device, kRowBytes, "brightest texels"),
      probed_(device, kProbedBytes, "light of a few receivers"),
      detail_(device, kDetailBytes, "texels without a coarser one"),
      errors_(device, kErrorBytes, "errors of other choices") {}

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
    // Of a picture of another size nothing is known.
    if (first.width != width_ || first.height != height_) isKnown_ = false;
    width_ = first.width;
    height_ = first.height;
    executor.run("screen_plan.rows", pass.rows_, {(level.height + probed.step - 1) / probed.step, 1}, {4, 1}, level, width, height, step,
                 brightest_);
    const std::uint32_t turns = isKnown_ ? LW_PROBE_TURNS : 1, turn = turn_ % turns;
    executor.run("screen_plan.probe", pass.probe_, {LW_PROBE_COLUMNS / pass.probe_.width(), LW_PROBE_ROWS / turns}, {1, 1},
                 level, width, height, step, brightest_, cl_int(options.samples), options.bounded ? kBound : 0.0f, rings,
                 cl_int(turn), cl_int(turns), probed_);
    const std::uint32_t starts = ScreenPlanPass::starts(options.start, options.levels);
    const auto coarser = [&](std::uint32_t steps) {
        const Planes p = pyramid.level(std::min(range.first + steps, range.last));
        return cl_int4{{cl_int(p.offset), cl_int(p.rowStride), cl_int(p.planeStride), 0}};
    };
    const std::uint32_t detailItems = LW_DETAIL_COLUMNS / pass.detail_.width();
    executor.run("screen_plan.detail", pass.detail_, {detailItems, LW_DETAIL_ROWS / turns}, {1, 1}, first, cl_int(first.width),
                 cl_int(first.height), coarser(1), coarser(2), cl_int(starts), cl_int(turn), cl_int(turns), detail_);
    executor.run("screen_plan.errors", pass.errors_, {options.levels, starts}, {1, 1}, probed_, rings, cl_int(options.samples),
                 cl_int(options.interleave * options.interleave), cl_int(wholeDisc), cl_int(wholeRing), cl_int(starts), errors_);
    executor.run("screen_plan.choose", pass.choose_, {1, 1}, {1, 1}, errors_, detail_, cl_int(detailItems * LW_DETAIL_ROWS),
                 cl_int(options.samples), cl_int(ScreenPlanPass::halvings(options.samples)), cl_int(starts), cl_int(options.start),
                 options.error, cl_int(isKnown_ ? 0 : 1), plan_);
    turn_ = isKnown_ ? turn_ + 1 : 0;
    isKnown_ = true;
}

void ScreenPlan::report(Device& device, Report& report) const {
    if (!isKnown_) return;
    const auto read = [&](const char* name, int count, int why, const char* const* reasons) {
        report.read(device, name, plan_, std::size_t(count) * sizeof(cl_int));
        report.readChoice(device, name, plan_, std::size_t(why) * sizeof(cl_int), reasons, LW_SCREEN_WHY_DARK + 1);
    };
    read("start_used", LW_SCREEN_PLAN_START_USED, LW_SCREEN_PLAN_WHY_START, kStartReasons);
    read("samples_used", LW_SCREEN_PLAN_FIRST, LW_SCREEN_PLAN_WHY_SAMPLES, kSampleReasons);
    read("levels_used", LW_SCREEN_PLAN_USED, LW_SCREEN_PLAN_WHY_LEVELS, kLevelReasons);
    report.read(device, "auto_lost_permille", plan_, LW_SCREEN_PLAN_LOST * sizeof(cl_int));
    report.read(device, "auto_noise_permille", plan_, LW_SCREEN_PLAN_NOISE * sizeof(cl_int));
    report.read(device, "auto_detail_permille", plan_, LW_SCREEN_PLAN_DETAIL * sizeof(cl_int));
}

std::uint64_t ScreenPlan::estimateBytes() {
    return kPlanBytes + kRowBytes + kProbedBytes + kDetailBytes + kErrorBytes;
}

}  // namespace lightwell
