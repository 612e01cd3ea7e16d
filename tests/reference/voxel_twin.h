// Triangles in voxels, in double: by clipping against a box (Sutherland and Hodgman 1974), one voxel at a time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace lightwell::reference {

using VoxelPoint = std::array<double, 3>;
using VoxelPolygon = std::vector<VoxelPoint>;

// What lies on one side of a plane across an axis: sign * (x - at) >= 0.
inline VoxelPolygon clipPolygon(const VoxelPolygon& from, std::size_t axis, double at, double sign) {
    VoxelPolygon to;
    for (std::size_t i = 0; i < from.size(); ++i) {
        const VoxelPoint &p = from[i], &q = from[(i + 1) % from.size()];
        const double dp = sign * (p[axis] - at), dq = sign * (q[axis] - at);
        if (dp >= 0.0) to.push_back(p);
        if (!(dp * dq < 0.0)) continue;
        VoxelPoint between;
        for (std::size_t a = 0; a < 3; ++a) between[a] = p[a] + dp / (dp - dq) * (q[a] - p[a]);
        between[axis] = at;
        to.push_back(between);
    }
    return to;
}

inline VoxelPolygon clipToBox(VoxelPolygon polygon, const VoxelPoint& low, const VoxelPoint& high) {
    for (std::size_t a = 0; a < 3 && !polygon.empty(); ++a)
        polygon = clipPolygon(clipPolygon(polygon, a, low[a], 1.0), a, high[a], -1.0);
    return polygon;
}

inline double polygonArea(const VoxelPolygon& polygon) {
    VoxelPoint sum{};
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        VoxelPoint u, v;
        for (std::size_t a = 0; a < 3; ++a) {
            u[a] = polygon[i][a] - polygon[0][a];
            v[a] = polygon[i + 1][a] - polygon[0][a];
        }
        for (std::size_t a = 0; a < 3; ++a) sum[a] += u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    }
    return 0.5 * std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

}  // namespace lightwell::reference
