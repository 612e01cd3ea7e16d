// Levels of voxels, against means and front-to-back composition in double of the words below, and what
// has memory against a search through every voxel.
#include "passes/voxel_mips.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support/voxel_mips_rig.h"

using namespace lightwell;
using namespace lightwell::test;

TEST_CASE("bricks have memory where one of their stored voxels may hold something, on all levels",
          "[voxel_mips]") {
    MipsRig rig(16, 64, LW_VOXEL_MODE_ISOTROPIC, false);
    std::vector<char> occupied(64 * 64 * 64);
    const auto at = [&](int side, int x, int y, int z) {
        return std::size_t((z * side + y) * side + x);
    };
    eachVoxel(64, [&](int x, int y, int z) {
        occupied[at(64, x, y, z)] = isSomething(64, x, y, z) && x < 40;
    });
    const std::vector<cl_uint> bits =
        occupiedBits(64, [&](int x, int y, int z) { return occupied[at(64, x, y, z)] != 0; });
    rig.makeTables(bits);
    CHECK(rig.work().moved == 1);
    int slots[2] = {0, 0};
    for (int l = 0, side = 64; l < voxel_levels(64); ++l, side /= 2) {
        const VoxelLevel level = VoxelLevel::of(rig.volume, l);
        int wrong = 0;
        eachVoxel(level.bricks, [&](int bx, int by, int bz) {
            bool wants = false;
            eachVoxel(9, [&](int x, int y, int z) {
                const int gx = 8 * bx + x, gy = 8 * by + y, gz = 8 * bz + z;
                wants = wants || (gx < side && gy < side && gz < side && occupied[at(side, gx, gy, gz)]);
            });
            wrong += level.slotOf(bx, by, bz) != (wants ? slots[l > 0]++ : LW_VOXEL_EMPTY);
        });
        CHECK(wrong == 0);
        std::vector<char> coarse(std::size_t(side * side * side / 8));
        eachVoxel(side / 2, [&](int x, int y, int z) {
            for (int c = 0; c < 8; ++c)
                coarse[at(side / 2, x, y, z)] |=
                    occupied[at(side, 2 * x + (c & 1), 2 * y + (c >> 1 & 1), 2 * z + (c >> 2))];
        });
        occupied = coarse;
    }
    CHECK(rig.state().baseBricks == slots[0]);
    CHECK(rig.state().mipBricks == slots[1]);
    CHECK(slots[0] < 512);
    rig.makeTables(bits);
    CHECK(rig.work().stale == 1);
    CHECK(rig.work().moved == 0);
    rig.makeTables(std::vector<cl_uint>(bits.size()),
                   false);  // nothing is looked at where nothing has changed
    CHECK(rig.work().stale == 0);
    CHECK(rig.state().baseBricks == slots[0]);
    MipsRig dense(16, 64, LW_VOXEL_MODE_ISOTROPIC, false, false);
    dense.makeTables(bits);
    CHECK(dense.state().baseBricks == 512);
    CHECK(dense.state().mipBricks == voxel_table_size(64) - 512);
}

TEST_CASE("every word is its children's mean or composition, at any width, and totals stay",
          "[voxel_mips]") {
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC);
    const bool sides = GENERATE(false, true);
    constexpr int kSize = 32;
    const std::vector<cl_uint> bits =
        occupiedBits(kSize, [](int x, int y, int z) { return isSomething(kSize, x, y, z); });
    const auto wordAt = [](int p, int x, int y, int z) {
        return isSomething(kSize, x, y, z) ? packed(lightAt(p, x, y, z), p, x, y, z) : 0u;
    };
    MipsRig wide(16, kSize, mode, sides), narrow(1, kSize, mode, sides);
    for (MipsRig* rig : {&wide, &narrow}) {
        rig->makeTables(bits);
        rig->write(wordAt, kAll);
    }
    const std::vector<VoxelLevel> levels = wide.levels();
    const int filtered = voxel_filtered_plane(mode, sides);
    Value variance{};
    for (std::size_t l = 1; l < levels.size(); ++l) {
        const VoxelLevel &level = levels[l], &fine = levels[l - 1];
        std::string worst;
        for (int p = 0; p < level.planes; ++p)
            eachVoxel(level.side, [&](int x, int y, int z) {
                const int from = l > 1                               ? p
                                 : mode == LW_VOXEL_MODE_ANISOTROPIC ? (sides ? p : 0)
                                                                     : filtered;
                const Value expected = mode == LW_VOXEL_MODE_ANISOTROPIC
                                           ? composed(fine, from, p, x, y, z)
                                           : meanOf(fine, from, x, y, z);
                const std::string error = missed(valueOf(level, p, x, y, z), expected);
                if (!error.empty()) worst = error;
            });
        CHECK(worst == "");
        checkAprons(level);
        if (mode != LW_VOXEL_MODE_ISOTROPIC) continue;
        const Value first = totals(levels[0], filtered), now = totals(level, 0);
        addVariance(level, variance);
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(std::fabs(now[i] - first[i]) < 4 * std::sqrt(variance[i]));
    }
    checkAprons(levels[0]);
    const std::vector<VoxelLevel> other = narrow.levels();
    for (std::size_t l = 1; l < levels.size(); ++l)
        for (int p = 0; p < levels[l].planes; ++p) {
            int differ = 0;
            eachVoxel(levels[l].side, [&](int x, int y, int z) {
                differ += levels[l].word(p, x, y, z) != other[l].word(p, x, y, z);
            });
            CHECK(differ == 0);
        }
}

