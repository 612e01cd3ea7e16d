// A wall beside a lit floor: the light that the floor's VPLs bring, what bounding removes of it, and what the compensation
// gives back, against Lambert's polygon formula.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/compensation_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint32_t kWidth = 320, kHeight = 240;
constexpr double kRadiance = 1.5;

Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

// Floor y = 0, x in [-1, 1], z in [0, 2], lit; wall z = 0, y in [0, 1], dark. Seen from (0, 1.2, 3).
SentImage corner() {
    SentImage image(kWidth, kHeight);
    image.eye = {0, 1.2, 3};
    image.axis = reference::unit(Vec{0, 0.2, 0.4} - image.eye);
    const Vec right = reference::unit(cross(image.axis, {0, 1, 0})), up = cross(right, image.axis);
    const double tangent = 0.6, step = 2.0 * tangent / kWidth;
    image.pixelArea = step * step;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = 0; x < kWidth; ++x) {
            const Vec ray = image.axis + right * ((x + 0.5 - 0.5 * kWidth) * step) + up * ((0.5 * kHeight - y - 0.5) * step);
            const double toWall = -image.eye.z / ray.z, toFloor = -image.eye.y / ray.y;
            const Vec wall = image.eye + ray * toWall, floor = image.eye + ray * toFloor;
            if (ray.y < 0.0 && floor.z >= 0.0 && floor.z <= 2.0 && std::abs(floor.x) <= 1.0) {
                image.position.set(x, y, floor);
                image.normal.set(x, y, {0, 1, 0});
                image.radiance.set(x, y, {kRadiance, kRadiance, kRadiance});
            } else if (wall.y >= 0.0 && wall.y <= 1.0 && std::abs(wall.x) <= 1.0) {
                image.position.set(x, y, wall);
                image.normal.set(x, y, {0, 0, 1});
            }
        }
    return image;
}

// Lambert: E = L / 2 sum over the polygon's edges of angle times the normal's part along the edge's plane.
double polygonIrradiance(Vec p) {
    const Vec vertices[4] = {{-1, 0, 0}, {1, 0, 0}, {1, 0, 2}, {-1, 0, 2}};
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
        const Vec a = reference::unit(vertices[i] - p), b = reference::unit(vertices[(i + 1) % 4] - p);
        sum += std::acos(dot(a, b)) * reference::unit(cross(a, b)).z;
    }
    return 0.5 * kRadiance * std::abs(sum);
}

// What VPLs of area A on the floor light on average over where they stand.
double boundedIrradiance(Vec p, double area) {
    constexpr int kCells = 240;
    const double cell = 2.0 / kCells;
    double sum = 0.0;
    for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
            const Vec to = Vec{-1.0 + (i + 0.5) * cell, 0.0, (j + 0.5) * cell} - p;
            const double d2 = dot(to, to), c = to.z / std::sqrt(d2), cp = -to.y / std::sqrt(d2);
            sum += c * cp / (d2 + (1.0 + 3.0 * cp * cp) / 4.0 * area / kPi);
        }
    return kRadiance * sum * cell * cell;
}

struct Band {
    double truth = 0.0, bounded = 0.0, compensated = 0.0;
    double boundedError() const { return bounded / truth - 1.0; }
    double error() const { return compensated / truth - 1.0; }
};

// Means over the wall's pixels between two heights above the floor.
Band bandOf(const SentImage& image, const reference::Image& light, double low, double high, double area) {
    Band band;
    for (std::uint32_t y = 0; y < kHeight; ++y)
        for (std::uint32_t x = kWidth / 2 - 32; x < kWidth / 2 + 32; ++x) {
            const Vec p = image.position.get(x, y);
            if (!(image.normal.get(x, y).z > 0.5 && p.y > low && p.y < high)) continue;
            const double bounded = boundedIrradiance(p, area);
            band.truth += polygonIrradiance(p);
            band.bounded += bounded;
            band.compensated += bounded + light.get(x, y).x;
        }
    return band;
}

}  // namespace

// Within four pixels of the edge the floor's pixels are as deep as the wall's are far from it, and bounded by that: half of
// what was missing is missing still (seen: 0.45 for 64 VPLs, 0.55 for 256). Beyond, under 0.07 of it is.
TEST_CASE("near a common edge the compensated light is Lambert's", "[bounding_compensation][large]") {
    KernelRig rig(16);
    const SentImage image = corner();
    const double area = 4.0 / GENERATE(64.0, 256.0), flux = kPi * kRadiance * area;
    const std::vector<lw_vpl> vpls{reference::makeVpl({0, 0, 0}, {0, 1, 0}, {flux, flux, flux}, area)};
    const reference::Image coarse = compensate(rig, image, vpls, {4, 16, false}).light,
                           fine = compensate(rig, image, vpls, {4, 256, false}).light;
    const double bands[3][2] = {{0.02, 0.04}, {0.04, 0.08}, {0.08, 0.16}};
    for (const auto& range : bands) {
        const Band few = bandOf(image, coarse, range[0], range[1], area), many = bandOf(image, fine, range[0], range[1], area);
        CAPTURE(area, range[0], few.boundedError(), few.error(), many.error());
        CHECK(many.boundedError() < -0.05);
        CHECK(std::abs(few.error()) < 0.85 * std::abs(few.boundedError()));
        CHECK(std::abs(many.error()) < (range[0] < 0.04 ? 0.6 : 0.1) * std::abs(many.boundedError()));
    }
}
