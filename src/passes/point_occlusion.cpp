#include "passes/point_occlusion.h"

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <vector>

#include "compute/device.h"
#include "inputs/camera.h"
#include "shared/point_occlusion_types.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kRotations = 16;

// Depths closer than this share of the radius are the same surface. Smaller: floors seen at grazing angles hide their own
// points, a texel being deeper than the pixel. Larger: contact shadows lift off.
constexpr double kDepthBias = 0.01;
// The nearest point's share of the radius, where points crowd towards the pixel. Smaller: points of one texel's size.
constexpr double kLeastShare = 0.1;

double radicalInverse(std::uint32_t i, std::uint32_t base) {
    double result = 0.0, digit = 1.0;
    for (; i > 0; i /= base) result += (i % base) * (digit /= base);
    return result;
}

double fraction(double x) { return x - std::floor(x); }

// Halton points: elevation, azimuth and distance have a base each, so that no pair of them is ordered alike. In another turn all
// are shifted, by an additive sequence of three dimensions (Roberts 2018).
std::vector<cl_float4> pointsOf(const PointOcclusionOptions& options, std::uint32_t turn) {
    const double shift[3] = {fraction(0.5 + 0.8191725134 * turn), fraction(0.6710436067 * turn), fraction(0.5497004779 * turn)};
    std::vector<cl_float4> points(options.points);
    for (std::uint32_t i = 0; i < options.points; ++i) {
        const double u = (i + shift[0]) / options.points, angle = 2.0 * kPi * (radicalInverse(i, 2) + shift[1]);
        const double v = fraction(radicalInverse(i + 1, 3) + shift[2]);
        const double z = options.cosine ? std::sqrt(1.0 - u) : 1.0 - u, r = std::sqrt(1.0 - z * z);
        const double distance = options.packed ? kLeastShare + (1.0 - kLeastShare) * v * v : 1.0;
        points[i] = float4(distance * r * std::cos(angle), distance * r * std::sin(angle), distance * z, 0.0);
    }
    return points;
}

// Sixteenths of a turn, dealt so that every 2 x 2 block holds one of each quarter.
std::array<float, 2 * kRotations> rotationsOf() {
    static constexpr int kOrder[kRotations] = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    std::array<float, 2 * kRotations> rotations{};
    for (std::size_t i = 0; i < kRotations; ++i) {
        const double angle = 2.0 * kPi * kOrder[i] / kRotations;
        rotations[i] = float(std::cos(angle));
        rotations[kRotations + i] = float(std::sin(angle));
    }
    return rotations;
}

// Rays are linear in the pixel: p - eye = depth * (perI i + perJ j + constant), or, orthographic, that sum + depth * axis.
lw_point_view viewOf(const Camera& camera, const PointOcclusionOptions& options, std::uint32_t every, std::uint32_t fullHeight) {
    const auto& rays = camera.rays();
    // At a pixel's corner, not its centre: column 0 begins at 0.
    const glm::dvec3 corner = rays.constant;
    const glm::dmat3 toImage = glm::inverse(glm::dmat3(rays.perI, rays.perJ, camera.perspective() ? corner : camera.axis()));
    const glm::dvec3 offset = camera.perspective() ? glm::dvec3(0.0) : -(toImage * corner);
    const auto row = [&](int k, double scale) {
        return float4(scale * toImage[0][k], scale * toImage[1][k], scale * toImage[2][k], scale * offset[k]);
    };
    lw_point_view view{};
    view.eye = float4(camera.eye().x, camera.eye().y, camera.eye().z, camera.perspective() ? 1.0 : 0.0);
    view.column = row(0, 1.0 / every);
    view.row = row(1, 1.0 / every);
    view.depth = row(2, 1.0);
    view.range = float4(options.radius * glm::length(rays.perJ) * fullHeight, kDepthBias, options.rangeCheck ? 1.0 : 0.0,
                        double(options.points));
    return view;
}

}  // namespace

PointOcclusion::PointOcclusion(Device& device, const PointOcclusionOptions& options)
    : options_(options),
      gather_(device.programs().kernel("point_occlusion/point_occlusion", "point_occlusion_gather",
                                       {{"LW_LIGHT", options.light ? "1" : "0"}})),
      points_(device, options.points * sizeof(cl_float4), "points of the hemisphere"),
      rotations_(device, 2 * kRotations * sizeof(float), "rotations of the hemisphere") {}

void PointOcclusion::record(Executor& executor, const Planes& level, std::uint32_t every, std::uint32_t fullHeight,
                            const Camera& camera, std::uint32_t turn, const Planes& gathered) {
    if (uploaded_ != turn) {
        const auto points = pointsOf(options_, turn);
        const auto rotations = rotationsOf();
        executor.writeCopy("point_occlusion.upload", points_, 0, points_.bytes(), points.data());
        executor.writeCopy("point_occlusion.upload", rotations_, 0, rotations_.bytes(), rotations.data());
        uploaded_ = turn;
    }
    const Range items{(level.width + gather_.width() - 1) / gather_.width(), level.height};
    executor.run(options_.light ? "point_occlusion.gather" : "point_occlusion.gather_ambient", gather_, items,
                 gather_.width() == 1 ? Range{64, 1} : Range{8, 1}, level, cl_int(level.width), cl_int(level.height), points_,
                 rotations_, viewOf(camera, options_, every, fullHeight), gathered);
}

std::uint64_t PointOcclusion::estimateBytes(const PointOcclusionOptions& options) {
    return options.points * sizeof(cl_float4) + 2 * kRotations * sizeof(float);
}

}  // namespace lightwell
