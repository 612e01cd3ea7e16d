// What pass `screen_plan` asks a few receivers, against its serial twin in double precision; and what it makes of it.
#include "passes/screen_plan.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/screen_corner.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr double kPi = 3.14159265358979323846, kRadius = 3.3;  // no texel's middle lies on a ring's edge

// start: a quarter has no coarser one.
ScreenPlanOptions optionsOf(float error, std::uint32_t samples, std::uint32_t levels, bool bounded = true, std::uint32_t start = LW_START_FULL) {
    ScreenPlanOptions options;
    options.error = error;
    options.start = start;
    options.samples = samples;
    options.levels = levels;
    options.bounded = bounded;
    return options;
}

std::vector<float> probedBy(ScreenPlan& plan) {
    std::vector<float> probed(LW_PROBED_FLOATS);
    plan.probed().download(0, probed.size() * sizeof(float), probed.data());
    return probed;
}

std::vector<cl_int> planOf(ScreenPlan& plan) {
    std::vector<cl_int> words(LW_SCREEN_PLAN_WORDS);
    plan.plan().download(0, words.size() * sizeof(cl_int), words.data());
    return words;
}

// One receiver and one level: planes as LW_PROBED_*.
struct Twin {
    double of[LW_PROBED_PLANES] = {};
};

struct Asked {
    const reference::ScreenLevel level;
    std::uint32_t step, samples;
    double size;  // of the level's texels in those that are asked
    bool bounded;
    double brightest = 0.0;

    double radiance(std::uint32_t x, std::uint32_t y) const {
        const reference::Vec l = level.radiance.get(x, y);
        return (l.x + l.y + l.z) / 3.0;
    }
    Twin twin(std::uint32_t rx, std::uint32_t ry, bool isDisc) const {
        Twin sum;
        const reference::Surface s = reference::surfaceAt(level.position, level.normal, rx, ry);
        if (!s.valid) return sum;
        const double ring = (isDisc ? 4.0 : 3.0) * kPi * kRadius * kRadius;
        for (std::uint32_t y = 0; y < level.position.height; y += step)
            for (std::uint32_t x = 0; x < level.position.width; x += step) {
                const double off = std::hypot(double(x) - rx, double(y) - ry) / size;
                if (off >= 2.0 * kRadius || (!isDisc && off < kRadius)) continue;
                const auto q = reference::surfaceAt(level.position, level.normal, x, y);
                const double area = std::max(0.0, double(level.area[level.position.at(x, y)]));
                const reference::Vec to = q.position - s.position;
                const double d2 = dot(to, to), d = std::sqrt(d2);
                if (!q.valid || d == 0.0) continue;
                const double c = std::max(0.0, dot(to, s.normal) / d), cp = std::max(0.0, -dot(to, q.normal) / d);
                double w[LW_PROBED_HALVINGS + 1];
                for (int i = 0; i <= LW_PROBED_HALVINGS; ++i) {
                    const double stands = std::max(ring * (1 << i) / samples, 1.0) * size * size * area;
                    w[i] = c * cp * area / (d2 + (bounded ? 0.25 * (1.0 + 3.0 * cp * cp) * stands / kPi : 0.0));
                }
                const double l = brightest > 0.0 ? radiance(x, y) / brightest : 0.0, n = step * step;
                sum.of[LW_PROBED_LIGHT] += n * w[0] * l;
                for (int i = 0; i < LW_PROBED_HALVINGS; ++i) sum.of[LW_PROBED_LOSS + i] += n * (w[0] - w[i + 1]) * l;
                sum.of[LW_PROBED_SQUARES] += n * w[0] * w[0] * l * l;
                sum.of[LW_PROBED_SHARE] += n * w[0] / kPi;
            }
        return sum;
    }
};

}  // namespace

TEST_CASE("what receivers are told equals its serial twin", "[screen_plan]") {
    const auto width = GENERATE(1u, 16u);
    const auto size = testSize(GENERATE(std::make_pair(1u, 1u), std::make_pair(131u, 57u), std::make_pair(60u, 160u)));
    const std::uint32_t levels = GENERATE(1u, 3u);
    const bool bounded = GENERATE(true, false);
    CAPTURE(width, size.first, size.second, levels, bounded);
    KernelRig rig(width);
    ScreenCorner corner(rig, size.first, size.second, 4);
    ScreenPlanPass pass(rig.device(), optionsOf(0.1f, 64, levels, bounded));
    ScreenPlan plan(rig.device());
    plan.record(rig.executor(), pass, corner.pyramid, kRadius, 0, 0);
    rig.device().finish();
    const std::vector<float> probed = probedBy(plan);
    const ProbedLevel at = probedLevel(size.second, size.first, {0, levels - 1});
    const auto level = corner.level(at.level);
    const std::uint32_t w = level.position.width, h = level.position.height;
    double worst = 0.0;
    // Without a coarser start nobody wants to know more than the halvings that may be chosen.
    const int halvings = levels == 1 ? LW_SCREEN_HALVINGS : LW_PROBED_HALVINGS;
    for (std::uint32_t k = 0; k < levels; ++k) {
        Asked asked{level, at.step, 64, std::ldexp(1.0, int(k) - int(at.level)), bounded};
        for (std::uint32_t y = 0; y < h; y += at.step)
            for (std::uint32_t x = 0; x < w; x += at.step) asked.brightest = std::max(asked.brightest, asked.radiance(x, y));
        for (std::uint32_t r = 0; r < LW_PROBES; ++r) {
            const std::uint32_t column = r % LW_PROBE_COLUMNS, row = r / LW_PROBE_COLUMNS;
            const Twin twin = asked.twin((2 * column + 1) * w / (2 * LW_PROBE_COLUMNS), (2 * row + 1) * h / (2 * LW_PROBE_ROWS), k == 0);
            for (int p = 0; p < LW_PROBED_PLANES; ++p) {
                if (p >= LW_PROBED_LOSS + halvings && p < LW_PROBED_SQUARES) continue;
                const double got = double(probed[(k * LW_PROBED_PLANES + std::uint32_t(p)) * LW_PROBES + r]);
                // Losses are differences of what is lit: their rounding is its.
                const bool isLoss = p >= LW_PROBED_LOSS && p < LW_PROBED_SQUARES;
                const double scale = std::max(isLoss ? twin.of[LW_PROBED_LIGHT] : twin.of[p], 1e-9);
                worst = std::max(worst, std::abs(got - twin.of[p]) / scale);
            }
        }
    }
    CHECK(worst < 1e-4);
}

