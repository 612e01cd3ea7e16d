// Frames to probe, drawn from quads in double precision, and the pass frame_probes on them.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <vector>

#include "inputs/camera.h"
#include "passes/frame_probes.h"
#include "reference/frame_probes_twin.h"
#include "support/kernel_rig.h"
#include "support/view_scene.h"

namespace lightwell::test {

// A room whose floor a lamp lights, with a panel that stands in it.
inline ViewScene probedRoom() {
    ViewScene scene;
    scene.quad({-2, 0, -2}, {4, 0, 0}, {0, 0, 4}, 0.5);
    scene.quad({-2, 0, -2}, {0, 3, 0}, {4, 0, 0}, 0.1);
    scene.quad({-2, 0, -2}, {0, 0, 4}, {0, 3, 0}, 0.05);
    scene.quad({2, 0, -2}, {0, 3, 0}, {0, 0, 4}, 0.02);
    scene.quad({0.3, 0, -0.6}, {0.2, 0, 1}, {0, 1.2, 0}, 0.2);
    return scene;
}

struct ProbedSetup {
    ViewScene scene = probedRoom();
    TestCamera camera = lookAt({0.2, 1.5, 2.5}, {0, 0.6, 0}, 0.6, 16.0 / 9.0);
    TestCamera lamp = lookAt({-0.5, 2.8, 0.3}, {-0.4, 0, 0.1}, 0.7, 1.0);
    std::uint32_t width = 320, height = 180, texels = 128;
    double length = 1.0, light = 1.0;  // the unit of length, the lamp's strength
    bool hasAlbedo = true, hasRadiance = true;
};

inline glm::dvec3 albedoOf(const ViewScene::Hit& hit) { return glm::dvec3(0.7, 0.5, 0.3) * (0.6 + 0.4 * std::sin(3.0 * hit.position.x)); }

inline TestCamera scaled(TestCamera camera, double by) {
    camera.eye *= by;
    camera.near *= by;
    camera.far *= by;
    if (camera.orthographic) camera.left *= by, camera.rightEdge *= by, camera.bottom *= by, camera.top *= by;
    return camera;
}

inline ViewScene::Hit castPixel(const ViewScene& scene, const TestCamera& camera, std::uint32_t x, std::uint32_t y, std::uint32_t w, std::uint32_t h) {
    const double u = (x + 0.5) / w, v = (y + 0.5) / h;
    const glm::dvec3 from = camera.orthographic ? camera.point(u, v, 0.0) : camera.eye;
    return scene.cast(from, glm::normalize(camera.point(u, v, 1.0) - from));
}

// As float holds it: what the device gets.
inline glm::dvec3 rounded(const glm::dvec3& v) { return {double(float(v.x)), double(float(v.y)), double(float(v.z))}; }

inline ProbedPicture drawPicture(const ProbedSetup& s) {
    ProbedPicture picture;
    picture.width = s.width;
    picture.height = s.height;
    for (std::uint32_t y = 0; y < s.height; ++y)
        for (std::uint32_t x = 0; x < s.width; ++x) {
            const ViewScene::Hit hit = castPixel(s.scene, s.camera, x, y, s.width, s.height);
            ProbeSurface surface;
            surface.isSurface = bool(hit);
            if (hit) surface.position = rounded(hit.position * s.length), surface.normal = rounded(hit.normal);
            picture.pixels.push_back(surface);
            if (s.hasAlbedo) picture.albedo.push_back(hit ? rounded(albedoOf(hit)) : glm::dvec3(0.0));
            if (s.hasRadiance) picture.radiance.push_back(rounded(glm::dvec3(hit.radiance * s.light)));
        }
    const TestCamera camera = scaled(s.camera, s.length);
    picture.eye = camera.eye;
    picture.right = camera.right;
    picture.up = camera.up;
    picture.forward = camera.forward;
    picture.left = camera.left;
    picture.rightEdge = camera.rightEdge;
    picture.bottom = camera.bottom;
    picture.top = camera.top;
    picture.orthographic = camera.orthographic;
    return picture;
}

// Flux of a lamp that shines evenly into its map, areas as lightwell.h defines them.
inline ProbedMap drawMap(const ProbedSetup& s) {
    ProbedMap map;
    map.width = map.height = s.texels;
    const double window = (s.lamp.rightEdge - s.lamp.left) * (s.lamp.top - s.lamp.bottom) / (double(s.texels) * s.texels);
    for (std::uint32_t y = 0; y < s.texels; ++y)
        for (std::uint32_t x = 0; x < s.texels; ++x) {
            const ViewScene::Hit hit = castPixel(s.scene, s.lamp, x, y, s.texels, s.texels);
            ProbedTexel t;
            if (hit) {
                const glm::dvec3 d = hit.position - s.lamp.eye;
                const double axial = glm::dot(glm::normalize(d), s.lamp.forward), solid = window * axial * axial * axial;
                const double cosine = std::max(0.05, std::abs(glm::dot(glm::normalize(d), hit.normal)));
                t.isSurface = true;
                t.position = rounded(hit.position * s.length);
                t.normal = rounded(hit.normal);
                t.flux = rounded(albedoOf(hit) * (30.0 * s.light * solid * s.length * s.length));
                t.area = double(float(solid * glm::dot(d, d) / cosine * s.length * s.length));
            }
            map.texels.push_back(t);
        }
    return map;
}

// The pass on these, as RsmInput and GBufferInput would lay them out.
class Probing {
public:
    explicit Probing(std::uint32_t width) : rig(width), pass(rig.device()) {}

