// Indices of sequences whose values are known by hand.
#include <catch2/catch.hpp>

#include "stability_indices.h"
#include "support/stability_frames.h"

using stability_test::makeFrames;
using studio::stabilityIndices;

TEST_CASE("flicker: frames of one brightness whose image alternates") {
    // F - R = +0.3, -0.3, +0.3 ...: each difference is 0.6; mean(R) is 2.
    const auto frames = makeFrames(
        8, 16, 16, [](int t, int, int) { return 2.0 + (t % 2 == 0 ? 0.3 : -0.3); },
        [](int, int, int) { return 2.0; });
    CHECK(stabilityIndices(frames).flicker.value() == Approx(0.3));
}
