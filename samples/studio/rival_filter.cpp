// Edge-aware averages over a picture's surfaces: a neighbour counts when its normal agrees and it lies
// near the pixel's tangent plane, as in the library's filters (kernels/shared/edge_weight.h).
//
// Sources: H. Dammertz et al., "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination
// Filtering" (HPG 2010); J. Kopf et al., "Joint Bilateral Upsampling" (SIGGRAPH 2007).
#include "rival_filter.h"

#include <algorithm>
#include <cstring>

#include "simd_clones.h"

namespace studio {
namespace {

// Cosine between normals at which a neighbour stops counting; full weight at 1, linear between.
constexpr float kNormalCosine = 0.8f;
// Slope off the tangent plane up to which a neighbour counts.
constexpr float kSlope = 0.7f;
constexpr int kBandRows = 16;
// Bilinear weight on its own surface that a pixel needs: less, and its light is traced for itself.
constexpr float kLeastWeight = 1e-3f;

// Rows of position, normal and colour: of a pixel's neighbour, or of the pixel itself.
struct Row {
    const float* position[3];
    const float* normal[3];
    const float* colour[3];
};

Row rowOf(const SurfacePlanes& surface, const PlanarBuffer* colour, int y) {
    Row row{};
    for (int c = 0; c < 3; ++c) {
        row.position[c] = surface.position->row(c, y);
        row.normal[c] = surface.normal->row(c, y);
        if (colour != nullptr) row.colour[c] = colour->row(c, y);
    }
    return row;
}

// sums[3] holds the weights' sum. `q` is read at x + dx; weights[x] counts besides `weight` when given.
STUDIO_SIMD void addTap(const Row& p, const Row& q, int dx, int begin, int end, float weight,
                        const float* weights, float* const* sums) {
    const float *px = p.position[0], *py = p.position[1], *pz = p.position[2];
    const float *nx = p.normal[0], *ny = p.normal[1], *nz = p.normal[2];
    const float *qx = q.position[0] + dx, *qy = q.position[1] + dx, *qz = q.position[2] + dx;
    const float *mx = q.normal[0] + dx, *my = q.normal[1] + dx, *mz = q.normal[2] + dx;
    const float *r = q.colour[0] + dx, *g = q.colour[1] + dx, *b = q.colour[2] + dx;
    float* __restrict sr = sums[0], * __restrict sg = sums[1], * __restrict sb = sums[2], * __restrict sw = sums[3];
#pragma GCC ivdep
    for (int x = begin; x < end; ++x) {
        const float ox = qx[x] - px[x], oy = qy[x] - py[x], oz = qz[x] - pz[x];
        const float squared = ox * ox + oy * oy + oz * oz;
        const float off = ox * nx[x] + oy * ny[x] + oz * nz[x];
        const float agreement = mx[x] * nx[x] + my[x] * ny[x] + mz[x] * nz[x];
        float w = (agreement - kNormalCosine) * (1.0f / (1.0f - kNormalCosine));
        w = w > 0.0f ? w : 0.0f;
        w = off * off <= kSlope * kSlope * squared ? w * weight : 0.0f;
        w = weights != nullptr ? w * weights[x] : w;
        sr[x] += w * r[x];
        sg[x] += w * g[x];
        sb[x] += w * b[x];
        sw[x] += w;
    }
}

STUDIO_SIMD void divideRow(float* const* sums, int width, float* r, float* g, float* b) {
    for (int x = 0; x < width; ++x) {
        const float scale = sums[3][x] > 0.0f ? 1.0f / sums[3][x] : 0.0f;
        r[x] = sums[0][x] * scale;
        g[x] = sums[1][x] * scale;
        b[x] = sums[2][x] * scale;
    }
}

// Four rows of sums.
struct Sums {
    std::vector<float> values;
    float* rows[4];
    explicit Sums(int width) : values(std::size_t(width) * 4) {
        for (int i = 0; i < 4; ++i) rows[i] = values.data() + std::ptrdiff_t(width) * i;
    }
    void clear() { std::fill(values.begin(), values.end(), 0.0f); }
};

// A coarse row stretched to the fine width: place x holds the coarse pixel left of it, x + factor the
// next; at both ends the last pixel is repeated.
struct StretchedRow {
    std::vector<float> values;
    Row row{};
    int y = -1;

