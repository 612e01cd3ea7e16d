// What pass `screen_plan` takes other starts and samples to miss, against serial twins in double precision; and that the gather
// and its filter do what a plan says.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "passes/screen_combine.h"
#include "passes/screen_pattern.h"
#include "passes/screen_plan.h"
#include "support/screen_corner.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr double kRadius = 6.3;
constexpr std::uint32_t kSamples = 64, kLevels = 3;

ScreenPlanOptions fullOptions() {
    ScreenPlanOptions options;
    options.start = 0;
    options.samples = kSamples;
    options.levels = kLevels;
    return options;
}

template <class T>
std::vector<T> read(const Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    buffer.download(0, count * sizeof(T), values.data());
    return values;
}

double planeOf(const std::vector<float>& probed, std::uint32_t k, std::uint32_t plane, std::uint32_t r) {
    return double(probed[(k * LW_PROBED_PLANES + plane) * LW_PROBES + r]);
}

// What receiver r loses of level k when each of its samples stands for `times` as much: linear in the logarithm between halvings.
double lossAt(const std::vector<float>& probed, std::uint32_t k, std::uint32_t r, double times) {
    const double c = std::min(std::log2(times), double(LW_PROBED_HALVINGS)), low = std::floor(c + 1e-9), part = c - low;
    const auto at = [&](double halving) { return halving < 0.5 ? 0.0 : planeOf(probed, k, LW_PROBED_LOSS + std::uint32_t(halving) - 1, r); };
    return at(low) + (part > 1e-6 ? part * (at(std::min(low + 1.0, double(LW_PROBED_HALVINGS))) - at(low)) : 0.0);
}

// Root of the mean square, by the mean of all light, that start `s` with the most samples loses.
double lostByStart(const std::vector<float>& probed, std::uint32_t s, std::uint32_t choice) {
    double square = 0.0, light = 0.0;
    for (std::uint32_t r = 0; r < LW_PROBES; ++r) {
        for (std::uint32_t k = 0; k < kLevels; ++k) light += planeOf(probed, k, LW_PROBED_LIGHT, r);
        double lost = 0.0;
        // A sample of the disc of level s stands for 4 pi r^2 / S of its texels, each of 4^(s - k) of level k's; one of a ring for 3 pi r^2 / S.
        for (std::uint32_t k = 0; k <= s; ++k)
            lost += lossAt(probed, k, r, std::pow(4.0, double(s - k)) * (k == 0 ? 1.0 : 4.0 / 3.0) * double(1u << choice));
        square += lost * lost;
    }
    return std::sqrt(square / LW_PROBES) * LW_PROBES / light;
}

}  // namespace

TEST_CASE("losses of coarser starts equal their serial twin", "[screen_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    ScreenCorner corner(rig, 131, 57, 4);
    ScreenPlanPass pass(rig.device(), fullOptions());
    ScreenPlan plan(rig.device());
    plan.record(rig.executor(), pass, corner.pyramid, kRadius, 0, 0);
    rig.device().finish();
    const auto probed = read<float>(plan.probed(), LW_PROBED_FLOATS), errors = read<float>(plan.errors(), LW_ERROR_FLOATS);
    for (std::uint32_t start = 0; start < 3; ++start)
        for (std::uint32_t choice = 0; choice <= (start < 2 ? LW_SCREEN_HALVINGS : 1u); ++choice) {
            CAPTURE(start, choice);
            const double got = double(errors[LW_ERROR_AT(start, start, LW_ERROR_LOST) + choice]);
            CHECK(got == Approx(lostByStart(probed, start, choice)).epsilon(2e-3).margin(1e-6));
            const double noise = double(errors[LW_ERROR_AT(start, start, LW_ERROR_NOISE) + choice]);
            // The most is what the others are held against. Half the samples have twice the variance.
            if (start == 0 && choice == 0) CHECK(noise == 0.0);
            if (choice > (start == 0 ? 1u : 0u))
                CHECK(noise == Approx(2.0 * double(errors[LW_ERROR_AT(start, start, LW_ERROR_NOISE) + choice - 1])).epsilon(1e-5));
        }
}

