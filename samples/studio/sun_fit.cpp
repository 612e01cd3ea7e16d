// Fits a sun's reflective shadow map to what a view needs.
//
// A coarse cast over the scene finds the lit surfaces; each is weighted by the light it could send to
// a coarse subset of the view's pixels (bounded point-to-disc term, facing each other, no visibility:
// what is hidden may still count in a gather without visibility). The rectangle that keeps all but
// kLeftOut of this estimate is then widened by a cell and snapped, so that a moving camera changes
// the map in whole texels only. Without a view, or when nothing lit faces it, the rectangle is that of
// all geometry, whose outline is lit by definition.
#include "sun_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "parallel.h"

namespace studio {
namespace {

constexpr int kCells = 256;        // coarse cast per side: a cell is 0.4 % of the scene
constexpr int kViewPixels = 24;    // view pixels per side of the subset
constexpr double kLeftOut = 5e-4;  // half of the 0.1 % allowed; the rest is for the estimate's own grain
constexpr double kSizeSteps = 4.0;  // map sizes are the scene's halved in so many steps

struct Pixel {
    glm::vec3 position, normal;
};

std::vector<Pixel> viewSubset(const GBuffer& view) {
    std::vector<Pixel> pixels;
    for (int j = 0; j < kViewPixels; ++j)
        for (int i = 0; i < kViewPixels; ++i) {
            const int x = (2 * i + 1) * view.width / (2 * kViewPixels);
            const int y = (2 * j + 1) * view.height / (2 * kViewPixels);
            const glm::vec3 normal = view.normal.rgb(x, y);
            if (normal != glm::vec3(0.0f)) pixels.push_back({view.position.rgb(x, y), normal});
        }
    return pixels;
}

// Light that each cell of `whole` could send to the pixels, rows from lower to upper.
std::vector<double> estimate(const RayScene& scene, const Light& light, const LightAxes& axes,
                             const SunRect& whole, double nearBack, const std::vector<Pixel>& pixels) {
    std::vector<double> weights(std::size_t(kCells) * kCells, 0.0);
    const glm::dvec2 cell = whole.size() / double(kCells);
    const float area = float(cell.x * cell.y);
    parallelRows(kCells, [&](int row) {
        for (int column = 0; column < kCells; ++column) {
            const glm::dvec2 at = whole.lower + cell * (glm::dvec2(column, row) + 0.5);
            const glm::vec3 origin(axes.right * at.x + axes.up * at.y + axes.back * nearBack);
            Hit hit;
            if (!scene.trace(origin, light.direction, 0.0f, std::numeric_limits<float>::infinity(), hit))
                continue;
            const glm::vec3 flux = hit.albedo * light.emitted;
            double sum = 0.0;
            for (const Pixel& pixel : pixels) {
                const glm::vec3 way = hit.position - pixel.position;
                const float c = glm::dot(pixel.normal, way), cp = -glm::dot(hit.geometricNormal, way);
                if (c <= 0.0f || cp <= 0.0f) continue;
                const float squared = glm::dot(way, way);
                sum += double(c * cp / (squared * (squared + area / kPi)));
            }
            weights[std::size_t(row) * kCells + std::size_t(column)] =
                sum * double(std::max({flux.x, flux.y, flux.z}));
        }
    });
    return weights;
}

// Cells [x0, x1) x [y0, y1).
struct CellRect {
    int x0 = 0, y0 = 0, x1 = kCells, y1 = kCells;
};

double columnSum(const std::vector<double>& w, int x, const CellRect& r) {
    double sum = 0.0;
    for (int y = r.y0; y < r.y1; ++y) sum += w[std::size_t(y) * kCells + std::size_t(x)];
    return sum;
}
double rowSum(const std::vector<double>& w, int y, const CellRect& r) {
    double sum = 0.0;
    for (int x = r.x0; x < r.x1; ++x) sum += w[std::size_t(y) * kCells + std::size_t(x)];
    return sum;
}

// Takes the poorest edge row or column away until no more may be left out.
CellRect trim(const std::vector<double>& weights, double total) {
    CellRect r;
    double budget = kLeftOut * total;
    while (r.x1 - r.x0 > 1 && r.y1 - r.y0 > 1) {
        const std::array<double, 4> edges = {
            columnSum(weights, r.x0, r) / (r.y1 - r.y0), columnSum(weights, r.x1 - 1, r) / (r.y1 - r.y0),
            rowSum(weights, r.y0, r) / (r.x1 - r.x0), rowSum(weights, r.y1 - 1, r) / (r.x1 - r.x0)};
        const int side = int(std::min_element(edges.begin(), edges.end()) - edges.begin());
        const double loss = edges[std::size_t(side)] * (side < 2 ? r.y1 - r.y0 : r.x1 - r.x0);
        if (loss > budget) break;
        budget -= loss;
        if (side == 0)
            ++r.x0;
        else if (side == 1)
            --r.x1;
        else if (side == 2)
            ++r.y0;
        else
            --r.y1;
    }
    return r;
}

// Size rounded up to a step of the scene's, lower edge down to a whole texel.
SunRect snapped(const SunRect& needed, const SunRect& whole, int texels) {
    SunRect result;
    for (int axis = 0; axis < 2; ++axis) {
        // One texel more than needed, so that snapping the lower edge can't uncover the upper one.
        const double slack = double(texels) / std::max(1, texels - 1);
        const double base = whole.size()[axis] * slack, wanted = needed.size()[axis] * slack;
        const double steps = std::max(0.0, std::floor(kSizeSteps * std::log2(base / wanted)));
        const double size = base * std::exp2(-steps / kSizeSteps), texel = size / texels;
        result.lower[axis] = std::floor(needed.lower[axis] / texel) * texel;
        result.upper[axis] = result.lower[axis] + size;
    }
    return result;
}

double weightInside(const std::vector<double>& weights, const SunRect& whole, const SunRect& part) {
    const glm::dvec2 cell = whole.size() / double(kCells);
    double sum = 0.0;
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) {
            const glm::dvec2 at = whole.lower + cell * (glm::dvec2(x, y) + 0.5);
            if (at.x >= part.lower.x && at.x < part.upper.x && at.y >= part.lower.y &&
                at.y < part.upper.y)
                sum += weights[std::size_t(y) * kCells + std::size_t(x)];
        }
    return sum;
}

// The half-size rectangle on the coarser one's texel edges that holds most of the estimated light.
SunRect finer(const SunRect& coarse, int texels, const std::vector<double>& weights,
              const SunRect& whole) {
    const glm::dvec2 texel = coarse.size() / double(texels);
    const int half = texels / 2, step = std::max(1, texels / 32);
    SunRect best;
    double most = -1.0;
    for (int y = 0; y <= half; y += step)
        for (int x = 0; x <= half; x += step) {
            SunRect part;
            part.lower = coarse.lower + texel * glm::dvec2(x, y);
            part.upper = part.lower + texel * double(half);
            const double weight = weights.empty() ? 0.0 : weightInside(weights, whole, part);
            // Without an estimate, or among equals, the one nearest the middle.
            const double off = glm::length(glm::dvec2(x, y) / double(half) - 0.5);
            if (weight > most * (1.0 + 1e-9) ||
                (weight >= most * (1.0 - 1e-9) &&
                 off < glm::length((best.lower - coarse.lower) / texel / double(half) - 0.5))) {
                most = std::max(most, weight);
                best = part;
            }
        }
    return best;
}

}  // namespace