TEST_CASE("in so many frames all receivers are asked, each once", "[screen_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    ScreenCorner corner(rig, 131, 57, 4);
    ScreenPlanPass pass(rig.device(), optionsOf(0.1f, 64, 3));
    ScreenPlan plan(rig.device()), other(rig.device());
    const auto ask = [&](ScreenPlan& p, double radius) {
        p.record(rig.executor(), pass, corner.pyramid, radius, 0, 0);
        rig.device().finish();
        std::vector<float> probed = probedBy(p);
        probed.resize(3 * LW_PROBED_PLANES * LW_PROBES);
        return probed;
    };
    const std::vector<float> before = ask(plan, kRadius), after = ask(other, 1.7);
    for (std::size_t turn = 0; turn < LW_PROBE_TURNS; ++turn) {
        const std::vector<float> now = ask(plan, 1.7);
        for (std::size_t i = 0; i < now.size(); ++i) {
            const std::size_t row = i % LW_PROBES / LW_PROBE_COLUMNS;
            if (now[i] != (row % LW_PROBE_TURNS <= turn ? after[i] : before[i])) FAIL("turn " << turn << ", row " << row);
        }
    }
    plan.forget();
    CHECK(bitDifference(ask(plan, kRadius), before) == "");
    // Nothing is known of a picture of another size, either.
    ScreenCorner small(rig, 60, 33, 4);
    ScreenPlan fresh(rig.device());
    const auto askSmall = [&](ScreenPlan& p) {
        p.record(rig.executor(), pass, small.pyramid, kRadius, 0, 0);
        rig.device().finish();
        std::vector<float> probed = probedBy(p);
        probed.resize(3 * LW_PROBED_PLANES * LW_PROBES);
        return probed;
    };
    const std::vector<float> known = askSmall(plan);
    CHECK(bitDifference(known, askSmall(fresh)) == "");
}

TEST_CASE("the same plan and bits at every width and in every run", "[screen_plan]") {
    std::vector<float> first;
    std::vector<cl_int> words;
    for (const std::uint32_t width : {1u, 4u, 8u, 16u, 16u}) {
        KernelRig rig(width);
        ScreenCorner corner(rig, 131, 57, 4);
        ScreenPlanPass pass(rig.device(), optionsOf(0.2f, 256, 3));
        ScreenPlan plan(rig.device());
        plan.record(rig.executor(), pass, corner.pyramid, kRadius, 0, 0);
        rig.device().finish();
        std::vector<float> probed = probedBy(plan);
        probed.resize(3 * LW_PROBED_PLANES * LW_PROBES);
        if (first.empty()) {
            first = probed;
            words = planOf(plan);
        }
        CAPTURE(width);
        CHECK(bitDifference(probed, first) == "");
        CHECK(planOf(plan)[LW_SCREEN_PLAN_FIRST] == words[LW_SCREEN_PLAN_FIRST]);
    }
}

TEST_CASE("a larger target takes no more, and a plan at rest stays", "[screen_plan]") {
    KernelRig rig(GENERATE(1u, 16u));
    ScreenCorner corner(rig, 131, 57, 4);
    const std::uint32_t samples = GENERATE(8u, 64u, 256u);
    const std::uint32_t start = GENERATE(std::uint32_t(LW_START_FULL), std::uint32_t(LW_START_QUARTER));
    std::vector<cl_int> before(LW_SCREEN_PLAN_LEVELS, cl_int(samples));
    double cost = 1e9;
    for (const float error : {1e-6f, 0.01f, 0.03f, 0.1f, 0.3f, 1.0f}) {
        ScreenPlanPass pass(rig.device(), optionsOf(error, samples, 3, true, start));
        ScreenPlan plan(rig.device());
        plan.record(rig.executor(), pass, corner.pyramid, kRadius, 0, 0);
        rig.device().finish();
        const std::vector<cl_int> first = planOf(plan);
        CAPTURE(error, samples, start);
        double now = 0.0;  // as screen_choose.cl weighs texels
        for (std::size_t k = 0; k < 3; ++k) now += std::pow(0.25, double(k)) * (first[k] > 0 ? first[k] + 22.0 : 8.0);
        CHECK(now <= cost);
        cost = now;
        for (std::size_t k = 0; k < 3; ++k) {
            // A coarser start may have more samples of fewer texels.
            if (start == LW_START_QUARTER) CHECK(first[k] <= before[k]);
            CHECK((first[k] == 0 || (first[k] >= 8 && cl_int(samples) % first[k] == 0)));
            before[k] = first[k];
        }
        for (int i = 0; i < 3; ++i) plan.record(rig.executor(), pass, corner.pyramid, kRadius, 0, 0);
        rig.device().finish();
        std::vector<cl_int> last = planOf(plan);
        last[LW_SCREEN_PLAN_AGE] = first[LW_SCREEN_PLAN_AGE];
        CHECK(last == first);
    }
    if (samples == 256) CHECK(cost < 256.0);
}
