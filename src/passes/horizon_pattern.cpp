// Lines run through pixel centres: every direction is a vector of small integers without a common factor, and steps lie
// whole numbers of them away, but for the nearest: what is curved then shows the points of its slice.
#include "passes/horizon_pattern.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Texels are looked up at places shifted by up to this share of a texel to either side, differently for each step, besides
// the pixels' own shifts. 0: the borders of texels line up over all steps and show. Larger: steps leave their line.
constexpr double kPhaseShare = 0.25;
// A step looks at texels of half the width that it stands for. A coarser level shows the nearest surface of a larger block
// only: narrow floors between nearer things vanish, and their light with them. A finer one sees less of its stretch.
constexpr int kFinerLevels = 1;

struct Line {
    int x, y;
    double angle;
};

// Half of the directions with coordinates up to `reach`, by angle in [0, pi).
std::vector<Line> linesWithin(int reach) {
    std::vector<Line> lines;
    for (int y = 0; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
            if (y == 0 && x <= 0) continue;
            if (std::gcd(std::abs(x), y) == 1) lines.push_back({x, y, std::atan2(double(y), double(x))});
        }
    std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.angle < b.angle; });
    return lines;
}

std::vector<Line> linesOf(std::uint32_t directions) {
    int reach = 1;
    while (linesWithin(reach).size() < directions) ++reach;
    return linesWithin(reach);
}

double fraction(double x) { return x - std::floor(x); }

// Where the first step's stretch begins, in pixels: at the pixel's own border. Every line begins there, however long its
// vector: from half of the vector on, as steps of whole vectors would have it, the stretch that is left out grows with the
// number of directions, and with it the light in contacts.
constexpr double kOwnPixel = 0.5;

// Steps of one side: 1, 2, .. up to twice the density vectors apart, then as many again on each coarser level, as long as the
// stretch that a step stands for begins within reach. (Up to the last step that lies within reach itself: a quarter of the
// distance, and of the light of rooms, is left out at one step to a doubling.) Vectors of two pixels and more begin with
// fractions of a half, a quarter, .., at the pixels nearest to the line: surfaces are seen as planes, which lie right beside
// it, too. `every`: pixels of the full image per pixel here.
void addSteps(HorizonPattern& pattern, const Line& line, int side, std::uint32_t density, double reach, double every) {
    const double length = std::hypot(double(line.x), double(line.y));
    const int last = 2 * int(density) - 1, finest = -int(std::log2(length));
    for (int doubling = finest; doubling < LW_HORIZON_LEVELS + kFinerLevels; ++doubling)
        for (int k = doubling == finest ? 1 : int(density); k <= last; ++k) {
            const double scale = std::ldexp(length, doubling);
            const bool nearest = doubling == finest && k == 1;
            // The first step of a doubling follows one of half the width.
            const double begin = nearest ? std::min(kOwnPixel, 0.5 * scale) : (k - (doubling > finest && k == int(density) ? 0.25 : 0.5)) * scale;
            if (begin > reach && !nearest) return;
            lw_horizon_step step{};
            step.level = std::max(0, doubling - kFinerLevels);
            const double multiple = std::ldexp(double(side * k), doubling - step.level);
            step.dx = int(std::lround(multiple * line.x));
            step.dy = int(std::lround(multiple * line.y));
            const double n = double(pattern.steps.size() + 1);  // an additive sequence of two dimensions (Roberts 2018)
            const double shift = std::ldexp(2.0 * kPhaseShare, step.level);
            step.phaseX = int(std::lround((fraction(0.7548776662 * n) - 0.5) * shift));
            step.phaseY = int(std::lround((fraction(0.5698402910 * n) - 0.5) * shift));
            step.begin = float(begin * every);
            step.end = float((k + 0.5) * scale * every);
            pattern.steps.push_back(step);
            pattern.levels = std::max(pattern.levels, std::uint32_t(step.level) + 1);
        }
}

}  // namespace

HorizonPattern horizonPattern(const HorizonPatternOptions& options, double reach, double every) {
    const std::vector<Line> lines = linesOf(options.directions);
    const std::size_t count = lines.size(), rows = options.rows, perRow = count / rows;
    // Neighbours far apart: bits of the row's number reversed.
    const auto orderOf = [&](std::size_t row) {
        std::size_t order = 0;
        for (std::size_t bit = 1; bit < rows; bit *= 2) order = 2 * order + (row & bit ? 1 : 0);
        return order;
    };
    HorizonPattern pattern;
    pattern.slices.resize(count);
    for (std::size_t row = 0; row < rows; ++row)
        for (std::size_t i = 0; i < perRow; ++i) {
            const std::size_t at = orderOf(row) + i * rows;
            const Line& line = lines[at];
            const double before = at == 0 ? lines.back().angle - kPi : lines[at - 1].angle;
            const double after = at + 1 == count ? lines.front().angle + kPi : lines[at + 1].angle;
            const double length = std::hypot(double(line.x), double(line.y));
            lw_horizon_slice& slice = pattern.slices[row + i * rows];
            slice = {};
            slice.dx = float(line.x / length);
            slice.dy = float(line.y / length);
            slice.share = float((after - before) / (2.0 * kPi));
            // Away from 0 and 1: a border that only rounding keeps from a whole sector must not lose it.
            slice.rounding = float(0.05 + 0.9 * fraction(0.6180339887 * double(at + 1)));
            slice.first[0] = cl_int(pattern.steps.size());
            addSteps(pattern, line, 1, options.density, reach, every);
            slice.steps = cl_int(pattern.steps.size()) - slice.first[0];
            slice.first[1] = cl_int(pattern.steps.size());
            addSteps(pattern, line, -1, options.density, reach, every);
        }
    return pattern;
}

std::uint32_t horizonLevels(std::uint32_t density, double reach) {
    int doublings = 1;
    while (doublings < LW_HORIZON_LEVELS + kFinerLevels && (double(density) - 0.25) * std::ldexp(1.0, doublings) <= reach) ++doublings;
    return std::uint32_t(std::max(1, doublings - kFinerLevels));
}

}  // namespace lightwell
