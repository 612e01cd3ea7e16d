// The planner in C++ against the arithmetic of the script that fitted its table (docs/figures/planner.py), for views that were measured:
// a table, a formula or a rule of choosing that differs in one of them does not pass.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <string>

#include "planner/plan_tables.h"
#include "planner/planner.h"
#include "reference/planner_values.h"

using namespace lightwell;

namespace {

FrameTraits frameOf(const PlannerValue& value) {
    FrameTraits traits;
    traits.pixels = 1280.0 * 720.0;
    traits.rsmTexels = 512.0 * 512.0;
    traits.triangles = value.triangles;
    traits.lights = 1;
    traits.hasRsms = traits.hasDirectRadiance = traits.hasAlbedo = traits.hasCamera = traits.hasViews = true;
    return traits;
}

FrameFigures probesOf(const PlannerValue& value) {
    const float* p = value.probes;
    FrameFigures figures(LWPlanProbes{p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]});
    figures.coverage = value.coverage;
    return figures;
}

std::string nameOf(std::size_t candidate) {
    const Candidate& named = candidates()[candidate];
    return std::string(named.technique) + (*named.settings ? " " : "") + named.settings;
}

}  // namespace

TEST_CASE("the planner predicts what its fit predicts", "[planner]") {
    for (const PlannerValue& value : kPlannerValues) {
        INFO(value.row);
        bool isThere = false;
        for (const Prediction& each : predict({}, frameOf(value), probesOf(value))) {
            if (nameOf(each.candidate) != value.row) continue;
            isThere = true;
            // The table has four digits of each cost, and four decimals of each logarithm's parts.
            CHECK(each.milliseconds == Approx(value.milliseconds).epsilon(1e-3));
            CHECK(each.error == Approx(value.error).epsilon(3e-3));
        }
        CHECK(isThere);
    }
}

TEST_CASE("the planner chooses what its fit chooses", "[planner]") {
    constexpr double kBudgets[] = {4.0, 8.0, 16.0, 33.0, 66.0};
    for (const PlannerValue& value : kPlannerValues) {
        const auto predictions = predict({}, frameOf(value), probesOf(value));
        for (std::size_t b = 0; b < 5; ++b) {
            INFO("budget of " << kBudgets[b] << " ms");
            CHECK(nameOf(choose(predictions, kBudgets[b], 0.0).prediction.candidate) == value.chosen[b]);
        }
    }
}
