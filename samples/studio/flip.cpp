// LDR-FLIP: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild 2020, "FLIP: A Difference
// Evaluator for Alternating Images", with its published constants; all filters are run as separable
// passes.
#include "flip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/glm.hpp>

#include "separable_filter.h"

namespace studio {
namespace {

using Planes = std::array<std::vector<float>, 3>;
constexpr double kPi = 3.14159265358979323846;

// Linear sRGB to XYZ, by rows, as the paper's supplement rounds it.
constexpr double kToXyz[3][3] = {
    {10135552.0 / 24577794.0, 8788810.0 / 24577794.0, 4435075.0 / 24577794.0},
    {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
    {1425312.0 / 73733382.0, 8788810.0 / 73733382.0, 70074185.0 / 73733382.0},
};

// The colour conversions relative to white, so that white is XYZ = (1, 1, 1).
struct Conversion {
    glm::mat3 toRelativeXyz, fromRelativeXyz;
    Conversion() {
        glm::dmat3 matrix;  // GLM: matrix[column][row]
        for (int row = 0; row < 3; ++row) {
            const double white = kToXyz[row][0] + kToXyz[row][1] + kToXyz[row][2];
            for (int column = 0; column < 3; ++column) matrix[column][row] = kToXyz[row][column] / white;
        }
        toRelativeXyz = glm::mat3(matrix);
        fromRelativeXyz = glm::mat3(glm::inverse(matrix));
    }
};
const Conversion& conversion() {
    static const Conversion kConversion;
    return kConversion;
}

// Opponent space YCxCz: linear in light, so it may be filtered as the eye does (paper, section 4.1.1).
glm::vec3 toOpponent(const glm::vec3& rgb) {
    const glm::vec3 xyz = conversion().toRelativeXyz * rgb;
    return {116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z)};
}

glm::vec3 opponentToRgb(const glm::vec3& opponent) {
    const float y = (opponent.x + 16.0f) / 116.0f;
    return conversion().fromRelativeXyz * glm::vec3(y + opponent.y / 500.0f, y, y - opponent.z / 200.0f);
}

float labCurve(float t) {
    constexpr float kDelta = 6.0f / 29.0f;
    return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
}

// CIELAB with the Hunt effect: chroma counts less where it is dark (section 4.1.2).
glm::vec3 toHuntLab(const glm::vec3& rgb) {
    const glm::vec3 xyz = conversion().toRelativeXyz * rgb;
    const float fx = labCurve(xyz.x), fy = labCurve(xyz.y), fz = labCurve(xyz.z);
    const float lightness = 116.0f * fy - 16.0f;
    return {lightness, 0.01f * lightness * 500.0f * (fx - fy), 0.01f * lightness * 200.0f * (fy - fz)};
}

// City-block in lightness, Euclidean in chroma (section 4.1.3).
float hyabDistance(const glm::vec3& a, const glm::vec3& b) {
    const glm::vec3 d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

// One Gaussian term a * sqrt(pi / b) * exp(-pi^2 x^2 / b) of a contrast sensitivity function, x in
// degrees.
struct SensitivityTerm {
    double a, b;
};
// Table 1 of the paper: achromatic, red-green, blue-yellow. The widest decides the radius of all.
constexpr SensitivityTerm kAchromatic{1.0, 0.0047}, kRedGreen{1.0, 0.0053};
constexpr SensitivityTerm kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

std::vector<float> sensitivityKernel(const SensitivityTerm& term, double pixelsPerDegree, double& sum) {
    const int radius =
        int(std::ceil(3.0 * std::sqrt(kBlueYellow[0].b / (2.0 * kPi * kPi)) * pixelsPerDegree));
    std::vector<double> weights;
    sum = 0.0;
    for (int x = -radius; x <= radius; ++x) {
        const double degrees = double(x) / pixelsPerDegree;
        weights.push_back(std::exp(-kPi * kPi * degrees * degrees / term.b));
        sum += weights.back();
    }
    std::vector<float> kernel;
    for (double weight : weights) kernel.push_back(float(weight / sum));
    return kernel;
}

std::vector<float> filterBoth(const std::vector<float>& plane, int width, int height,
                              const std::vector<float>& rows, const std::vector<float>& columns) {
    return filterColumns(filterRows(plane, width, height, rows, Border::Clamp), width, height, columns,
                         Border::Clamp);
}

// What the eye resolves at this distance, in YCxCz.
Planes filterSensitivity(const Planes& opponent, int width, int height, double pixelsPerDegree) {
    double sum = 0.0, sum0 = 0.0, sum1 = 0.0;
    const std::vector<float> achromatic = sensitivityKernel(kAchromatic, pixelsPerDegree, sum);
    const std::vector<float> redGreen = sensitivityKernel(kRedGreen, pixelsPerDegree, sum);
    const std::vector<float> wide = sensitivityKernel(kBlueYellow[0], pixelsPerDegree, sum0);
    const std::vector<float> narrow = sensitivityKernel(kBlueYellow[1], pixelsPerDegree, sum1);
    // Share of each term in the kernel's two-dimensional sum, which is normalised to 1 as a whole.
    const double share0 = kBlueYellow[0].a * std::sqrt(kPi / kBlueYellow[0].b) * sum0 * sum0;
    const double share1 = kBlueYellow[1].a * std::sqrt(kPi / kBlueYellow[1].b) * sum1 * sum1;
    const float wideShare = float(share0 / (share0 + share1)),
                narrowShare = float(share1 / (share0 + share1));

    Planes filtered{filterBoth(opponent[0], width, height, achromatic, achromatic),
                    filterBoth(opponent[1], width, height, redGreen, redGreen),
                    filterBoth(opponent[2], width, height, wide, wide)};
    const std::vector<float> second = filterBoth(opponent[2], width, height, narrow, narrow);
    for (std::size_t i = 0; i < second.size(); ++i)
        filtered[2][i] = wideShare * filtered[2][i] + narrowShare * second[i];
    return filtered;
}

// First (edge) or second (point) derivative of the Gaussian; positive weights sum to 1, negative to -1.
std::vector<float> derivativeKernel(double sigma, int radius, int order) {
    std::vector<double> weights;
    double positive = 0.0, negative = 0.0;
    for (int x = -radius; x <= radius; ++x) {
        const double t = x / sigma, gaussian = std::exp(-0.5 * t * t);
        weights.push_back(order == 1 ? -t * gaussian : (t * t - 1.0) * gaussian);
        (weights.back() > 0.0 ? positive : negative) += std::abs(weights.back());
    }
    std::vector<float> kernel;
    for (double weight : weights) kernel.push_back(float(weight / (weight > 0.0 ? positive : negative)));
    return kernel;
}

struct Features {
    std::vector<float> edge, point;
};  // magnitudes

std::vector<float> magnitude(std::vector<float> x, const std::vector<float>& y) {
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    return x;
}

// Edges and points of the luminance in [0,1], 0.082 degrees wide (section 4.2).
Features detectFeatures(std::vector<float> luminance, int width, int height, double pixelsPerDegree) {
    constexpr double kFeatureWidth = 0.082;
    const double sigma = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int radius = int(std::ceil(3.0 * sigma));
    const std::vector<float> smooth = gaussianKernel<float>(sigma, radius);
    const std::vector<float> edge = derivativeKernel(sigma, radius, 1),
                             point = derivativeKernel(sigma, radius, 2);
    for (float& value : luminance) value = (value + 16.0f) / 116.0f;
    const std::vector<float> smoothed = filterRows(luminance, width, height, smooth, Border::Clamp);
    return {magnitude(filterBoth(luminance, width, height, edge, smooth),
                      filterColumns(smoothed, width, height, edge, Border::Clamp)),
            magnitude(filterBoth(luminance, width, height, point, smooth),
                      filterColumns(smoothed, width, height, point, Border::Clamp))};
}

// Raw colour distance to [0,1]: the first 40 % of the range get 95 % of the scale (section 4.1.4).
float redistribute(float distance) {
    constexpr float kPower = 0.7f, kKnee = 0.4f, kAtKnee = 0.95f;
    static const float kLargest =
        std::pow(hyabDistance(toHuntLab({0.0f, 1.0f, 0.0f}), toHuntLab({0.0f, 0.0f, 1.0f})), kPower);
    const float error = std::pow(distance, kPower), knee = kKnee * kLargest;
    if (error < knee) return kAtKnee / knee * error;
    return kAtKnee + (error - knee) / (kLargest - knee) * (1.0f - kAtKnee);
}

// A picture through the eye: perceived colour and features.
struct Percept {
    std::vector<glm::vec3> colour;
    Features features;
};
Percept perceive(const Image& image, double pixelsPerDegree) {
    const std::vector<float>&r = image.plane("R"), &g = image.plane("G"), &b = image.plane("B");
    Planes opponent;
    for (std::vector<float>& plane : opponent) plane.resize(image.pixelCount());
    for (std::size_t i = 0; i < r.size(); ++i) {
        const glm::vec3 value = toOpponent({r[i], g[i], b[i]});
        for (int c = 0; c < 3; ++c) opponent[std::size_t(c)][i] = value[c];
    }
    const Planes seen = filterSensitivity(opponent, image.width, image.height, pixelsPerDegree);
    Percept percept;
    percept.colour.resize(image.pixelCount());
    for (std::size_t i = 0; i < r.size(); ++i) {
        const glm::vec3 rgb = opponentToRgb({seen[0][i], seen[1][i], seen[2][i]});
        percept.colour[i] = toHuntLab(glm::clamp(rgb, 0.0f, 1.0f));  // the metric's own clamp
    }
    percept.features =
        detectFeatures(std::move(opponent[0]), image.width, image.height, pixelsPerDegree);
    return percept;
}

}  // namespace

std::vector<float> flipMap(const Image& image, const Image& reference, double pixelsPerDegree) {
    constexpr float kFeatureScale = 0.70710678f;
    const Percept a = perceive(image, pixelsPerDegree), b = perceive(reference, pixelsPerDegree);
    std::vector<float> flip(image.pixelCount());
    for (std::size_t i = 0; i < flip.size(); ++i) {
        const float colour = redistribute(hyabDistance(a.colour[i], b.colour[i]));
        const float feature = std::max(std::abs(a.features.edge[i] - b.features.edge[i]),
                                       std::abs(a.features.point[i] - b.features.point[i]));
        const float scaled = std::min(std::sqrt(kFeatureScale * feature), 1.0f);
        flip[i] = std::pow(colour, 1.0f - scaled);
    }
    return flip;
}

}  // namespace studio