TEST_CASE("texels without a coarser one of their surface are counted", "[screen_plan]") {
    const std::uint32_t width = GENERATE(1u, 16u);
    KernelRig rig(width);
    ScreenCorner corner(rig, 131, 57, 4);
    // Columns that face elsewhere, too thin for coarse texels.
    for (std::uint32_t y = 0; y < corner.h; ++y)
        for (std::uint32_t x = 0; x < corner.w; ++x)
            if (x % 7 == 3 && reference::surfaceAt(corner.position, corner.normal, x, y).valid) corner.normal.set(x, y, {0.9, 0, 0});
    corner.n = rig.uploadPlanes(corner.normal.planes, corner.w, corner.h, 3, 1.0f);
    MipPyramid(rig.device(), ScreenGather::kExtras)
        .record(rig.executor(), rig.planes(corner.p, corner.w, corner.h, 3), rig.planes(corner.n, corner.w, corner.h, 3),
                rig.planes(corner.l, corner.w, corner.h, 3), {}, Camera(corner.camera.matrices(), corner.w, corner.h, "camera"),
                corner.pyramid, corner.counts);
    ScreenPlanPass pass(rig.device(), fullOptions());
    ScreenPlan plan(rig.device());
    plan.record(rig.executor(), pass, corner.pyramid, kRadius, 0, 0);
    rig.device().finish();
    int got[3] = {}, expected[3] = {};
    for (const cl_int item : read<cl_int>(plan.detail(), std::size_t(LW_DETAIL_COLUMNS) / width * LW_DETAIL_ROWS))
        for (int i = 0; i < 3; ++i) got[i] += (item >> (8 * i)) & 0xff;
    const auto fine = corner.level(0);
    for (std::uint32_t row = 0; row < LW_DETAIL_ROWS; ++row)
        for (std::uint32_t column = 0; column < LW_DETAIL_COLUMNS; ++column) {
            const std::uint32_t x = (2 * column + 1) * 131 / (2 * LW_DETAIL_COLUMNS), y = (2 * row + 1) * 57 / (2 * LW_DETAIL_ROWS);
            const auto s = reference::surfaceAt(fine.position, fine.normal, x, y);
            if (!s.valid) continue;
            ++expected[0];
            for (std::uint32_t k = 1; k < 3; ++k) {
                const auto coarse = corner.level(k);
                bool found = false;
                for (int j = -1; j <= 1; ++j)
                    for (int i = -1; i <= 1; ++i) {
                        const int tx = int(x >> k) + i, ty = int(y >> k) + j;
                        if (tx < 0 || ty < 0 || tx >= int(coarse.position.width) || ty >= int(coarse.position.height)) continue;
                        const auto q = reference::surfaceAt(coarse.position, coarse.normal, std::uint32_t(tx), std::uint32_t(ty));
                        found = found || (q.valid && reference::edgeWeight(s, q) > 0.0);
                    }
                expected[k] += !found;
            }
        }
    CHECK(got[0] == expected[0]);
    // Rounding decides at the slope of the edge test.
    for (int k = 1; k < 3; ++k) CHECK(std::abs(got[k] - expected[k]) <= 2);
    CHECK(expected[2] > 0);
}

TEST_CASE("gather and filter do what a plan says", "[screen_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    const std::uint32_t n = 4;
    ScreenCorner corner(rig, 131, 57, n);
    ScreenGather gather(rig.device(), n), planned(rig.device(), n, true);
    ScreenCombine combine(rig.device(), {n, 1, true, false, false}), plannedCombine(rig.device(), {n, 1, true, false, false, true});
    // Level 0 is left out, level 1 starts with half the samples, level 2 has a quarter.
    std::vector<cl_int> words(LW_SCREEN_PLAN_WORDS);
    words[LW_SCREEN_PLAN_START] = 1;
    words[LW_SCREEN_PLAN_SAMPLES + 1] = 32;
    words[LW_SCREEN_PLAN_SAMPLES + 2] = 16;
    const Guarded plan = rig.upload(words);
    std::vector<LwScreenSample> tables[2];
    for (std::uint32_t samples : {64u, 32u, 16u})
        for (int i = 0; i < 2; ++i) {
            const auto more = screenPatterns(i == 0 ? 0.0 : 3.0, 6.0, samples, n, 5);
            tables[i].insert(tables[i].end(), more.begin(), more.end());
        }
    const Guarded discs = rig.upload(tables[0]), rings = rig.upload(tables[1]);
    for (std::uint32_t k = 1; k < 3; ++k) {
        const Guarded own = rig.upload(screenPatterns(k == 1 ? 0.0 : 3.0, 6.0, k == 1 ? 32 : 16, n, 5));
        gather.recordDeal(rig.executor(), corner.pyramid, corner.levels, k);
        gather.recordGather(rig.executor(), corner.levels, k, own, k == 1 ? 32 : 16, true, corner.levels.other(k));
        combine.recordFilter(rig.executor(), corner.pyramid.level(k), false, corner.levels.other(k), corner.levels.own(k));
        rig.device().finish();
        const auto expected = corner.read(corner.levels.own(k)).planes;
        planned.recordDeal(rig.executor(), corner.pyramid, corner.levels, k, &static_cast<const Buffer&>(plan));
        planned.recordGather(rig.executor(), corner.levels, k, rings, discs, 64, true, corner.levels.other(k), plan);
        plannedCombine.recordFilter(rig.executor(), corner.pyramid.level(k), 0, 0, corner.levels.other(k), corner.levels.own(k), plan, k);
        rig.device().finish();
        CAPTURE(k);
        CHECK(bitDifference(corner.read(corner.levels.own(k)).planes, expected) == "");
    }
    gather.recordDeal(rig.executor(), corner.pyramid, corner.levels, 0);
    gather.recordGather(rig.executor(), corner.levels, 0, discs, 64, true, corner.levels.other(0));
    gather.recordGather(rig.executor(), corner.levels, 0, discs, 64, true, corner.levels.own(0));
    planned.recordGather(rig.executor(), corner.levels, 0, rings, discs, 64, true, corner.levels.other(0), plan);
    plannedCombine.recordFilter(rig.executor(), corner.pyramid.level(0), 0, 0, corner.levels.other(0), corner.levels.own(0), plan, 0);
    rig.device().finish();
    const auto none = corner.read(corner.levels.own(0)).planes;
    CHECK(std::all_of(none.begin(), none.end(), [](float v) { return v == 0.0f; }));
}