    FrameFigures run(const ProbedPicture& picture, const std::vector<ProbedMap>& maps, const LWCamera* camera,
                     const std::vector<LWVpl>& vpls = {}) {
        std::vector<float> position, normal, albedo, radiance;
        const auto planes = [&](auto value) {
            std::vector<float> packed;
            for (int c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < picture.pixels.size(); ++i) packed.push_back(float(value(i)[c]));
            held.push_back(std::make_unique<Guarded>(rig.uploadPlanes(packed, picture.width, picture.height, 3, std::nanf(""))));
            return rig.planes(*held.back(), picture.width, picture.height, 3);
        };
        ProbedView view;
        view.position = planes([&](std::size_t i) { return picture.pixels[i].position; });
        view.normal = planes([&](std::size_t i) { return picture.pixels[i].normal; });
        if (!picture.albedo.empty()) view.albedo = planes([&](std::size_t i) { return picture.albedo[i]; });
        if (!picture.radiance.empty()) view.directRadiance = planes([&](std::size_t i) { return picture.radiance[i]; });
        view.width = picture.width;
        view.height = picture.height;
        view.hasCamera = camera != nullptr;
        if (camera) view.camera = Camera(*camera, picture.width, picture.height, "camera").texelsOf(1);
        RsmInput input;
        upload(maps, input);
        pass.record(rig.executor(), view, input, vpls.data(), std::uint32_t(vpls.size()));
        pass.readLate(rig.executor());
        rig.device().finish();
        const FrameFigures* probes = pass.take();
        REQUIRE(probes != nullptr);
        CHECK(pass.take() == nullptr);
        pass.sums().download(0, sizeof sums, &sums);
        return *probes;
    }

    KernelRig rig;
    FrameProbes pass;
    LwFrameProbes sums{};

private:
    void upload(const std::vector<ProbedMap>& maps, RsmInput& input) {
        std::uint32_t total = 0;
        for (const ProbedMap& map : maps) {
            input.spans.push_back({0, total, 0, map.width, map.height});
            total += paddedWidth(map.width) * map.height;
        }
        if (total == 0) return;
        std::vector<float> planes(std::size_t(total) * RsmInput::kPlaneCount, 0.0f);
        for (std::size_t m = 0; m < maps.size(); ++m)
            for (std::uint32_t y = 0; y < maps[m].height; ++y)
                for (std::uint32_t x = 0; x < maps[m].width; ++x) {
                    const ProbedTexel& t = maps[m].texels[std::size_t(y) * maps[m].width + x];
                    const std::size_t at = input.spans[m].firstTexel + std::size_t(y) * paddedWidth(maps[m].width) + x;
                    for (int c = 0; c < 3; ++c) {
                        planes[std::size_t(RsmInput::kPositionX + c) * total + at] = float(t.position[c]);
                        planes[std::size_t(RsmInput::kNormalX + c) * total + at] = float(t.normal[c]);
                        planes[std::size_t(RsmInput::kFluxR + c) * total + at] = float(t.flux[c]);
                    }
                    planes[std::size_t(RsmInput::kArea) * total + at] = float(t.area);
                }
        held.push_back(std::make_unique<Guarded>(rig.upload(planes)));
        input.texels.memory = held.back()->get();
        input.texels.rowStride = input.texels.planeStride = total;
        input.texels.width = total;
        input.texels.height = 1;
        input.texels.count = RsmInput::kPlaneCount;
    }
    std::vector<std::unique_ptr<Guarded>> held;
};

inline FrameFigures probe(Probing& probing, const ProbedSetup& setup) {
    const LWCamera camera = scaled(setup.camera, setup.length).matrices();
    return probing.run(drawPicture(setup), {drawMap(setup)}, &camera);
}

inline void checkNear(const FrameFigures& got, const FrameFigures& expected, double relative, double absolute) {
    const auto near = [&](float a, float b, const char* name) {
        INFO(name << ": " << a << ", expected " << b);
        CHECK(std::isnan(a) == std::isnan(b));
        CHECK_FALSE(std::abs(double(a) - double(b)) > relative * std::abs(double(b)) + absolute);
    };
    near(got.indirectShare, expected.indirectShare, "indirectShare");
    near(got.fluxOnScreen, expected.fluxOnScreen, "fluxOnScreen");
    near(got.fluxConcentration, expected.fluxConcentration, "fluxConcentration");
    near(got.depthComplexity, expected.depthComplexity, "depthComplexity");
    near(got.extent, expected.extent, "extent");
    near(got.albedo, expected.albedo, "albedo");
    near(got.facing, expected.facing, "facing");
    near(got.hidden, expected.hidden, "hidden");
    near(got.coverage, expected.coverage, "coverage");
}

}  // namespace lightwell::test
