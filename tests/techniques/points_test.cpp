// lwRenderPoints through the C API: the same light as lwRender's to the bit, whatever the list.
#include <catch2/catch.hpp>
#include <cmath>

#include "support/points_makers.h"
#include "support/points_rig.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 61, kHeight = 32;

double tilesProfile(double x, double z) { return std::fmod(std::floor(x * 9.1) + std::floor(z * 9.1), 2.0) != 0.0 ? 0.2 : 1.0; }

struct Room : PointRoom {
    Room() : PointRoom(64, tilesProfile, kWidth, kHeight) {}
};

// Packed planes of a view as r, g, b of each pixel.
std::vector<float> interleavedPixels(const std::vector<float>& planes) {
    const std::size_t n = planes.size() / 3;
    std::vector<float> values(planes.size());
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t c = 0; c < 3; ++c) values[3 * i + c] = planes[c * n + i];
    return values;
}

std::uint32_t backgrounds(const PointList& list) {
    std::uint32_t count = 0;
    for (std::size_t i = 0; i < list.count(); ++i)
        count += list.normals[3 * i] == 0.0f && list.normals[3 * i + 1] == 0.0f && list.normals[3 * i + 2] == 0.0f ? 1 : 0;
    return count;
}

}  // namespace

TEST_CASE("light at points is the view's at its pixels, to the bit, and leaves the view as it is", "[points]") {
    TestDevice device(GENERATE(1u, 16u));
    const Room room;
    const PointList list = PointList::ofScene(room.scene);
    for (const Maker& maker : makers()) {
        CAPTURE(maker.name);
        const auto technique = maker.make(device);
        TestView view(device, kWidth, kHeight);
        technique->update(room.frame);
        const std::vector<float> picture = technique->render(view, room.scene.gbuffer);
        const PointLights points = renderPoints(device, *technique, list);
        CHECK(points.irradiance == interleavedPixels(picture));
        CHECK(technique->render(view, room.scene.gbuffer) == picture);
        CHECK(technique->count("points") == list.count());
        CHECK(technique->count("rejected_points") == backgrounds(list));
        // Each output alone.
        CHECK(renderPoints(device, *technique, list, kPointIrradiance).irradiance == points.irradiance);
        CHECK(renderPoints(device, *technique, list, kPointHarmonics).harmonics == points.harmonics);
        CHECK(renderPoints(device, *technique, list, kPointValidity).validity == points.validity);
        CHECK(technique->count("points") == 4 * list.count());
        double lit = 0.0;
        for (const float e : points.irradiance) lit += double(e);
        CHECK(lit > 0.0);
    }
}

TEST_CASE("a point's light does not depend on the list around it", "[points]") {
    TestDevice device(16);
    const Room room;
    const PointList all = PointList::ofScene(room.scene);
    for (const Maker& maker : makers()) {
        CAPTURE(maker.name);
        const auto technique = maker.make(device);
        technique->update(room.frame);
        const PointLights whole = renderPoints(device, *technique, all);
        for (const std::size_t number : {1u, 7u, 255u, 256u, 257u, 1000u}) {
            const std::size_t first = 311;
            const PointLights part = renderPoints(device, *technique, all.part(first, number));
            bool same = true;
            for (std::size_t i = 0; i < number; ++i) {
                same = same && std::equal(&part.irradiance[3 * i], &part.irradiance[3 * i] + 3, &whole.irradiance[3 * (first + i)]);
                same = same && part.validity[i] == whole.validity[first + i];
                for (std::size_t b = 0; b < 4; ++b) same = same && part.band(b, i) == whole.band(b, first + i);
            }
            CAPTURE(number);
            CHECK(same);
        }
    }
}

TEST_CASE("interleaving, filter, half resolution and history do not reach points", "[points]") {
    TestDevice device(16);
    const Room room;
    const PointList list = PointList::ofScene(room.scene);
    const auto reference = rsmOf(256, 1).make(device);
    reference->update(room.frame);
    const PointLights expected = renderPoints(device, *reference, list);
    for (const std::uint32_t n : {2u, 4u, 8u}) {
        const auto technique = rsmOf(256, n).make(device);
        technique->update(room.frame);
        const PointLights got = renderPoints(device, *technique, list);
        // The same VPLs, added up in the order in which pixels share them out.
        for (std::size_t i = 0; i < list.count(); ++i) {
            CHECK(got.e(i) == Approx(expected.e(i)).epsilon(2e-5).margin(1e-7));
            CHECK(got.band(0, i) == Approx(expected.band(0, i)).epsilon(2e-5).margin(1e-7));
        }
    }
    const auto one = ssvpOf(LW_VISIBILITY_HARD, 2, 1, 1).make(device), four = ssvpOf(LW_VISIBILITY_HARD, 2, 1, 4).make(device);
    one->update(room.frame);
    four->update(room.frame);
    const PointLights a = renderPoints(device, *one, list), b = renderPoints(device, *four, list);
    CHECK(a.irradiance == b.irradiance);
    CHECK(a.harmonics == b.harmonics);
}

TEST_CASE("propagated light in two bands is what surfaces read", "[points]") {
    TestDevice device(GENERATE(1u, 16u));
    const Room room;
    const PointList list = PointList::ofScene(room.scene);
    const auto technique = lpvOf(LW_LPV_TRANSPORT_PROPAGATE).make(device);
    technique->update(room.frame);
    const PointLights points = renderPoints(device, *technique, list);
    double largest = 0.0;
    for (std::size_t i = 0; i < list.count(); ++i) largest = std::max(largest, points.e(i));
    for (std::size_t i = 0; i < list.count(); ++i) {
        const Vec n{list.normals[3 * i], list.normals[3 * i + 1], list.normals[3 * i + 2]};
        if (points.validity[i] == 0.0f) continue;
        CHECK(std::abs(points.fromBands(i, n) - points.e(i)) < 2e-6 * largest);
    }
}
