// Technique lpv's geometry volume through the C API: a plate between a lit floor and what it lights, from each source.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/scoped_api.h"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 16, kPlate = 64;

double spotProfile(double x, double z) { return x * x + (z - 0.4) * (z - 0.4) < 0.05 ? 3.0 : 0.0; }

LWLpvDesc descOf(LWGeometryVolume volume) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.extent = 1.2f;
    desc.center[1] = desc.center[2] = 0.5f;
    desc.geometryVolume = volume;
    return desc;
}

// The plate y = 1/2 across the room and beyond, as two triangles, as surfels, and as what a view from above sees.
struct Plate {
    std::vector<float> vertices;
    PlanarPixels position, normal, area, seen, facing;
    LWGBuffer gbuffer{};
    explicit Plate(float height = 0.5f)
        : position(kPlate * kPlate, 1, 3), normal(kPlate * kPlate, 1, 3), area(kPlate * kPlate, 1, 1), seen(kPlate, kPlate, 3),
          facing(kPlate, kPlate, 3) {
        const float l = -0.6f, h = 0.6f, n = -0.1f, f = 1.1f;
        vertices = {l, height, n, h, height, n, h, height, f, l, height, n, h, height, f, l, height, f};
        for (std::uint32_t j = 0; j < kPlate; ++j)
            for (std::uint32_t i = 0; i < kPlate; ++i) {
                const double x = -0.6 + 1.2 * (i + 0.5) / kPlate, z = -0.1 + 1.2 * (j + 0.5) / kPlate;
                position.set(j * kPlate + i, 0, {x, double(height), z});
                normal.set(j * kPlate + i, 0, {0, 1, 0});
                area.at(j * kPlate + i, 0, 0) = float(1.2 * 1.2 / (kPlate * kPlate));
                seen.set(i, j, {x, double(height), z});
                facing.set(i, j, {0, 1, 0});
            }
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = seen.image();
        gbuffer.normal = facing.image();
    }
    LWSourceView seenBy(LWView view) const { return {view, &gbuffer}; }
    LWGeometry geometry(bool triangles, bool surfels) const {
        LWGeometry g{};
        g.structSize = sizeof g;
        if (triangles) {
            g.vertices = vertices.data();
            g.vertexCount = 6;
            g.triangleCount = 2;
        }
        if (surfels) {
            g.surfelCount = kPlate * kPlate;
            g.surfelPosition = position.image();
            g.surfelNormal = normal.image();
            g.surfelArea = area.image();
        }
        return g;
    }
};

struct Scene {
    LitFloor floor{64, spotProfile};
    WallAndCeiling walls{kWidth, kHeight};
    std::vector<LWLight> lights{floor.light};

    LWFrame frame(const LWGeometry* geometry = nullptr, const LWSourceView* source = nullptr) const {
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = 1;
        frame.geometry = geometry;
        frame.sourceViews = source;
        frame.sourceViewCount = source ? 1 : 0;
        return frame;
    }
    std::vector<float> render(LWDevice device, const LWLpvDesc& desc, const LWFrame& frame) const {
        TestTechnique technique(device, "lpv", &desc);
        TestView view(device, kWidth, kHeight);
        technique.update(frame);
        return technique.render(view, walls.gbuffer);
    }
    // The lower half of the view: everything there is above the plate.
    static double ceiling(const std::vector<float>& light) {
        double sum = 0.0;
        for (std::uint32_t y = kHeight / 2; y < kHeight; ++y)
            for (std::uint32_t x = 1; x < kWidth; ++x) sum += double(light[y * kWidth + x]);
        return sum;
    }
};

}  // namespace

