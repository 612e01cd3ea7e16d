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
// Slope off the tangent plane up to which a neighbour counts. Of the filter: at 0.7 light crosses folds
// and arches (Sponza, 16 paths: relMSE 0.43 instead of 0.28), at 0.1 noise stays on curved surfaces. Of
// the up-sampling, whose pixels are nearer: at 0.25 twice as many find no neighbour and are traced.
constexpr float kSlope = 0.25f, kUpsampleSlope = 0.7f;
constexpr int kBandRows = 16;
// Bilinear weight on its own surface that a pixel needs: less, and its light is traced for itself.
constexpr float kLeastWeight = 1e-3f;

constexpr int kMostPlanes = 4;  // of an image that is filtered

// Rows of position, normal and colour: of a pixel's neighbour, or of the pixel itself.
struct Row {
    const float* position[3];
    const float* normal[3];
    const float* colour[kMostPlanes];
};

template <class Surfaces>
Row rowOf(const Surfaces& surface, int y) {
    Row row{};
    for (int c = 0; c < 3; ++c) {
        row.position[c] = surface.position.row(c, y);
        row.normal[c] = surface.normal.row(c, y);
    }
    return row;
}
Row rowOf(const TracedSurfaces& surface, const PaddedPlanes& colour, int y) {
    Row row = rowOf(surface, y);
    for (int c = 0; c < colour.planes(); ++c) row.colour[c] = colour.row(c, y);
    return row;
}

// Taps of one row of the window, added in one sweep so that the pixel's own values and the sums are
// loaded once for all of them. Windows with fewer get taps of weight 0.
constexpr int kTogether = 5;
struct RowTaps {
    int dx[kTogether] = {};
    float weight[kTogether] = {};
};

// sums[kPlanes] holds the weights' sum.
template <int kPlanes>
[[gnu::always_inline]] inline void addTaps(const Row& p, const Row& q, const RowTaps& taps, int width,
                                           float* const* sums) {
    const float *px = p.position[0], *py = p.position[1], *pz = p.position[2];
    const float *nx = p.normal[0], *ny = p.normal[1], *nz = p.normal[2];
    const float *qx = q.position[0], *qy = q.position[1], *qz = q.position[2];
    const float *mx = q.normal[0], *my = q.normal[1], *mz = q.normal[2];
    const float *q0 = q.colour[0], *q1 = q.colour[1], *q2 = kPlanes > 2 ? q.colour[2] : nullptr,
                *q3 = kPlanes > 3 ? q.colour[3] : nullptr;
    float* __restrict s0 = sums[0], * __restrict s1 = sums[1], * __restrict s2 = sums[2], * __restrict s3 = sums[3],
        * __restrict s4 = sums[4];
    const int d0 = taps.dx[0], d1 = taps.dx[1], d2 = taps.dx[2], d3 = taps.dx[3], d4 = taps.dx[4];
    constexpr float kSteep = 1.0f / (1.0f - kNormalCosine);
    const float w0 = taps.weight[0] * kSteep, w1 = taps.weight[1] * kSteep, w2 = taps.weight[2] * kSteep,
                w3 = taps.weight[3] * kSteep, w4 = taps.weight[4] * kSteep;
#pragma GCC ivdep
    for (int x = 0; x < width; ++x) {
        float c0 = s0[x], c1 = s1[x], c2 = s2[x], c3 = 0.0f, c4 = 0.0f;
        if (kPlanes > 2) c3 = s3[x];
        if (kPlanes > 3) c4 = s4[x];
        const float ax = px[x], ay = py[x], az = pz[x], bx = nx[x], by = ny[x], bz = nz[x];
        const auto add = [&](int at, float weight) {
            const float ox = qx[at] - ax, oy = qy[at] - ay, oz = qz[at] - az;
            const float squared = ox * ox + oy * oy + oz * oz;
            const float off = ox * bx + oy * by + oz * bz;
            const float agreement = mx[at] * bx + my[at] * by + mz[at] * bz;
            float w = agreement - kNormalCosine;
            w = w > 0.0f ? w * weight : 0.0f;
            w = off * off <= kSlope * kSlope * squared ? w : 0.0f;
            c0 += w * q0[at];
            c1 += w * q1[at];
            if (kPlanes == 2) c2 += w;
            if (kPlanes > 2) c2 += w * q2[at];
            if (kPlanes == 3) c3 += w;
            if (kPlanes > 3) c3 += w * q3[at], c4 += w;
        };
        add(x + d0, w0);
        add(x + d1, w1);
        add(x + d2, w2);
        add(x + d3, w3);
        add(x + d4, w4);
        s0[x] = c0, s1[x] = c1, s2[x] = c2;
        if (kPlanes > 2) s3[x] = c3;
        if (kPlanes > 3) s4[x] = c4;
    }
}