    void stretch(const SurfacePlanes& coarse, const PlanarBuffer& colour, int coarseY,
                 const std::vector<int>& from) {
        if (y == coarseY) return;
        y = coarseY;
        const std::size_t length = from.size();
        values.resize(9 * length);
        const Row source = rowOf(coarse, &colour, y);
        const float* planes[9];
        const float** targets[9];
        for (int c = 0; c < 3; ++c) {
            planes[c] = source.position[c], targets[c] = &row.position[c];
            planes[3 + c] = source.normal[c], targets[3 + c] = &row.normal[c];
            planes[6 + c] = source.colour[c], targets[6 + c] = &row.colour[c];
        }
        for (std::size_t plane = 0; plane < 9; ++plane) {
            float* to = values.data() + plane * length;
            for (std::size_t i = 0; i < length; ++i) to[i] = planes[plane][from[i]];
            *targets[plane] = to;
        }
    }
};

}  // namespace

std::vector<Tap> patternWindow(int n) {
    std::vector<Tap> taps;
    const int reach = n / 2;
    for (int y = -reach; y <= reach; ++y)
        for (int x = -reach; x <= reach; ++x) {
            const bool endX = n % 2 == 0 && std::abs(x) == reach,
                       endY = n % 2 == 0 && std::abs(y) == reach;
            taps.push_back({x, y, (endX ? 0.5f : 1.0f) * (endY ? 0.5f : 1.0f)});
        }
    return taps;
}

std::vector<Tap> splineWindow(int step) {
    constexpr float kSpline[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};
    std::vector<Tap> taps;
    for (int y = -2; y <= 2; ++y)
        for (int x = -2; x <= 2; ++x)
            taps.push_back({x * step, y * step, kSpline[x + 2] * kSpline[y + 2]});
    return taps;
}

void filterImage(WorkerPool& pool, const SurfacePlanes& surface, const std::vector<Tap>& taps,
                 const PlanarBuffer& from, PlanarBuffer& to) {
    const int width = from.width(), height = from.height();
    pool.run(std::size_t((height + kBandRows - 1) / kBandRows), [&](std::size_t band, int) {
        Sums sums(width);
        const int first = int(band) * kBandRows;
        for (int y = first; y < std::min(first + kBandRows, height); ++y) {
            sums.clear();
            const Row pixel = rowOf(surface, nullptr, y);
            for (const Tap& tap : taps) {
                if (y + tap.dy < 0 || y + tap.dy >= height) continue;
                addTap(pixel, rowOf(surface, &from, y + tap.dy), tap.dx, std::max(0, -tap.dx),
                       std::min(width, width - tap.dx), tap.weight, nullptr, sums.rows);
            }
            divideRow(sums.rows, width, to.row(0, y), to.row(1, y), to.row(2, y));
        }
    });
}

std::vector<PixelPlace> upsampleImage(WorkerPool& pool, int factor, const SurfacePlanes& coarse,
                                      const PlanarBuffer& from, const SurfacePlanes& fine,
                                      PlanarBuffer& to) {
    const int width = to.width(), height = to.height();
    const int shift = factor / 2;  // of a coarse pixel in its block
    const auto left = [&](int at) { return at < shift ? -1 : (at - shift) / factor; };
    std::vector<int> columns;
    std::vector<float> nearRight, nearLeft;
    for (int x = 0; x < width + factor; ++x) {
        columns.push_back(std::clamp(left(x), 0, from.width() - 1));
        const float share = float(x + factor - shift) / float(factor);
        nearRight.push_back(share - std::floor(share));
        nearLeft.push_back(1.0f - nearRight.back());
    }

    const auto bands = std::size_t((height + kBandRows - 1) / kBandRows);
    std::vector<std::vector<PixelPlace>> missed(bands);
    pool.run(bands, [&](std::size_t band, int) {
        Sums sums(width);
        StretchedRow rows[2];
        const int first = int(band) * kBandRows;
        for (int y = first; y < std::min(first + kBandRows, height); ++y) {
            sums.clear();
            const Row pixel = rowOf(fine, nullptr, y);
            const int above = left(y);
            const float lower = nearRight[std::size_t(y % factor)];
            for (int j = 0; j < 2; ++j) {
                const float weight = j == 0 ? 1.0f - lower : lower;
                if (weight <= 0.0f) continue;
                StretchedRow& row = rows[std::size_t(above + j + 2) % 2];
                row.stretch(coarse, from, std::clamp(above + j, 0, from.height() - 1), columns);
                addTap(pixel, row.row, 0, 0, width, weight, nearLeft.data(), sums.rows);
                addTap(pixel, row.row, factor, 0, width, weight, nearRight.data(), sums.rows);
            }
            divideRow(sums.rows, width, to.row(0, y), to.row(1, y), to.row(2, y));
            for (int x = 0; x < width; ++x) {
                if (sums.rows[3][x] >= kLeastWeight) continue;
                const float *nx = pixel.normal[0], *ny = pixel.normal[1], *nz = pixel.normal[2];
                if (nx[x] != 0.0f || ny[x] != 0.0f || nz[x] != 0.0f) missed[band].push_back({x, y});
            }
        }
    });
    std::vector<PixelPlace> all;
    for (const auto& band : missed) all.insert(all.end(), band.begin(), band.end());
    return all;
}

}  // namespace studio
