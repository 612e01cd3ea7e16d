// What the times of a chart are made of.
#include <catch2/catch.hpp>

#include "chart_frames.h"

TEST_CASE("median and 99th percentile by nearest rank", "[chart]") {
    CHECK(cli::summarise({5.0}).median == 5.0);
    CHECK(cli::summarise({5.0}).p99 == 5.0);
    CHECK(cli::summarise({4.0, 1.0, 3.0, 2.0}).median == 2.5);
    CHECK(cli::summarise({4.0, 1.0, 3.0, 2.0}).p99 == 4.0);  // under 100 frames the slowest
    std::vector<double> many;
    for (int i = 200; i >= 1; --i) many.push_back(double(i));
    CHECK(cli::summarise(many).median == 100.5);
    CHECK(cli::summarise(many).p99 == 198.0);  // 99 % of the frames take no longer
}

TEST_CASE("times of a queue that measures none are unavailable", "[chart]") {
    CHECK(cli::summarise({}).median < 0.0);
    CHECK(cli::summarise({-1.0, -1.0}).p99 < 0.0);
}