STUDIO_SIMD void addTapsOf2(const Row& p, const Row& q, const RowTaps& taps, int width, float* const* sums) {
    addTaps<2>(p, q, taps, width, sums);
}
STUDIO_SIMD void addTapsOf3(const Row& p, const Row& q, const RowTaps& taps, int width, float* const* sums) {
    addTaps<3>(p, q, taps, width, sums);
}
STUDIO_SIMD void addTapsOf4(const Row& p, const Row& q, const RowTaps& taps, int width, float* const* sums) {
    addTaps<4>(p, q, taps, width, sums);
}

// sums[3] holds the weights' sum. `q` is read at x + dx; weights[x] counts besides `weight`.
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
        w = off * off <= kUpsampleSlope * kUpsampleSlope * squared ? w * weight : 0.0f;
        w *= weights[x];
        sr[x] += w * r[x];
        sg[x] += w * g[x];
        sb[x] += w * b[x];
        sw[x] += w;
    }
}

STUDIO_SIMD void divideRow(const float* __restrict sum, const float* __restrict weight, int width,
                           float* __restrict to) {
    for (int x = 0; x < width; ++x) to[x] = weight[x] > 0.0f ? sum[x] * (1.0f / weight[x]) : 0.0f;
}

// Rows of sums: of each plane, then of the weights.
struct Sums {
    std::vector<float> values;
    float* rows[kMostPlanes + 1];
    explicit Sums(int width) : values(std::size_t(width) * (kMostPlanes + 1)) {
        for (int i = 0; i <= kMostPlanes; ++i) rows[i] = values.data() + std::ptrdiff_t(width) * i;
    }
    void clear() { std::fill(values.begin(), values.end(), 0.0f); }
    template <class Planes>
    void divideTo(Planes& to, int planes, int y) const {
        for (int c = 0; c < planes; ++c) divideRow(rows[c], rows[planes], to.width(), to.row(c, y));
    }
};

// A coarse row stretched to the fine width: place x holds the coarse pixel left of it, x + factor the
// next; at both ends the last pixel is repeated.
struct StretchedRow {
    std::vector<float> values;
    Row row{};
    int y = -1;

    void stretch(const TracedSurfaces& coarse, const PaddedPlanes& colour, int coarseY,
                 const std::vector<int>& from) {
        if (y == coarseY) return;
        y = coarseY;
        const std::size_t length = from.size();
        values.resize(9 * length);
        const Row source = rowOf(coarse, colour, y);
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

void filterImage(WorkerPool& pool, const TracedSurfaces& surface, const std::vector<Tap>& taps,
                 const PaddedPlanes& from, PaddedPlanes& to) {
    const int width = from.width(), height = from.height(), planes = from.planes();
    const auto addRow = planes == 2 ? addTapsOf2 : planes == 3 ? addTapsOf3 : addTapsOf4;
    pool.run(std::size_t((height + kBandRows - 1) / kBandRows), [&](std::size_t band, int) {
        Sums sums(width);
        const int first = int(band) * kBandRows;
        for (int y = first; y < std::min(first + kBandRows, height); ++y) {
            sums.clear();
            for (std::size_t t = 0; t < taps.size();) {
                const int dy = taps[t].dy;
                RowTaps together;
                for (int i = 0; i < kTogether && t < taps.size() && taps[t].dy == dy; ++i, ++t) {
                    together.dx[i] = taps[t].dx;
                    together.weight[i] = taps[t].weight;
                }
                if (y + dy >= 0 && y + dy < height)
                    addRow(rowOf(surface, y), rowOf(surface, from, y + dy), together, width, sums.rows);
            }
            sums.divideTo(to, planes, y);
        }
    });
}

std::vector<PixelPlace> upsampleImage(WorkerPool& pool, int factor, const TracedSurfaces& coarse,
                                      const PaddedPlanes& from, const GBuffer& fine, PlanarBuffer& to) {
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
            const Row pixel = rowOf(fine, y);
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
            sums.divideTo(to, 3, y);
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