TEST_CASE("a wall one voxel thick stays opaque across it with six sides, and thins by halves without",
          "[voxel_mips]") {
    constexpr int kSize = 32;
    const int axis = GENERATE(0, 1, 2);
    const auto isWall = [axis](int x, int y, int z) {
        return (axis == 0 ? x : axis == 1 ? y : z) == 13;
    };
    const auto wordAt = [&](int p, int x, int y, int z) {
        return isWall(x, y, z) ? packed({2, 4, 1, 1}, p, x, y, z) : 0u;
    };
    MipsRig isotropic(16, kSize, LW_VOXEL_MODE_ISOTROPIC, false),
        six(16, kSize, LW_VOXEL_MODE_ANISOTROPIC, false);
    for (MipsRig* rig : {&isotropic, &six}) {
        rig->makeTables(occupiedBits(kSize, isWall));
        rig->write(wordAt, kAll);
    }
    const std::vector<VoxelLevel> mean = isotropic.levels(), across = six.levels();
    for (std::size_t l = 1; l < mean.size(); ++l) {
        const double thinned = std::ldexp(1.0, -int(l));
        const int layer = 13 >> l, side = mean[l].side;
        double sum = 0.0, red = 0.0;
        int count = 0;
        eachVoxel(side, [&](int x, int y, int z) {
            if ((axis == 0 ? x : axis == 1 ? y : z) != layer) return;
            const Value v = valueOf(mean[l], 0, x, y, z);
            sum += v[3];
            red += v[0];
            ++count;
            for (int s = 2 * axis; s < 2 * axis + 2; ++s) {
                const Value w = valueOf(across[l], s, x, y, z);
                CHECK(w[3] == Approx(1.0).epsilon(1e-6));
                // 2, 4, 1 are whole steps, so that nothing is rounded.
                CHECK(w[0] == Approx(2.0).epsilon(1e-6));
                CHECK(w[1] == Approx(4.0).epsilon(1e-6));
            }
        });
        CHECK(sum / count == Approx(thinned).margin(count > 8 ? 0.001 : 1.0 / 255));
        CHECK(red / count == Approx(2.0 * thinned).epsilon(1e-6));
    }
}

