// Places that are brought to another origin, against sums in double.
#include "passes/world_shift.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "support/kernel_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::uint32_t kCount = 21;
// Of what a place of some metres is after the move: two roundings of floats.
constexpr double kRounding = 1e-6;

}  // namespace

TEST_CASE("places move as in double, however far the origin goes, and nothing beside them does", "[world_shift]") {
    KernelRig rig(GENERATE(1u, 16u));
    const WorldOrigin from{1e5 + 0.3, -2e6, 12.0}, to = GENERATE(WorldOrigin{12.7, -2e6 + 1024.1, 12.0}, WorldOrigin{1e5 + 1.3, -2e6, 11.0});
    // One after the other with what belongs to them; and each coordinate by itself.
    const KeptPlaces::Layout layout = GENERATE(KeptPlaces::Layout{kCount, 3, 7, 1}, KeptPlaces::Layout{kCount, 0, 1, 32});
    std::vector<float> before(3 * 7 * kCount + 16, 0.5f);
    const auto at = [&](std::uint32_t i, std::uint32_t a) { return layout.first + i * layout.stride + a * layout.axis; };
    for (std::uint32_t i = 0; i < kCount; ++i)
        for (std::uint32_t a = 0; a < 3; ++a) before[at(i, a)] = float(to[a] - from[a] + 0.37 * (i + 1) - a);
    const Guarded memory = rig.upload(before);
    KeptPlaces kept;
    rig.executor().setWorldOrigin(from);
    kept.arrive(rig.executor());
    CHECK(!kept.moves(rig.executor()));
    rig.executor().setWorldOrigin(to);
    CHECK(kept.moves(rig.executor()));
    kept.move(rig.executor(), memory, layout);
    rig.device().finish();
    const std::vector<float> after = rig.download<float>(memory);
    std::vector<bool> isPlace(before.size(), false);
    for (std::uint32_t i = 0; i < kCount; ++i)
        for (std::uint32_t a = 0; a < 3; ++a) {
            isPlace[at(i, a)] = true;
            CHECK(std::abs(double(after[at(i, a)]) - (double(before[at(i, a)]) + from[a] - to[a])) <= 20.0 * kRounding);
        }
    for (std::size_t i = 0; i < before.size(); ++i)
        if (!isPlace[i]) REQUIRE(after[i] == before[i]);
}
