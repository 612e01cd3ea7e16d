#include "inputs/input_space_score.h"

#include <algorithm>
#include <cmath>

namespace lightwell {
namespace {

// Pixels and texels, and share of the distance, by which a texel may lie beside the surfaces around its
// pixel.
constexpr double kTolerancePixels = 2.0, kToleranceRelative = 0.004;
// In front only from three tolerances on.
constexpr double kInFrontTolerances = 3.0;
constexpr std::uint64_t kTexels = 20000;  // examined of a light
// A guess must put this share of all texels, and this one of those in the picture, onto what is seen,
// spread over this part of its width and height, with normals that agree, hardly any in front, and four
// times as many as without it (less where texels are in front without it, which cannot be).
constexpr double kGuessShare = 0.01, kGuessInside = 0.3, kSpread = 0.2, kNormalShare = 0.7,
                 kGuessInFront = 0.1, kNothingInFront = 0.005;
constexpr double kCloserThanGiven = 4.0, kCloserThanBad = 1.5;

void classify(const Surfaces& g, const Distances& distances, const Texel& texel, const glm::dvec3& p,
              const glm::dvec3& normal, double factor, SpaceScore& score) {
    glm::dvec2 pixel;
    if (!g.camera->project(p, pixel)) return;
    if (!(pixel.x >= 1.0 && pixel.y >= 1.0 && pixel.x < g.width - 1.0 && pixel.y < g.height - 1.0))
        return;
    ++score.inside;
    const glm::dvec3 towards = g.camera->perspective() ? g.camera->eye() - p : -g.camera->axis();
    const bool facing = glm::dot(normal, towards) > 0.0;
    score.facing += facing;
    const auto px = std::uint32_t(pixel.x), py = std::uint32_t(pixel.y);
    const double t = g.camera->axial(p);
    double nearest = HUGE_VAL, farthest = -HUGE_VAL, closest = HUGE_VAL;
    glm::dvec3 closestNormal(0.0);
    for (std::uint32_t y = py - 1; y <= py + 1; ++y)
        for (std::uint32_t x = px - 1; x <= px + 1; ++x) {
            const double there = distances[std::size_t(y) * g.width + x];
            if (std::isnan(there)) continue;
            nearest = std::min(nearest, there);
            farthest = std::max(farthest, there);
            if (std::abs(there - t) < closest) {
                closest = std::abs(there - t);
                closestNormal = g.unitNormal(x, y);
            }
        }
    if (closest == HUGE_VAL) return;  // background: the host may have left things out
    const double tolerance =
        kTolerancePixels * (g.camera->footprint(t) + texel.width * std::abs(factor)) +
        kToleranceRelative * std::abs(t) + texel.rounding * std::abs(factor) + g.rounding(p);
    if (t >= nearest - tolerance && t <= farthest + tolerance) {
        ++score.on;
        score.normals += glm::dot(normal, closestNormal) > 0.8;
        score.lowX = std::min(score.lowX, px);
        score.highX = std::max(score.highX, px);
        score.lowY = std::min(score.lowY, py);
        score.highY = std::max(score.highY, py);
    } else if (t < nearest - kInFrontTolerances * tolerance) {
        ++score.nearer;
        if (!facing) return;
        ++score.inFront;
        score.pixels.push_back(py * g.width + px);
    }
}

}  // namespace

std::vector<Texel> texelsOf(const LightMaps& light) {
    std::uint64_t all = 0;
    for (const Surfaces& map : light.maps) all += std::uint64_t(map.width) * map.height;
    const auto stride = std::max(1u, std::uint32_t(std::sqrt(double(all) / kTexels)));
    std::vector<Texel> texels;
    for (const Surfaces& map : light.maps) {
        if (!map.trusted || !map.camera) continue;
        for (std::uint32_t y = stride / 2; y < map.height; y += stride)
            for (std::uint32_t x = stride / 2; x < map.width; x += stride) {
                if (!map.surface(x, y)) continue;
                const glm::dvec3 p = map.position.triple(x, y);
                texels.push_back({p, map.unitNormal(x, y), map.camera->footprint(map.camera->axial(p)),
                                  map.rounding(p), &map, x, y});
            }
    }
    return texels;
}

bool SpaceScore::explains(const Surfaces& g, const SpaceScore& given) const {
    const bool proven = shareOf(normals, on) >= kNormalShare ||
                        (given.inFrontShare() >= kInFrontShare && nearerShare() <= kNothingInFront &&
                         normals >= kFewestTexels);
    const double least = given.inFrontShare() >= kInFrontShare ? kCloserThanBad : kCloserThanGiven;
    return proven && on >= kFewestTexels && shareOf(on, all) >= kGuessShare &&
           shareOf(on, inside) >= kGuessInside && spreadX(g) >= kSpread && spreadY(g) >= kSpread &&
           nearerShare() <= kGuessInFront && double(on) >= least * double(given.on);
}

SpaceScore scoreOf(const Surfaces& g, const std::vector<Texel>& texels, const SpaceGuess& guess) {
    SpaceScore score;
    for (const Texel& texel : texels) {
        ++score.all;
        glm::dvec3 p = texel.position;
        if (guess.place && !guess.place(texel, p)) continue;
        classify(g, *guess.distances, texel, p, guess.turn ? guess.turn(texel.normal) : texel.normal,
                 guess.factor, score);
    }
    return score;
}

}  // namespace lightwell
