// Positions so far from their origin that a float's rounding of them shows.
#include <algorithm>
#include <cmath>

#include "inputs/input_check_parts.h"

namespace lightwell {
namespace {

// Of a pixel's width, the rounding of its position from which a picture is too coarse: then the angle that two neighbouring positions
// span is off by a sixth of a right angle at worst. Less: worlds of a few kilometres in large pictures, which are good enough.
constexpr double kMostRounding = 0.125;
constexpr double kHalfStep = 1.0 / (1 << 24);  // of a float, relative
constexpr std::uint64_t kFewest = 16;

}  // namespace

// What floats of a camera's matrices round the same way is where the camera is, for positions that come from depth.
bool checkFar(Surfaces& s, Findings* findings) {
    if (!s.camera || s.halfPositions) return false;
    std::vector<double> shares, distances;
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        if (!s.surface(x, y)) return;
        const glm::dvec3 p = s.position.triple(x, y);
        const double width = s.camera->footprint(s.camera->axial(p)), far = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (!(width > 0.0)) return;
        shares.push_back(far * kHalfStep / width);
        distances.push_back(far);
    });
    if (shares.size() < kFewest) return false;
    const std::uint64_t examined = shares.size();
    const auto coarse = std::uint64_t(std::count_if(shares.begin(), shares.end(), [](double share) { return share > kMostRounding; }));
    const double share = medianOf(std::move(shares)), far = medianOf(std::move(distances));
    if (!(share > kMostRounding)) return false;
    s.trusted = false;
    if (!findings) return true;
    findings->add(LW_FAULT_FAR_FROM_ORIGIN, LW_SEVERITY_WARNING, s.argument(s.placeName()), {coarse, examined, share, kMostRounding, 1.0},
                  "surfaces lie ", far, " from the origin, where floats are ", 2.0 * far * kHalfStep, " apart: positions are off by ", share,
                  " of a pixel's width (median), more than ", kMostRounding,
                  ". Give positions, matrices, lights and geometry relative to a point of the world near the camera, and that point as "
                  "frame.worldOrigin, in double");
    return true;
}

}  // namespace lightwell