LightAxes::LightAxes(const glm::vec3& direction) {
    back = -glm::normalize(glm::dvec3(direction));
    // "Up" is the world axis most across the light, +Y where it may be.
    const glm::dvec3 across = std::abs(back.y) < 0.9   ? glm::dvec3(0, 1, 0)
                              : std::abs(back.z) < 0.9 ? glm::dvec3(0, 0, -1)
                                                       : glm::dvec3(1, 0, 0);
    right = glm::normalize(glm::cross(across, back));
    up = glm::cross(back, right);
}

glm::mat3 LightAxes::rows() const {
    return glm::mat3(glm::transpose(glm::dmat3(right, up, back)));
}

SunFit fitSun(const RayScene& scene, const Light& light, const RsmOptions& options) {
    const LightAxes axes(light.direction);
    glm::vec3 lower, upper;
    scene.boundsAlong(axes.rows(), lower, upper);
    SunFit fit;
    const double margin = 1e-3 * double(scene.diagonal());
    fit.nearBack = double(upper.z) + margin;
    fit.farBack = double(lower.z) - margin;
    SunRect whole;
    // A share of the diagonal wider: a scene edge-on to the light still has an area.
    whole.lower = glm::dvec2(lower) - margin;
    whole.upper = glm::dvec2(upper) + margin;

    SunRect needed = whole;
    std::vector<double> weights;
    if (options.view != nullptr) {
        weights = estimate(scene, light, axes, whole, fit.nearBack, viewSubset(*options.view));
        double total = 0.0;
        for (const double w : weights) total += w;
        if (total > 0.0) {
            const CellRect r = trim(weights, total);
            const glm::dvec2 cell = whole.size() / double(kCells);
            needed.lower = glm::max(whole.lower, whole.lower + cell * glm::dvec2(r.x0 - 1, r.y0 - 1));
            needed.upper = glm::min(whole.upper, whole.lower + cell * glm::dvec2(r.x1 + 1, r.y1 + 1));
        }
    }
    fit.cascades.push_back(snapped(needed, whole, options.size));
    for (int i = 1; i < options.cascades; ++i)
        fit.cascades.insert(fit.cascades.begin(),
                            finer(fit.cascades.front(), options.size, weights, whole));
    return fit;
}

}  // namespace studio