TEST_CASE("a plate above the lit floor keeps its light from the ceiling, whatever says that it is there", "[lpv_geometry]") {
    TestDevice device(GENERATE(1u, 16u));
    const Scene scene;
    const Plate plate;
    const LWGeometry triangles = plate.geometry(true, false), surfels = plate.geometry(false, true);
    const auto open = scene.render(device, descOf(LW_GEOMETRY_VOLUME_OFF), scene.frame(&triangles));
    const auto drawn = scene.render(device, descOf(LW_GEOMETRY_VOLUME_TRIANGLES), scene.frame(&triangles));
    const auto discs = scene.render(device, descOf(LW_GEOMETRY_VOLUME_SURFELS), scene.frame(&surfels));
    const auto sampled = scene.render(device, descOf(LW_GEOMETRY_VOLUME_SURFELS), scene.frame(&triangles));
    CHECK(Scene::ceiling(open) > 0.0);
    CHECK(Scene::ceiling(drawn) < 0.1 * Scene::ceiling(open));
    CHECK(Scene::ceiling(discs) < 0.1 * Scene::ceiling(open));
    CHECK(sampled == drawn);
    CHECK(scene.render(device, descOf(LW_GEOMETRY_VOLUME_AUTO), scene.frame(&triangles)) == drawn);
    CHECK(scene.render(device, descOf(LW_GEOMETRY_VOLUME_AUTO), scene.frame(&surfels)) == discs);
    // What the screen shows has the floor beside the plate, which blocks as well.
    TestView above(device, kPlate, kPlate);
    const LWSourceView source = plate.seenBy(above);
    const auto screen = scene.render(device, descOf(LW_GEOMETRY_VOLUME_SCREEN), scene.frame(nullptr, &source));
    CHECK(Scene::ceiling(screen) < 0.1 * Scene::ceiling(open));
    CHECK(scene.render(device, descOf(LW_GEOMETRY_VOLUME_AUTO), scene.frame(nullptr, &source)) == screen);
}

TEST_CASE("what blocks nothing in the grid changes nothing but the scale, which is that of planes that block", "[lpv_geometry]") {
    TestDevice device(GENERATE(1u, 16u));
    const Scene scene;
    const Plate beyond(7.0f);
    const LWGeometry surfels = beyond.geometry(false, true);
    const auto open = scene.render(device, descOf(LW_GEOMETRY_VOLUME_OFF), scene.frame());
    const LWLpvDesc desc = descOf(LW_GEOMETRY_VOLUME_SURFELS);
    const auto unblocked = scene.render(device, desc, scene.frame(&surfels));
    // Calibrations of 16 cells and 32 steps, as lpv.md has them.
    const double scale = meanOf(unblocked) / meanOf(open);
    CHECK(scale == Approx(1.542 / 1.100).epsilon(1e-3));
    for (std::size_t i = 0; i < open.size(); ++i) CHECK(double(unblocked[i]) == Approx(scale * double(open[i])).epsilon(1e-6));
    TestTechnique technique(device, "lpv", &desc);
    technique.update(scene.frame(&surfels));
    CHECK(technique.count("surfels_outside") == kPlate * kPlate);
}

TEST_CASE("blocked light: same input, same bits, in any run, frame and width; a plate that leaves blocks no more",
          "[lpv_geometry]") {
    TestDevice wide(16), narrow(1);
    const Scene scene;
    const Plate plate, other(0.7f);
    TestView above(wide, kPlate, kPlate), aboveNarrow(narrow, kPlate, kPlate);
    const LWSourceView seen = plate.seenBy(above), seenNarrow = plate.seenBy(aboveNarrow), seenOther = other.seenBy(above);
    LWGeometry now = plate.geometry(true, true), moved = other.geometry(true, true), none = plate.geometry(false, true);
    moved.version = 1;
    for (const LWGeometryVolume volume : {LW_GEOMETRY_VOLUME_TRIANGLES, LW_GEOMETRY_VOLUME_SURFELS, LW_GEOMETRY_VOLUME_SCREEN}) {
        CAPTURE(volume);
        const LWLpvDesc desc = descOf(volume);
        const bool isScreen = volume == LW_GEOMETRY_VOLUME_SCREEN;
        const LWSourceView *source = isScreen ? &seen : nullptr, *otherSource = isScreen ? &seenOther : nullptr;
        const auto first = scene.render(wide, desc, scene.frame(&now, source));
        for (int run = 0; run < 3; ++run) CHECK(scene.render(wide, desc, scene.frame(&now, source)) == first);
        CHECK(scene.render(narrow, desc, scene.frame(&now, isScreen ? &seenNarrow : nullptr)) == first);
        TestTechnique technique(wide, "lpv", &desc);
        TestView view(wide, kWidth, kHeight);
        for (int frame = 0; frame < 2; ++frame) {
            technique.update(scene.frame(&now, source));
            CHECK(technique.render(view, scene.walls.gbuffer) == first);
        }
        technique.update(scene.frame(&moved, otherSource));
        const auto second = technique.render(view, scene.walls.gbuffer);
        CHECK(second != first);
        CHECK(second == scene.render(wide, desc, scene.frame(&moved, otherSource)));
    }
    // From triangles to surfels and back, whose revisions may be alike.
    const LWLpvDesc desc = descOf(LW_GEOMETRY_VOLUME_AUTO);
    TestTechnique technique(wide, "lpv", &desc);
    TestView view(wide, kWidth, kHeight);
    for (const LWGeometry* geometry : {&now, &none, &now}) {
        technique.update(scene.frame(geometry));
        CHECK(technique.render(view, scene.walls.gbuffer) == scene.render(wide, desc, scene.frame(geometry)));
    }
}

