// Levels of voxels, against means and front-to-back composition in double of the words below, and what
// has memory against a search through every voxel.
#include "passes/voxel_mips.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "support/voxel_volume_rig.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr int kExponent = -30;
const cl_int kUnit = voxel_unit(kExponent);
// A mantissa of 6 bits has 32 steps at least; of green's 7, half as large ones.
constexpr double kStep = 1.0 / 32.0;

using Value = std::array<double, 4>;  // red, green, blue, opacity

struct MipsRig : KernelRig {
    VoxelVolume volume;
    VoxelMips pass;
    MipsRig(std::uint32_t width, std::uint32_t size, LWVoxelMode mode, bool sides, bool sparse = true)
        : KernelRig(width), pass(device(), size, 0) {
        volume.size = size;
        volume.mode = mode;
        volume.sides = sides;
        volume.sparse = sparse;
    }
    void makeTables(const std::vector<cl_uint>& bits, bool all = true) {
        const Guarded occupied = upload(bits);
        const Guarded changed =
            upload(std::vector<cl_int>(bits.size() / LW_VOXEL_BRICK_WORDS, all ? 1 : 0));
        const bool isNew = volume.reserve(executor(), 1u << 20, 1u << 20);
        pass.recordTables(executor(), occupied, changed, isNew, volume);
        device().finish();
    }
    // Words of the finest level's own voxels; `marked`: bricks that are told to have changed.
    void write(const std::function<cl_uint(int plane, int x, int y, int z)>& wordAt,
               const std::function<bool(int brick)>& marked) {
        VoxelLevel base = VoxelLevel::of(volume, 0);
        std::vector<cl_int> marks(base.table.size());
        for (std::size_t b = 0; b < marks.size(); ++b) marks[b] = marked(int(b)) ? 1 : 0;
        eachVoxel(base.side, [&](int x, int y, int z) {
            const int slot = base.slotOf(x / 8, y / 8, z / 8);
            for (int p = 0; p < base.planes && slot >= 0; ++p)
                base.words[(std::size_t(p) * base.slots + std::size_t(slot)) * LW_VOXEL_STRIDE +
                           std::size_t(x % 8 + 9 * (y % 8) + 81 * (z % 8))] = wordAt(p, x, y, z);
        });
        executor().write("test.write", volume.base, 0, base.words.size() * sizeof(cl_uint),
                         base.words.data());
        executor().write("test.write", pass.marks(), 0, marks.size() * sizeof(cl_int), marks.data());
        LwVoxelState state{};
        state.unit = kUnit;
        state.perUnit = voxel_per_unit(kExponent);
        executor().write("test.write", volume.state, 0, sizeof state, &state);
        pass.recordFilter(executor(), volume);
        device().finish();
    }
    LwVoxelWork work() {
        LwVoxelWork result;
        pass.work().download(0, sizeof result, &result);
        return result;
    }
    LwVoxelState state() {
        LwVoxelState result;
        volume.state.download(0, sizeof result, &result);
        return result;
    }
    std::vector<VoxelLevel> levels() {
        std::vector<VoxelLevel> result;
        for (int level = 0; level < voxel_levels(int(volume.size)); ++level)
            result.push_back(VoxelLevel::of(volume, level));
        return result;
    }
};

// A shell, a slab of one layer and a few crumbs: bricks full, grazed and empty.
bool isSomething(int size, int x, int y, int z) {
    const double c = 0.5 * size,
                 r = std::sqrt((x - c) * (x - c) + (y - c) * (y - c) + (z - c) * (z - c));
    return std::fabs(r - 0.3 * size) < 0.6 || (z == size - 8 && x < size / 2) ||
           (x * 7 + y * 13 + z * 31) % 4001 == 0;
}

// Of 1e4 : 1 contrast from brick to brick, coloured, of any opacity.
Value lightAt(int plane, int x, int y, int z) {
    std::mt19937 random(std::uint32_t(x + 512 * y + 262144 * z) + 77u * std::uint32_t(plane));
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const double bright = std::pow(10.0, -4.0 * ((x / 8 + y / 8 + z / 8) % 3) / 2.0),
                 opacity = unit(random);
    return {bright * opacity * unit(random), bright * opacity * unit(random),
            bright * opacity * unit(random), opacity};
}

