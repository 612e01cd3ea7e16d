// Sets of directions over the sphere for sweeps, and a direction's numbers as kernels take them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace lightwell {

struct SweepDirection {
    std::array<double, 3> d;  // unit
    double weight;            // solid angle that it stands for; all together 4 pi
};

// count: 24 or 48, the permutations and signs of one triple, of equal weights, for which even light L is E = pi L on normals along
// an axis; or 6 n^2 with n even, the cells of a cube whose faces are cut at equal angles, with their solid angles. Ordered by
// groups (see lpv_sweep_types.h).
std::vector<SweepDirection> sweepDirections(std::uint32_t count);

// LW_SWEEP_DIRECTION floats for each.
std::vector<float> sweepTable(const std::vector<SweepDirection>& directions);

}  // namespace lightwell
