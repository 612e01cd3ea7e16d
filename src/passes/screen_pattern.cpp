#include "passes/screen_pattern.h"

#include <cmath>

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;

double radicalInverse(std::uint32_t bits) {
    double result = 0.0, digit = 0.5;
    for (; bits; bits >>= 1, digit *= 0.5)
        if (bits & 1) result += digit;
    return result;
}

double fraction(double value) { return value - std::floor(value); }

// In [0, 1); 0 for seed 0.
double seedShift(std::uint32_t seed, std::uint32_t axis) {
    if (seed == 0) return 0.0;
    std::uint32_t h = seed * 0x9e3779b9u + axis * 0x7f4a7c15u;  // MurmurHash3's finaliser twice: axes must not be alike
    for (int round = 0; round < 2; ++round) {
        h = (h ^ (h >> 16)) * 0x85ebca6bu;
        h = (h ^ (h >> 13)) * 0xc2b2ae35u;
        h ^= h >> 16;
    }
    return double(h) / 4294967296.0;
}

// A step of Roberts' R2 sequence a turn: 1 / g and 1 / g^2 with g^3 = g + 1, of which any stretch is spread evenly. In the
// `cells` of a pattern that have one sample each: in the whole set's range the step of the radius would be 6.04 of 8 cells, the
// next frame's samples would lie beside this one's, and 16 frames of 64 samples have up to twice the error.
double shiftOf(std::uint32_t seed, std::uint32_t turn, std::uint32_t axis, std::uint32_t cells) {
    constexpr double kSteps[] = {0.7548776662466927, 0.5698402909980532};
    return fraction(seedShift(seed, axis) + turn * kSteps[axis] / cells);
}

LwScreenSample sampleAt(int column, int row, double weight, std::uint32_t interleave) {
    const int n = int(interleave), phase = ((column % n) + n) % n;
    LwScreenSample sample{};
    sample.phase = phase;
    sample.step = (column - phase) / n;
    sample.row = row;
    sample.weight = float(weight);
    return sample;
}

// Area of the texel around (x, y) within the circle of radius r about the origin, by midpoints of 32 x 32 cells.
double areaInside(int x, int y, double r) {
    const double nearX = std::max(std::abs(x) - 0.5, 0.0), nearY = std::max(std::abs(y) - 0.5, 0.0);
    const double farX = std::abs(x) + 0.5, farY = std::abs(y) + 0.5;
    if (nearX * nearX + nearY * nearY >= r * r) return 0.0;
    if (farX * farX + farY * farY <= r * r) return 1.0;
    constexpr int kCells = 32;
    int inside = 0;
    for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
            const double px = x - 0.5 + (i + 0.5) / kCells, py = y - 0.5 + (j + 0.5) / kCells;
            if (px * px + py * py < r * r) ++inside;
        }
    return double(inside) / (kCells * kCells);
}

// Every texel of the ring with its share, or nothing when there are more than `most`.
std::vector<LwScreenSample> everyTexel(double inner, double outer, std::uint32_t most, std::uint32_t interleave) {
    std::vector<LwScreenSample> all;
    if (kPi * (outer * outer - inner * inner) > double(most)) return all;
    const int reach = int(std::ceil(outer + 0.5));
    double sum = 0.0;
    for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
            const double share = areaInside(x, y, outer) - areaInside(x, y, inner);
            if (share <= 0.0) continue;
            if (all.size() == most) return {};
            all.push_back(sampleAt(x, y, share, interleave));
            sum += share;
        }
    // What the cells of areaInside have wrong goes to all alike.
    const double scale = kPi * (outer * outer - inner * inner) / sum;
    for (LwScreenSample& sample : all) sample.weight = float(double(sample.weight) * scale);
    return all;
}

}  // namespace

bool takesEveryTexel(double inner, double outer, std::uint32_t samples) { return !everyTexel(inner, outer, samples, 1).empty(); }

std::vector<LwScreenSample> screenPatterns(double inner, double outer, std::uint32_t samples, std::uint32_t interleave,
                                           std::uint32_t seed, std::uint32_t turn) {
    const std::uint32_t patterns = interleave * interleave;
    std::vector<LwScreenSample> table;
    table.reserve(std::size_t(patterns) * samples);
    std::vector<LwScreenSample> all = everyTexel(inner, outer, samples, interleave);
    if (!all.empty()) {
        all.resize(samples, sampleAt(0, 0, 0.0, interleave));
        for (std::uint32_t p = 0; p < patterns; ++p) table.insert(table.end(), all.begin(), all.end());
        return table;
    }
    const double area = kPi * (outer * outer - inner * inner);
    // One Hammersley set for all, whose index holds the angle in its low bits and the radius in its high ones: patterns are
    // dealt by the middle bits, so that each is stratified in both. `low`: as near to the root of `samples` as a power of two is.
    std::uint32_t low = 1;
    while (4 * low * low <= samples) low *= 2;
    const double total = double(patterns) * samples;
    const double shift[] = {shiftOf(seed, turn, 0, samples / low), shiftOf(seed, turn, 1, low)};
    for (std::uint32_t p = 0; p < patterns; ++p)
        for (std::uint32_t s = 0; s < samples; ++s) {
            const std::uint32_t index = ((s / low) * patterns + p) * low + s % low;
            const double u = fraction((index + 0.5) / total + shift[0]), v = fraction(radicalInverse(index) + shift[1]);
            const double radius = std::sqrt(inner * inner + u * (outer * outer - inner * inner)), angle = 2.0 * kPi * v;
            table.push_back(sampleAt(int(std::lround(radius * std::cos(angle))), int(std::lround(radius * std::sin(angle))),
                                     area / samples, interleave));
        }
    return table;
}

}  // namespace lightwell