cl_uint packed(const Value& v, int plane, int x, int y, int z) {
    return voxel_pack(float(v[0]), float(v[1]), float(v[2]), float(v[3]), voxel_per_unit(kExponent),
                      voxel_dither(x, y, z, 0, plane));
}

Value valueOf(const VoxelLevel& level, int plane, int x, int y, int z) {
    const LwVoxelValue v = level.value(plane, x, y, z, kUnit);
    return {double(v.red), double(v.green), double(v.blue), double(v.opacity)};
}

// What a coarser voxel's word should hold, of the words below it.
Value meanOf(const VoxelLevel& fine, int plane, int x, int y, int z) {
    Value mean{};
    for (int c = 0; c < 8; ++c) {
        const Value child =
            valueOf(fine, plane, 2 * x + (c & 1), 2 * y + (c >> 1 & 1), 2 * z + (c >> 2));
        for (std::size_t i = 0; i < 4; ++i) mean[i] += child[i] / 8;
    }
    return mean;
}

Value composed(const VoxelLevel& fine, int plane, int side, int x, int y, int z) {
    Value sum{};
    const int axis = side / 2, front = side % 2 ? 0 : 1;
    for (int column = 0; column < 4; ++column) {
        int at[3] = {2 * x, 2 * y, 2 * z};
        at[(axis + 1) % 3] += column & 1;
        at[(axis + 2) % 3] += column >> 1;
        at[axis] += front;
        const Value near = valueOf(fine, plane, at[0], at[1], at[2]);
        at[axis] += 1 - 2 * front;
        const Value far = valueOf(fine, plane, at[0], at[1], at[2]);
        for (std::size_t i = 0; i < 4; ++i) sum[i] += (near[i] + (1 - near[3]) * far[i]) / 4;
    }
    return sum;
}

// A word is within one step of its brightest colour, and 1/255 of opacity.
std::string missed(const Value& found, const Value& expected) {
    const double most = std::max({expected[0], expected[1], expected[2]}),
                 step = kStep * most + std::ldexp(1.0, kExponent) * 1.01;
    for (std::size_t i = 0; i < 3; ++i)
        if (std::fabs(found[i] - expected[i]) > step + 1e-6 * most)
            return "colour " + std::to_string(i) + " is " + std::to_string(found[i]) + ", expected " +
                   std::to_string(expected[i]);
    if (std::fabs(found[3] - expected[3]) > 1.0 / 255.0 + 1e-6)
        return "opacity is " + std::to_string(found[3]) + ", expected " + std::to_string(expected[3]);
    return {};
}

std::array<double, 4> totals(const VoxelLevel& level, int plane) {
    std::array<double, 4> sums{};
    eachVoxel(level.side, [&](int x, int y, int z) {
        const Value v = valueOf(level, plane, x, y, z);
        for (std::size_t i = 0; i < 4; ++i) sums[i] += v[i] / std::pow(level.side, 3);
    });
    return sums;
}

// What rounding up or down adds to the variance of a level's totals, each word's a step times a share f
// of words rounded up, f (1 - f) on average 1/6. (Spread evenly over neighbours, so that sums are better
// than that.)
void addVariance(const VoxelLevel& level, Value& variance) {
    const double share = std::pow(level.side, -3);
    eachVoxel(level.side, [&](int x, int y, int z) {
        const cl_uint word = level.word(0, x, y, z);
        if (!word) return;
        const double step = std::ldexp(1.0, int(word >> 27) + kExponent) * share;
        const Value steps = {step, step / 2, step, share / 255};
        for (std::size_t i = 0; i < 4; ++i) variance[i] += steps[i] * steps[i] / 6;
    });
}

// What lies beyond a brick's own voxels is what its neighbours hold, and 0 beyond the level.
void checkAprons(const VoxelLevel& level) {
    int wrong = 0;
    eachVoxel(level.bricks, [&](int bx, int by, int bz) {
        const int slot = level.slotOf(bx, by, bz);
        if (slot < 0) return;
        for (int p = 0; p < level.planes; ++p)
            eachVoxel(9, [&](int x, int y, int z) {
                const int gx = 8 * bx + x, gy = 8 * by + y, gz = 8 * bz + z;
                const bool isInside = gx < level.side && gy < level.side && gz < level.side;
                wrong += level.stored(p, slot, x, y, z) != (isInside ? level.word(p, gx, gy, gz) : 0u);
            });
    });
    CHECK(wrong == 0);
}

const auto kAll = [](int) { return true; };

}  // namespace

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
