// Movements of any scene: the same every time, steps that follow from the scene, no way through a wall.
#include <catch2/catch.hpp>
#include <cmath>

#include "film.h"
#include "scene_primitives.h"
#include "sequence.h"

using namespace studio;

namespace {

constexpr SequenceSize kSmall{4, 32, 18};
constexpr float kDegree = kPi / 180.0f;
const char* const kMovements[] = {"camera_pan", "camera_dolly", "light_sweep_slow"};

std::uint64_t hashFrame(const SequenceFrame& frame) {
    const RayScene scene(frame.scene, frame.time);
    const GBuffer view =
        renderGBuffer(scene, frame.camera, frame.width, frame.height, frame.camera, frame.time);
    const std::uint64_t parts[] = {hashScene(scene), hashView(view)};
    return hashBytes(parts, sizeof parts, 1);
}

// A wall of 8 m a side, 10 m down -z from the camera, and a lamp that lights it from `lampDistance`.
Scene wallScene(float lampDistance, LightKind kind = LightKind::Spot) {
    Scene scene;
    scene.name = "wall";
    scene.materials.resize(1);
    scene.meshes = {makeQuad({glm::vec3(-4.0f, -4.0f, -10.0f), glm::vec3(4.0f, -4.0f, -10.0f),
                              glm::vec3(4.0f, 4.0f, -10.0f), glm::vec3(-4.0f, 4.0f, -10.0f)})};
    Camera camera;
    camera.name = "eye";
    camera.target = {0.0f, 0.0f, -1.0f};
    camera.verticalFov = 36.0f * kDegree;
    scene.cameras = {camera};
    Light lamp;
    lamp.name = "lamp";
    lamp.kind = kind;
    lamp.position = {0.0f, 1.0f, -10.0f + lampDistance};
    lamp.direction = {0.0f, 0.0f, -1.0f};
    lamp.emitted = glm::vec3(50.0f);
    lamp.outerCone = 0.5f;
    scene.lights = {lamp};
    return scene;
}

void addBlock(Scene& scene, const glm::vec3& lower, const glm::vec3& upper) {
    scene.meshes.push_back(makeBox(lower, upper));
}

float yawOf(const Camera& camera) {
    const glm::vec3 ahead = camera.target - camera.position;
    return std::atan2(ahead.x, -ahead.z);
}

Light lampOf(const SequenceFrame& frame, int light = 0) {
    return frame.scene->lightAt(light, frame.time);
}

float stepOfDolly(const Scene& scene) {
    const FailureSequence dolly = makeMovement(scene, "camera_dolly", kSmall);
    return glm::length(dolly.frames[1].camera.position - dolly.frames[0].camera.position);
}

}  // namespace

TEST_CASE("a scene's movements are the same every time and begin the same, however long they are") {
    const Scene scene = loadScene("cornell");
    REQUIRE(sceneMovements().size() == 3);
    for (const char* name : kMovements) {
        INFO(name);
        const FailureSequence a = makeMovement(scene, name, kSmall);
        const FailureSequence b = makeMovement(scene, name, {7, kSmall.width, kSmall.height});
        CHECK(a.name == std::string("cornell.") + name);
        REQUIRE(a.frames.size() == 4);
        CHECK(a.frames[0].isCut);
        CHECK(a.frames[0].reset);
        CHECK(a.truthSamples == makeMovement(scene, name, kSmall).truthSamples);
        CHECK(a.truthSamples >= 16);
        CHECK(a.truthSharesPoints == (std::string(name) != "light_sweep_slow"));
        for (std::size_t f = 0; f < a.frames.size(); ++f)
            CHECK(hashFrame(a.frames[f]) == hashFrame(b.frames[f]));
        CHECK(hashFrame(a.frames[0]) != hashFrame(a.frames[1]));
    }
}

TEST_CASE("the camera turns by a 72nd of its angle of view and goes ahead by a 200th of the depth") {
    const Scene scene = wallScene(5.0f);
    const FailureSequence pan = makeMovement(scene, "camera_pan", kSmall);
    for (std::size_t f = 1; f < 4; ++f)  // 36 degrees / 72
        CHECK(yawOf(pan.frames[f].camera) - yawOf(pan.frames[f - 1].camera) ==
              Approx(0.5f * kDegree).epsilon(1e-3));

    const FailureSequence dolly = makeMovement(scene, "camera_dolly", kSmall);
    for (std::size_t f = 1; f < 4; ++f) {
        const glm::vec3 step = dolly.frames[f].camera.position - dolly.frames[f - 1].camera.position;
        CHECK(step.z == Approx(-0.05f).epsilon(0.02));  // the median ray is a little longer than 10 m
        CHECK(glm::length(glm::vec2(step)) < 1e-6f);
        CHECK(dolly.frames[f].value == Approx(-dolly.frames[f].camera.position.z));
    }
}

