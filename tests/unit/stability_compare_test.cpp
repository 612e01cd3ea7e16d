// `stability --compare`: what counts as worse, and what is only noise.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "stability_results.h"

namespace {

using Json = nlohmann::ordered_json;

Json resultsWith(const Json& result) {
    return {{"format", "lightwell-stability 1"},
            {"header", {{"size", {320, 180}}, {"frames", 32}}},
            {"sequences", Json::array()},
            {"results", Json::array({result})}};
}

Json result(double flicker, double floor, double bias = 0.1) {
    Json json;
    json["id"] = "rsm/camera_pan";
    json["parameters"] = {{"vpls", 256}};
    json["passes"] = true;
    json["indices"] = {{"flicker", flicker}, {"ghost", nullptr}, {"leak", 0.02}};
    json["floors"] = {{"flicker", floor}, {"ghost", nullptr}, {"leak", 0.0}};
    json["errors"] = {{"relMSE", 0.5}, {"bias", bias}};
    json["error_floors"] = {{"relMSE", 0.01}, {"bias", 0.002}};
    return json;
}

}  // namespace

TEST_CASE("equal results hold no regression") {
    const Json results = resultsWith(result(0.05, 0.004));
    const cli::StabilityComparison comparison = cli::compareStability(results, results);
    CHECK(comparison.results == 1);
    CHECK(comparison.compared == 4);  // flicker, leak, relMSE, bias
    CHECK(comparison.regressions.empty());
    CHECK(comparison.improvements.empty());
}

TEST_CASE("a figure is worse when it rises by more than the floors of both runs") {
    const Json before = resultsWith(result(0.05, 0.004));
    CHECK(cli::compareStability(before, resultsWith(result(0.057, 0.004))).regressions.empty());
    const auto worse = cli::compareStability(before, resultsWith(result(0.06, 0.004)));
    REQUIRE(worse.regressions.size() == 1);
    CHECK_THAT(worse.regressions[0], Catch::Contains("rsm/camera_pan: flicker 0.05 -> 0.06"));
    CHECK(cli::compareStability(before, resultsWith(result(0.04, 0.004))).improvements.size() == 1);

    // A figure without noise: beyond rounding is worse.
    Json leaks = resultsWith(result(0.05, 0.004));
    leaks["results"][0]["indices"]["leak"] = 0.021;
    CHECK(cli::compareStability(before, leaks).regressions.size() == 1);
}

TEST_CASE("a bias is worse when it is larger, whatever its sign") {
    const Json before = resultsWith(result(0.05, 0.004, -0.1));
    CHECK(cli::compareStability(before, resultsWith(result(0.05, 0.004, 0.1))).regressions.empty());
    CHECK(cli::compareStability(before, resultsWith(result(0.05, 0.004, -0.2))).regressions.size() == 1);
}

TEST_CASE("a ghost is worse when it rises above 0, whatever it was below") {
    Json before = resultsWith(result(0.05, 0.004)), now = before;
    before["results"][0]["indices"]["ghost"] = -0.6;
    now["results"][0]["indices"]["ghost"] = 0.4;
    CHECK(cli::compareStability(before, now).regressions.size() == 1);
    CHECK(cli::compareStability(now, before).regressions.empty());
    now["results"][0]["indices"]["ghost"] = -0.9;
    CHECK(cli::compareStability(before, now).regressions.empty());
}

TEST_CASE("more values that are not finite are a regression of what failed before") {
    Json before = resultsWith(result(0.05, 0.004));
    before["results"][0]["passes"] = false;
    before["results"][0]["not_finite"] = 3;
    CHECK(cli::compareStability(before, before).regressions.empty());
    Json now = before;
    now["results"][0]["not_finite"] = 4;
    CHECK(cli::compareStability(before, now).regressions.size() == 1);
    CHECK(cli::compareStability(now, before).regressions.empty());
}

TEST_CASE("light where there must be none is a regression; missing results are noted") {
    const Json before = resultsWith(result(0.05, 0.004));
    Json now = before;
    now["results"][0]["passes"] = false;
    CHECK(cli::compareStability(before, now).regressions.size() == 1);
    now["results"] = Json::array();
    const auto comparison = cli::compareStability(before, now);
    CHECK(comparison.regressions.empty());
    CHECK(comparison.notes.size() == 1);
    CHECK(comparison.results == 0);
}

TEST_CASE("runs of another size or length are not compared") {
    const Json before = resultsWith(result(0.05, 0.004));
    Json now = before;
    now["header"]["frames"] = 8;
    CHECK_THROWS_WITH(cli::compareStability(before, now), Catch::Contains("frames is 32 there and 8"));
    CHECK_THROWS_WITH(cli::requireComparable(before, {32, 160, 90}),
                      Catch::Contains("size is [320,180]"));
    CHECK_NOTHROW(cli::requireComparable(before, {32, 320, 180}));
}
