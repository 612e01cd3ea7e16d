// SSIM: Wang, Bovik, Sheikh, Simoncelli 2004, "Image quality assessment: from error visibility to
// structural similarity", with their 11x11 Gaussian window. Score: the metric of the thesis behind LPV
// and VCT here (docs/accuracy.md), SSIM^1000 with constants for 0..255 on values in 0..1.
#include "ssim.h"

#include <array>
#include <cmath>

#include "separable_filter.h"

namespace studio {
namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5, kK1 = 0.01, kK2 = 0.03;
constexpr double kScorePower = 1000.0, kScoreScale = 10.0;
constexpr double kFittingRange = 1.0, kPublishedRange = 255.0;
constexpr std::array<const char*, 3> kRgb{"R", "G", "B"};

std::vector<double> windowMean(const std::vector<double>& plane, int width, int height) {
    static const std::vector<double> kernel = gaussianKernel<double>(kSigma, kRadius);
    return filterColumns(filterRows(plane, width, height, kernel, Border::Mirror), width, height, kernel,
                         Border::Mirror);
}

double scoreOf(double ssim) {
    return ssim <= 0.0 ? 0.0 : std::pow(ssim, kScorePower);
}

// True where the whole window lies inside; pictures smaller than the window count every pixel.
bool isCounted(std::size_t pixel, int width, int height) {
    if (width <= 2 * kRadius || height <= 2 * kRadius) return true;
    const int x = int(pixel % std::size_t(width)), y = int(pixel / std::size_t(width));
    return x >= kRadius && y >= kRadius && x < width - kRadius && y < height - kRadius;
}

// True where either picture has any light.
std::vector<bool> litPixels(const Image& x, const Image& y) {
    std::vector<bool> lit(x.pixelCount(), false);
    for (const Image* image : {&x, &y})
        for (const char* name : kRgb) {
            const std::vector<float>& plane = image->plane(name);
            for (std::size_t i = 0; i < plane.size(); ++i) lit[i] = lit[i] || plane[i] != 0.0f;
        }
    return lit;
}

}  // namespace

LocalMoments localMoments(const std::vector<float>& x, const std::vector<float>& y, int width,
                          int height) {
    const std::size_t count = x.size();
    const std::vector<double> wideX(x.begin(), x.end()), wideY(y.begin(), y.end());
    std::vector<double> squares(count), difference(count);
    for (std::size_t i = 0; i < count; ++i) {
        squares[i] = wideX[i] * wideX[i] + wideY[i] * wideY[i];
        difference[i] = (wideX[i] - wideY[i]) * (wideX[i] - wideY[i]);
    }
    LocalMoments moments;
    moments.meanX = windowMean(wideX, width, height);
    moments.meanY = windowMean(wideY, width, height);
    moments.varianceSum = windowMean(squares, width, height);
    moments.differenceVariance = windowMean(difference, width, height);
    for (std::size_t i = 0; i < count; ++i) {
        const double meanX = moments.meanX[i], meanY = moments.meanY[i];
        moments.varianceSum[i] -= meanX * meanX + meanY * meanY;
        moments.differenceVariance[i] -= (meanX - meanY) * (meanX - meanY);
    }
    return moments;
}

// (2 mx my + C1) / (mx^2 + my^2 + C1) = 1 - (mx - my)^2 / (mx^2 + my^2 + C1), and likewise
// (2 cov + C2) / (vx + vy + C2) = 1 - var(x - y) / (vx + vy + C2).
double ssimAt(const LocalMoments& moments, std::size_t pixel, double range) {
    const double c1 = kK1 * range * kK1 * range, c2 = kK2 * range * kK2 * range;
    const double meanX = moments.meanX[pixel], meanY = moments.meanY[pixel], step = meanX - meanY;
    const double luminance = 1.0 - step * step / (meanX * meanX + meanY * meanY + c1);
    const double structure = 1.0 - moments.differenceVariance[pixel] / (moments.varianceSum[pixel] + c2);
    return luminance * structure;
}

SsimResult compareSsim(const Image& x, const Image& y) {
    SsimResult result;
    result.map.assign(x.pixelCount(), 0.0f);
    const std::vector<bool> lit = litPixels(x, y);
    double ssimSum = 0.0, scoreSum = 0.0, score255Sum = 0.0;
    std::size_t ssimCount = 0, scoreCount = 0;
    for (const char* name : kRgb) {
        const LocalMoments moments = localMoments(x.plane(name), y.plane(name), x.width, x.height);
        for (std::size_t i = 0; i < x.pixelCount(); ++i) {
            const double ssim = ssimAt(moments, i, kFittingRange);
            result.map[i] += float(ssim) / 3.0f;
            if (isCounted(i, x.width, x.height)) {
                ssimSum += ssim;
                ++ssimCount;
            }
            if (!lit[i]) continue;
            scoreSum += scoreOf(ssimAt(moments, i, kPublishedRange));
            score255Sum += scoreOf(ssim);
            ++scoreCount;
        }
    }
    result.ssim = ssimSum / double(ssimCount);
    // Two black pictures have no pixel to judge, and are identical.
    result.score = scoreCount == 0 ? kScoreScale : kScoreScale * scoreSum / double(scoreCount);
    result.score255 = scoreCount == 0 ? kScoreScale : kScoreScale * score255Sum / double(scoreCount);
    return result;
}

}  // namespace studio
