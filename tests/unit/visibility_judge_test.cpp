// What the judge of visibility finds where it is known without it: an empty room, a wall between, and
// counts by hand.
#include <catch2/catch.hpp>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "visibility_judge.h"

using namespace studio;

namespace {

constexpr double kRounding = 1e-6;  // pictures are floats
constexpr int kSize = 8;

void addQuad(Mesh& mesh, glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    const auto first = unsigned(mesh.positions.size());
    for (const glm::vec3& p : {corner, corner + u, corner + u + v, corner + v}) {
        mesh.positions.push_back(p);
        mesh.normals.push_back(glm::normalize(glm::cross(u, v)));
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

// A floor from -1 to 1 at z = 0 under a camera; with a wall through x = 0, `height` high.
std::shared_ptr<Scene> floorWithWall(float height) {
    auto scene = std::make_shared<Scene>();
    scene->materials.emplace_back();
    Mesh mesh;
    addQuad(mesh, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    if (height > 0.0f) addQuad(mesh, {0, -1, 0}, {0, 2, 0}, {0, 0, height});
    scene->meshes.push_back(std::move(mesh));
    Camera camera;
    camera.position = {0, 0, 8};
    camera.target = {0, 0, 0};
    camera.up = {0, 1, 0};
    camera.verticalFov = 0.2f;
    scene->cameras.push_back(camera);
    return scene;
}

struct Rig {
    std::shared_ptr<Scene> scene;
    RayScene rays;
    GBuffer view;
    explicit Rig(float height)
        : scene(floorWithWall(height)),
          rays(scene, 0.0f),
          view(renderGBuffer(rays, scene->cameras[0], kSize, kSize, scene->cameras[0], 0.0f)) {}
    std::size_t pixels() const { return std::size_t(kSize) * kSize; }
};

// A lamp over the left half, and its twin over the right one, both looking down.
VplRecord lamp(float x) {
    return {{x, 0.0f, 0.5f}, {0, 0, -1}, {3, 2, 1}, 0.0f};
}
ClusterPlace placeOf(float x) {
    return {{x, 0.0f, 0.5f}, {0, 0, -1}, {x, 0.0f, 0.5f}, {0, 0, -1}};
}

}  // namespace

TEST_CASE("with nothing between every ray arrives, and a map that says so is right") {
    const Rig rig(0.0f);
    VisibilityJudge judge(rig.rays, rig.view);
    const auto verdict =
        judge.judge({{lamp(-0.4f), 0}, {lamp(0.4f), 1}}, {placeOf(-0.4f), placeOf(0.4f)},
                    std::vector<float>(2 * rig.pixels(), 1.0f));
    CHECK(verdict.pairs == 2 * rig.pixels());
    CHECK(verdict.lit == 1.0);
    CHECK(verdict.litWeight == 1.0);
    for (const Misjudged& wrong : verdict.against) {
        CHECK(wrong.falseLight + wrong.falseShadow == 0.0);
        CHECK(wrong.falseLightWeight + wrong.falseShadowWeight == 0.0);
    }
    const auto& exact = verdict.irradiance[int(Sight::exact)];
    CHECK(exact.plane("R") == verdict.irradiance[int(Sight::none)].plane("R"));
}

TEST_CASE("a wall between: each half sees its own lamp") {
    const Rig rig(0.5f);  // as high as the lamps: no ray passes over it
    VisibilityJudge judge(rig.rays, rig.view);
    const std::vector<ClusteredVpl> vpls{{lamp(-0.4f), 0}, {lamp(0.4f), 0}};
    // One cluster for both, whose medoid is the left lamp; a map that takes everything for lit on the
    // left, half on the right.
    std::vector<float> seen(rig.pixels());
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = i % kSize < kSize / 2 ? 1.0f : 0.5f;
    const auto verdict = judge.judge(vpls, {placeOf(-0.4f)}, seen);
    CHECK(verdict.pairs == 2 * rig.pixels());
    CHECK(verdict.lit == Approx(0.5).margin(kRounding));
    const auto& none = verdict.against[int(Sight::none)];
    CHECK(none.falseLight == Approx(0.5).margin(kRounding));
    CHECK(none.falseShadow == 0.0);
    // The medoid's ray: left pixels see both lamps, right ones none.
    const auto& medoid = verdict.against[int(Sight::medoid)];
    CHECK(medoid.falseLight == Approx(0.25).margin(kRounding));
    CHECK(medoid.falseShadow == Approx(0.25).margin(kRounding));
    // The map: a quarter of the pairs wholly lit in vain, half of a quarter lit, half of a quarter dark
    // on the right.
    const auto& map = verdict.against[int(Sight::map)];
    CHECK(map.falseLight == Approx(0.25 + 0.125).margin(kRounding));
    CHECK(map.falseShadow == Approx(0.125).margin(kRounding));
    CHECK(verdict.mapAgainstMedoid.falseLight == Approx(0.25).margin(kRounding));
    CHECK(verdict.mapAgainstMedoid.falseShadow == 0.0);
    // Lamps and halves are mirror images: so are the weights.
    CHECK(medoid.falseLightWeight == Approx(none.falseLightWeight / 2.0).epsilon(1e-4));
    CHECK(medoid.falseShadowWeight == Approx(verdict.litWeight / 2.0).epsilon(1e-4));
    // Per pixel: light of lamps that don't see it.
    double wrong = 0.0;
    for (const float value : verdict.pictures.plane("none.light")) wrong += double(value);
    CHECK(wrong > 0.0);
}

TEST_CASE("rays are traced anew when the VPLs change, and only answers change with the map") {
    const Rig rig(0.5f);
    VisibilityJudge judge(rig.rays, rig.view);
    const std::vector<float> all(rig.pixels(), 1.0f), nothing(rig.pixels(), 0.0f);
    const auto left = judge.judge({{lamp(-0.4f), 0}}, {placeOf(-0.4f)}, all);
    const auto dark = judge.judge({{lamp(-0.4f), 0}}, {placeOf(-0.4f)}, nothing);
    CHECK(left.lit == dark.lit);
    CHECK(dark.against[int(Sight::map)].falseShadow == dark.lit);
    CHECK(left.against[int(Sight::map)].falseLight == Approx(1.0 - left.lit));
    const auto right = judge.judge({{lamp(0.4f), 0}}, {placeOf(0.4f)}, all);
    for (int i = 0; i < kSize; ++i) {
        const auto exactOf = [&](const VisibilityVerdict& v) {
            return v.irradiance[int(Sight::exact)].plane("R")[std::size_t(i)];
        };
        CHECK((exactOf(left) == 0.0f) != (exactOf(right) == 0.0f));
    }
}

TEST_CASE("what does not fit is refused") {
    const Rig rig(0.0f);
    VisibilityJudge judge(rig.rays, rig.view);
    std::vector<float> seen(rig.pixels(), 1.0f);
    CHECK_THROWS_WITH(judge.judge({{lamp(0.0f), 1}}, {placeOf(0.0f)}, seen),
                      Catch::Matchers::Contains("expected 0 to 0, got 1"));
    CHECK_THROWS_WITH(judge.judge({{lamp(0.0f), 0}}, {placeOf(0.0f), placeOf(0.1f)}, seen),
                      Catch::Matchers::Contains("expected 128 values"));
    seen[3] = 1.5f;
    CHECK_THROWS_WITH(judge.judge({{lamp(0.0f), 0}}, {placeOf(0.0f)}, seen),
                      Catch::Matchers::Contains("[0,1], got 1.5"));
    seen[3] = 1.0f;
    CHECK(judge.judge({}, {placeOf(0.0f)}, seen).pairs == 0);
}