TEST_CASE("SH2: coefficients are means, each within its steps", "[voxel_mips]") {
    constexpr int kSize = 32;
    MipsRig rig(16, kSize, LW_VOXEL_MODE_SH2, GENERATE(false, true));
    const int first = voxel_filtered_plane(LW_VOXEL_MODE_SH2, rig.volume.sides);
    rig.makeTables(occupiedBits(kSize, [](int x, int y, int z) { return isSomething(kSize, x, y, z); }));
    const auto shareAt = [](int c, int axis, int x, int y, int z) {
        return std::sin(1.0 + x + 2 * y + 3 * z + 5 * c + 7 * axis);
    };
    rig.write(
        [&](int p, int x, int y, int z) -> cl_uint {
            if (p < first || !isSomething(kSize, x, y, z)) return 0u;
            if (p == first) return packed(lightAt(0, x, y, z), p, x, y, z);
            const int c = p - first - 1;
            const auto c0 = float(lightAt(0, x, y, z)[std::size_t(c)]);
            const auto c1 = [&](int axis) {
                return c0 * LW_VOXEL_SQRT3 * float(shareAt(c, axis, x, y, z));
            };
            return voxel_pack_harmonics(c0, c1(0), c1(1), c1(2), voxel_dither(x, y, z, 0, p));
        },
        kAll);
    const std::vector<VoxelLevel> levels = rig.levels();
    for (std::size_t l = 1; l < levels.size(); ++l) {
        const int from = l == 1 ? first : 0;
        double worst = 0.0;
        eachVoxel(levels[l].side, [&](int x, int y, int z) {
            const Value mean = meanOf(levels[l - 1], from, x, y, z),
                        found = valueOf(levels[l], 0, x, y, z);
            CHECK(missed(found, mean) == "");
            for (int c = 0; c < 3; ++c)
                for (int axis = 0; axis < 3; ++axis) {
                    double expected = 0.0;
                    for (int k = 0; k < 8; ++k) {
                        const int cx = 2 * x + (k & 1), cy = 2 * y + (k >> 1 & 1), cz = 2 * z + (k >> 2);
                        expected +=
                            double(voxel_unpack_harmonic(
                                levels[l - 1].word(from + 1 + c, cx, cy, cz), axis,
                                float(valueOf(levels[l - 1], from, cx, cy, cz)[std::size_t(c)]))) /
                            8;
                    }
                    const double bound = std::sqrt(3.0) * mean[std::size_t(c)];
                    if (bound < 1e-3) continue;
                    const double share =
                        double(voxel_unpack_harmonic(levels[l].word(1 + c, x, y, z), axis, 1.0f)) /
                        std::sqrt(3.0);
                    worst = std::max(worst, std::fabs(share - expected / bound));
                }
        });
        CHECK(worst < 1.0 / 511 + 1e-5);
        checkAprons(levels[l]);
    }
}

TEST_CASE("only bricks above what has changed are filtered, and come out as if all were",
          "[voxel_mips]") {
    constexpr int kSize = 64;
    const auto mode = GENERATE(LW_VOXEL_MODE_ISOTROPIC, LW_VOXEL_MODE_ANISOTROPIC);
    const std::vector<cl_uint> bits =
        occupiedBits(kSize, [](int x, int y, int z) { return isSomething(kSize, x, y, z); });
    const auto wordAt = [](double bright) {
        return [bright](int p, int x, int y, int z) {
            Value v = lightAt(p, x, y, z);
            if (x / 8 == 4 && y / 8 == 1 && z / 8 == 3)
                for (std::size_t i = 0; i < 3; ++i) v[i] *= bright;
            return isSomething(kSize, x, y, z) ? packed(v, p, x, y, z) : 0u;
        };
    };
    MipsRig changed(16, kSize, mode, false), anew(16, kSize, mode, false);
    changed.makeTables(bits);
    changed.write(wordAt(1.0), kAll);
    changed.makeTables(bits, false);
    changed.write(wordAt(3.0), [](int brick) { return brick == (3 * 8 + 1) * 8 + 4; });
    CHECK(changed.state().filteredBricks == voxel_levels(kSize) - 1);
    anew.makeTables(bits);
    anew.write(wordAt(3.0), kAll);
    CHECK(anew.state().filteredBricks > 8);
    const std::vector<VoxelLevel> some = changed.levels(), all = anew.levels();
    for (std::size_t l = 0; l < all.size(); ++l) {
        std::size_t differ = 0;
        for (int p = 0; p < all[l].planes; ++p)
            eachVoxel(all[l].bricks, [&](int bx, int by, int bz) {
                const int slot = all[l].slotOf(bx, by, bz);
                if (slot >= 0)
                    eachVoxel(9, [&](int x, int y, int z) {
                        differ += all[l].stored(p, slot, x, y, z) != some[l].stored(p, slot, x, y, z);
                    });
            });
        CHECK(differ == 0);
    }
    changed.makeTables(bits, false);
    changed.write(wordAt(3.0), [](int) { return false; });
    CHECK(changed.state().filteredBricks == 0);
    // What the scene wants is still there for who looks late.
    CHECK(changed.work().stale == 0);
    CHECK(changed.work().baseWanted == anew.work().baseWanted);
    CHECK(changed.work().mipsWanted == anew.work().mipsWanted);
    CHECK(anew.work().mipsWanted > 0);
}