TEST_CASE("the camera turns about what is vertical to it") {
    Scene scene = wallScene(5.0f);
    for (const float y : {-9.0f, 8.0f}) addBlock(scene, {-9.0f, y, -9.0f}, {9.0f, y + 1.0f, 9.0f});
    const auto targetsOf = [&](const glm::vec3& ahead, const glm::vec3& up) {
        scene.cameras[0].target = ahead;
        scene.cameras[0].up = up;
        std::vector<glm::vec3> targets;
        for (const SequenceFrame& frame : makeMovement(scene, "camera_pan", kSmall).frames)
            targets.push_back(frame.camera.target);
        return targets;
    };
    // A plan seen from above, and a scene whose z is up.
    const glm::vec3 views[][2] = {{{0.0f, -1.0f, 0.0f}, {0.0f, 0.0f, -2.0f}},
                                  {{0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}}};
    for (const auto& [ahead, up] : views) {
        const std::vector<glm::vec3> targets = targetsOf(ahead, up);
        for (std::size_t f = 1; f < 4; ++f) {
            CHECK(std::atan2(glm::dot(targets[f], glm::cross(ahead, glm::normalize(up))),
                             glm::dot(targets[f], ahead)) ==
                  Approx(0.5f * kDegree * float(f)).epsilon(1e-3));
            CHECK(targets[f].z == Approx(0.0f).margin(1e-6));
        }
    }
    // Its own up tilted, as of glTF's cameras: the horizon stays.
    const std::vector<glm::vec3> tilted = targetsOf({0.0f, -0.6f, -0.8f}, {0.0f, 0.8f, -0.6f});
    CHECK(tilted[3].y == -0.6f);
    CHECK(tilted[3].x > 0.0f);
}

TEST_CASE("a camera with something before it uses half of its way in 32 frames") {
    // Beside the axis, where the middle ray passes; its front is 1 m away.
    Scene scene = wallScene(5.0f);
    addBlock(scene, {0.02f, -0.2f, -1.4f}, {0.1f, 0.2f, -1.0f});
    CHECK(stepOfDolly(scene) == Approx(0.5f / 32.0f).epsilon(1e-3));

    addBlock(scene, {-1.0f, -1.0f, -0.0005f}, {1.0f, 1.0f, -0.0004f});
    CHECK_THROWS_WITH(makeMovement(scene, "camera_dolly", kSmall),
                      Catch::Contains("\"eye\"") && Catch::Contains("room to move"));
}

TEST_CASE("a lamp moves by 0.2 degrees seen from what it lights, or turns by as much") {
    const FailureSequence spot = makeMovement(wallScene(5.0f), "light_sweep_slow", kSmall);
    const float step = glm::length(lampOf(spot.frames[2]).position - lampOf(spot.frames[1]).position);
    CHECK(step == Approx(5.0f * std::tan(0.2f * kDegree)).epsilon(1e-3));
    CHECK(lampOf(spot.frames[2]).direction == lampOf(spot.frames[0]).direction);

    const auto turnOf = [](const FailureSequence& sequence) {
        const glm::vec3 a = lampOf(sequence.frames[1]).direction;
        const glm::vec3 b = lampOf(sequence.frames[2]).direction;
        return std::asin(glm::length(glm::cross(a, b)));
    };
    const FailureSequence sun =
        makeMovement(wallScene(5.0f, LightKind::Sun), "light_sweep_slow", kSmall);
    CHECK(turnOf(sun) == Approx(0.2f * kDegree).epsilon(1e-3));

    // Between two plates 10 cm off there is no room for half a metre and more.
    Scene tight = wallScene(5.0f);
    for (const float x : {-0.11f, 0.1f}) addBlock(tight, {x, 0.5f, -6.0f}, {x + 0.01f, 1.5f, -4.0f});
    const FailureSequence turned = makeMovement(tight, "light_sweep_slow", kSmall);
    CHECK(turnOf(turned) == Approx(0.2f * kDegree).epsilon(1e-3));
    CHECK(lampOf(turned.frames[3]).position == lampOf(turned.frames[0]).position);

    // All lights of a scene move.
    Scene two = wallScene(5.0f);
    two.lights.push_back(wallScene(2.0f, LightKind::Point).lights[0]);
    const FailureSequence both = makeMovement(two, "light_sweep_slow", kSmall);
    for (int light = 0; light < 2; ++light)
        CHECK(lampOf(both.frames[1], light).position != lampOf(both.frames[0], light).position);
}

