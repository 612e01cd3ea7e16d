// Edge-avoiding wavelets whose coefficients shrink by their own noise.
//
// Sources: H. Dammertz et al., "Edge-Avoiding A-Trous Wavelet Transform for fast Global Illumination
// Filtering" (HPG 2010) for the levels F_0 (the traced image), F_1, ... F_n; D. Donoho and I. Johnstone,
// "Adapting to Unknown Smoothness via Wavelet Shrinkage" (1995) for shrinking details d_k = F_k -
// F_(k+1) by an estimate of their noise; F. Rousselle et al., "Adaptive Rendering with Non-Local Means
// Filtering" (2012) for telling noise from two halves of a pixel's samples.
//
// The windows know surfaces, not light, so a level is a linear map L: applied to half the difference of
// the halves' means it gives an image of the very noise of that level. With <> a mean over the pixel's
// surroundings (on its own surface, in the windows of this level and the next) the power of a detail is
// signal + noise, <d^2> = s + v, and v = <(L difference / 2)^2>; the coefficient with the least squared
// error is Wiener's, s / (s + v) = 1 - v / <d^2>. v is itself an estimate and taken for somewhat larger
// (cautionAt). As paths are added v falls to 0 and the traced
// image comes through unchanged; at few paths only the widest level is left.
//
// Approximations: one coefficient for the three channels, from their mean; surroundings count relative
// to their own brightness; the halves of one set of Sobol points are taken as independent, which holds
// the noise for larger than it is (by about a third).
#include "rival_shrink.h"

#include <algorithm>
#include <cmath>

#include "simd_clones.h"

namespace studio {
namespace {

// How many times its estimate the noise is taken for. Smaller: noise that looks like detail stays
// (Cornell, 4 paths, at 1: nRMSE 0.18 instead of 0.14). Larger: detail goes with the noise (living room,
// 64 paths, at 2: relMSE 0.70 instead of 0.54). At few paths the estimate itself is rough.
float cautionAt(int paths) {
    return 1.0f + std::sqrt(2.0f / float(paths));
}

struct Rows {
    const float* at[4];
};

Rows rowsOf(const PaddedPlanes& planes, int y) {
    Rows rows{};
    for (int c = 0; c < planes.planes(); ++c) rows.at[c] = planes.row(c, y);
    return rows;
}

// Powers of the detail between two levels and of its noise, relative to the coarser level.
STUDIO_SIMD void measureRow(const Rows& fine, const Rows& coarse, int width, float* __restrict power,
                            float* __restrict noise) {
    for (int x = 0; x < width; ++x) {
        const float base = coarse.at[0][x] + coarse.at[1][x] + coarse.at[2][x];
        const float all = fine.at[0][x] + fine.at[1][x] + fine.at[2][x];
        const float scale = base > 0.0f ? 1.0f / base : 0.0f;
        const float detail = (all - base) * scale;
        const float difference = 3.0f * (fine.at[3][x] - coarse.at[3][x]) * scale;
        power[x] = detail * detail;
        noise[x] = difference * difference;
    }
}

STUDIO_SIMD void addDetail(const Rows& fine, const Rows& coarse, const float* power, const float* noise,
                           float caution, int width, float* __restrict r, float* __restrict g,
                           float* __restrict b) {
    for (int x = 0; x < width; ++x) {
        const float excess = power[x] - caution * noise[x];
        const float share = excess > 0.0f ? excess / power[x] : 0.0f;
        r[x] += share * (fine.at[0][x] - coarse.at[0][x]);
        g[x] += share * (fine.at[1][x] - coarse.at[1][x]);
        b[x] += share * (fine.at[2][x] - coarse.at[2][x]);
    }
}

}  // namespace

ShrinkFilter::ShrinkFilter(int width, int height) : result_(width, height, kMeanPlanes) {
    for (PaddedPlanes& image : images_) image = PaddedPlanes(width, height, kPlanes);
    for (PaddedPlanes& power : powers_) power = PaddedPlanes(width, height, 2);
}

float ShrinkFilter::noiseScale(int a, int b) {
    return std::sqrt(float(a) * float(b)) / float(a + b);
}

const PaddedPlanes& ShrinkFilter::filter(WorkerPool& pool, const TracedSurfaces& surface,
                                         const std::vector<std::vector<Tap>>& windows, int paths) {
    const float caution = cautionAt(paths);
    const int width = result_.width();
    const auto forEachRow = [&](const auto& body) {
        pool.run(std::size_t(result_.height()), [&](std::size_t row, int) { body(int(row)); });
    };
    forEachRow([&](int y) {
        for (int c = 0; c < kMeanPlanes; ++c) std::fill_n(result_.row(c, y), width, 0.0f);
    });
    PaddedPlanes *fine = &images_[0], *coarse = &images_[1];
    for (std::size_t level = 0; level < windows.size(); ++level) {
        filterImage(pool, surface, windows[level], *fine, *coarse);
        forEachRow([&](int y) {
            measureRow(rowsOf(*fine, y), rowsOf(*coarse, y), width, powers_[0].row(0, y),
                       powers_[0].row(1, y));
        });
        // Of the last level the next window would be too wide to be of use.
        filterImage(pool, surface, windows[std::min(level + 1, windows.size() - 1)], powers_[0],
                    powers_[1]);
        filterImage(pool, surface, windows[level], powers_[1], powers_[0]);
        forEachRow([&](int y) {
            addDetail(rowsOf(*fine, y), rowsOf(*coarse, y), powers_[0].row(0, y), powers_[0].row(1, y),
                      caution, width, result_.row(0, y), result_.row(1, y), result_.row(2, y));
        });
        std::swap(fine, coarse);
    }
    forEachRow([&](int y) {
        for (int c = 0; c < kMeanPlanes; ++c) {
            const float* from = fine->row(c, y);
            float* to = result_.row(c, y);
            for (int x = 0; x < width; ++x) to[x] += from[x];
        }
    });
    return result_;
}

std::size_t ShrinkFilter::bytes() const {
    return images_[0].bytes() + images_[1].bytes() + powers_[0].bytes() + powers_[1].bytes() +
           result_.bytes();
}

}  // namespace studio