TEST_CASE("nothing of the geometry volume is compiled after lwPrewarm, memory is as estimated", "[lpv_geometry]") {
    TestDevice device(16);
    const Scene scene;
    const Plate plate;
    const LWLpvDesc desc = descOf(GENERATE(LW_GEOMETRY_VOLUME_AUTO, LW_GEOMETRY_VOLUME_TRIANGLES, LW_GEOMETRY_VOLUME_SURFELS,
                                           LW_GEOMETRY_VOLUME_SCREEN));
    CAPTURE(desc.geometryVolume);
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, kWidth, kHeight);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    const LWGeometry geometry = plate.geometry(true, true);
    TestView above(device, kPlate, kPlate);
    const LWSourceView source = plate.seenBy(above);
    const LWFrame frame = scene.frame(&geometry, &source);
    technique.update(frame);
    technique.render(view, scene.walls.gbuffer);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc size{};
    size.structSize = sizeof size;
    size.maxWidth = kWidth;
    size.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "lpv", &desc, &size, &frame, &estimate) == LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    CHECK(technique.stats().deviceBytes > estimate / 2);
}

TEST_CASE("damping takes no more than what a surface reads of its own light, and changes nothing else's sign", "[lpv_geometry]") {
    TestDevice device(GENERATE(1u, 16u));
    const Scene scene;
    LWLpvDesc desc = descOf(LW_GEOMETRY_VOLUME_OFF);
    const auto plain = scene.render(device, desc, scene.frame());
    desc.damping = 1;
    const auto damped = scene.render(device, desc, scene.frame());
    for (std::size_t i = 0; i < plain.size(); ++i) CHECK(damped[i] <= plain[i]);
    CHECK(meanOf(damped) > 0.3 * meanOf(plain));
}

TEST_CASE("a geometry volume asks for what it needs", "[lpv_geometry]") {
    TestDevice device(16);
    const Scene scene;
    const Plate plate;
    const LWGeometry surfels = plate.geometry(false, true);
    for (const bool isSurfels : {false, true}) {
        const LWLpvDesc desc = descOf(isSurfels ? LW_GEOMETRY_VOLUME_SURFELS : LW_GEOMETRY_VOLUME_TRIANGLES);
        TestTechnique technique(device, "lpv", &desc);
        const LWFrame bare = scene.frame();
        CHECK(lwUpdate(technique, &bare) == LW_ERROR_INVALID_ARGUMENT);
        CHECK_THAT(lastError(device), Contains("frame.geometry") && Contains(isSurfels ? "surfels" : "geometry_volume=triangles"));
        const LWFrame discs = scene.frame(&surfels);
        CHECK(lwUpdate(technique, &discs) == (isSurfels ? LW_SUCCESS : LW_ERROR_INVALID_ARGUMENT));
    }
    LWLpvDesc desc = descOf(LW_GEOMETRY_VOLUME_OFF);
    const std::int32_t nine = 9;
    std::memcpy(&desc.geometryVolume, &nine, sizeof nine);
    LWTechnique none = nullptr;
    CHECK(lwCreateLpv(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(device), Contains("geometry_volume") || Contains("geometryVolume"));
}