TEST_CASE("however long a sequence is, cameras and lamps stay on their side of every wall") {
    for (const char* name : {"cornell", "basic", "rooms", "sphere_room"}) {
        INFO(name);
        const Scene scene = loadScene(name);
        const SequenceSize longSize{150, 16, 9};
        const FailureSequence dolly = makeMovement(scene, "camera_dolly", longSize);
        const FailureSequence sweep = makeMovement(scene, "light_sweep_slow", longSize);
        const RayScene rays(dolly.frames[0].scene, 0.0f);
        const auto isOpen = [&](const glm::vec3& from, const glm::vec3& to) {
            const float way = glm::length(to - from);
            return way == 0.0f || !rays.occluded(from, (to - from) / way, 0.0f, way);
        };
        float farthest = 0.0f;
        for (std::size_t f = 0; f < dolly.frames.size(); ++f) {
            const glm::vec3 start = dolly.frames[0].camera.position;
            CHECK(isOpen(start, dolly.frames[f].camera.position));
            farthest = std::max(farthest, glm::length(dolly.frames[f].camera.position - start));
            CHECK(isOpen(lampOf(sweep.frames[0]).position, lampOf(sweep.frames[f]).position));
        }
        const glm::vec3 start = dolly.frames[0].camera.position;
        const glm::vec3 ahead = glm::normalize(dolly.frames[0].camera.target - start);
        CHECK(isOpen(start, start + ahead * (1.9f * farthest)));
        CHECK(farthest > 0.0f);
        CHECK(dolly.frames[64].camera.position == start);  // there and back
    }
}

TEST_CASE("a scene's own movements are stopped") {
    const Scene rooms = loadScene("rooms");  // its door shuts within 4 s
    const FailureSequence sweep = makeMovement(rooms, "light_sweep_slow", {6, 32, 18});
    CHECK(sweep.frames[0].camera.name == rooms.cameras[0].name);
    const SequenceFrame& last = sweep.frames[5];
    const SeenFrame open = seeFrame(RayScene(last.scene, 0.0f), last);
    const SeenFrame later = seeFrame(RayScene(last.scene, last.time), last);
    CHECK(open.position == later.position);
}

TEST_CASE("lights count as they stand at 0 s") {
    Scene later = wallScene(5.0f), early = later;
    Light dark = later.lights[0], bright = dark;
    dark.emitted = glm::vec3(0.0f);
    later.lightTracks = {{0, {{0.0f, dark}, {2.0f, bright}}}};
    CHECK_THROWS_WITH(makeMovement(later, "light_sweep_slow", kSmall), Catch::Contains("shines at 0 s"));
    early.lights[0] = dark;
    early.lightTracks = {{0, {{0.0f, bright}, {2.0f, dark}}}};
    const FailureSequence sweep = makeMovement(early, "light_sweep_slow", kSmall);
    CHECK(lampOf(sweep.frames[3]).emitted == bright.emitted);
}

TEST_CASE("light that can't move is not called creeping light") {
    Scene tight = wallScene(5.0f, LightKind::Point);
    for (const float x : {-0.0002f, 0.0001f})
        addBlock(tight, {x, 0.5f, -6.0f}, {x + 0.0001f, 1.5f, -4.0f});
    CHECK_THROWS_WITH(makeMovement(tight, "light_sweep_slow", kSmall),
                      Catch::Contains("\"wall\"") && Catch::Contains("room to move"));
    CHECK_NOTHROW(makeMovement(tight, "camera_pan", kSmall));
    tight.lights.push_back(wallScene(5.0f, LightKind::Sun).lights[0]);
    CHECK_NOTHROW(makeMovement(tight, "light_sweep_slow", kSmall));
}

TEST_CASE("what a scene lacks is named") {
    CHECK_THROWS_WITH(makeMovement(loadScene("furnace"), "camera_pan", kSmall),
                      Catch::Contains("furnace") && Catch::Contains("spot or point light"));
    Scene away = wallScene(5.0f);
    away.cameras[0].target = {0.0f, 0.0f, 1.0f};
    CHECK_THROWS_WITH(makeMovement(away, "camera_pan", kSmall),
                      Catch::Contains("\"eye\"") && Catch::Contains("surfaces in view"));
    CHECK_THROWS_WITH(makeMovement(away, "pan", kSmall), Catch::Contains("camera_dolly"));
    CHECK_THROWS_WITH(makeMovement(away, "camera_pan", {1, 32, 18}), Catch::Contains("2 frames"));
}
