// Sequences of the catalogue in which lamps, objects or walls move.
#include <cmath>

#include "scene_primitives.h"
#include "sequence_parts.h"

namespace studio {

FailureSequence makeSlowSweep(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    sweepLight(*scene, size, [lamp = scene->lights[0]](int f) {
        Light light = lamp;
        light.position.x += -0.03f + 0.002f * float(f);
        return light;
    });
    return makeFlight(size, scene, [&](int) { return cameraOf(*scene, "inside"); });
}

FailureSequence makeQuickSweep(const SequenceSize& size) {
    const auto scene = roomsWithDoorAt(4.0f);
    sweepLight(*scene, size, [lamp = scene->lights[0]](int f) {
        Light light = lamp;
        const float angle = (-60.0f + 5.0f * float(f)) * kPi / 180.0f;
        const float level = glm::length(glm::vec2(lamp.direction.x, lamp.direction.z));
        light.direction = glm::normalize(
            glm::vec3(level * std::cos(angle), lamp.direction.y, level * std::sin(angle)));
        return light;
    });
    FailureSequence sequence =
        withSamples(128, makeFlight(size, scene, [&](int) { return cameraOf(*scene, "lit_room"); }));
    sequence.truthSharesPoints = false;
    return sequence;
}

FailureSequence makeMovingObject(const SequenceSize& size) {
    const auto scene = roomsWithDoorAt(4.0f);
    Object box;
    box.name = "box";
    for (int f = 0; f < size.frames; ++f)
        box.keys.push_back({float(f), {0.0f, 0.0f, -1.7f + 0.08f * float(f)}, {1.0f, 0.0f, 0.0f, 0.0f}});
    scene->objects.push_back(box);
    Mesh mesh = makeBox({-1.5f, 0.002f, -0.3f}, {-0.9f, 0.9f, 0.3f});
    mesh.name = "box";
    mesh.object = int(scene->objects.size()) - 1;
    mesh.material = int(scene->materials.size());
    Material blue;
    blue.name = "blue";
    blue.albedo = {0.15f, 0.25f, 0.6f};
    scene->materials.push_back(blue);
    scene->meshes.push_back(std::move(mesh));
    return makeFlight(size, scene, [&](int) { return cameraOf(*scene, "lit_room"); });
}

// From 30 cm to 1 mm, in equal ratios.
FailureSequence makeThinWalls(const SequenceSize& size) {
    const Camera camera = makeCamera({0.3f, 4.2f, 3.0f}, {0.05f, 0.2f, -0.1f}, 42.0f);
    FailureSequence sequence;
    sequence.sweeps = "wall thickness, m";
    sequence.truthSamples = 16;  // most of the picture is known to be dark
    for (int f = 0; f < size.frames; ++f) {
        const double thickness = 0.3 * std::pow(0.001 / 0.3, shareOf(f, size));
        addFrame(sequence, size, Yards::make(float(thickness)), camera).value = thickness;
    }
    sequence.region = [](const SequenceFrame& frame, const glm::vec3& position) {
        return Yards::region(float(frame.value), position);
    };
    return sequence;
}

// Steps of no simple ratio to any cell, and askew to all axes.
FailureSequence makeGridCrossing(const SequenceSize& size) {
    const auto scene = makeCorridor();
    const glm::vec3 step(0.1372f, 0.0113f, 0.0231f);
    sweepLight(*scene, size, [&](int f) {
        const glm::vec3 at = glm::vec3(0.9f, 1.9f, -0.2f) + step * float(f);
        return makeSpot(at, at + glm::vec3(2.2f, -1.2f, 0.4f), 25.0f, 32.0f);
    });
    const Camera start = makeCamera({0.8f, 1.2f, -0.5f}, {3.8f, 0.9f, 0.1f}, 60.0f);
    return withSamples(128,
                       makeFlight(size, scene, [&](int f) { return moved(start, step * float(f)); }));
}

// A patch of 1.5 cm, as bright as the whole floor under the usual lamp, wanders over the floor and the
// block.
FailureSequence makeTinyEmitter(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    const glm::vec3 lamp = scene->lights[0].position;
    sweepLight(*scene, size, [&](int f) {
        return makeSpot(lamp, {0.47f - 0.008f * float(f), 0.0f, 0.14f}, 4000.0f, 1.5f);
    });
    return withSamples(8, makeFlight(size, scene, [&](int) { return cameraOf(*scene, "inside"); }));
}

// Irradiance at one bounce is the same everywhere, rho Phi / (4 pi R^2): from any place of a sphere
// every other one has the form factor of its share of the area.
FailureSequence makeSphericalRoom(const SequenceSize& size) {
    const auto scene = shippedScene("sphere_room");
    sweepLight(*scene, size, [](int f) {
        const float angle = (-50.0f + 3.0f * float(f)) * kPi / 180.0f;
        const glm::vec3 at(0.2f, 0.1f, 0.0f);
        return makeSpot(at, at + glm::vec3(std::sin(angle), -0.3f, -std::cos(angle)), 10.0f, 35.0f);
    });
    FailureSequence sequence = makeFlight(size, scene, [&](int) { return cameraOf(*scene, "inside"); });
    sequence.truthSamples = 8;
    return sequence;
}

// The scene's door: shut at 4 s, open at 8 s.
FailureSequence makeOpeningDoor(const SequenceSize& size) {
    const auto scene = shippedScene("rooms");
    FailureSequence sequence =
        makeFlight(size, scene, [&](int) { return cameraOf(*scene, "dark_room"); });
    sequence.sweeps = "door's opening, degrees";
    sequence.truthSamples = 128;  // all of its light comes through a gap
    sequence.truthSharesPoints = false;
    for (int f = 0; f < size.frames; ++f) {
        sequence.frames[std::size_t(f)].time = float(4.0 + 4.0 * shareOf(f, size));
        sequence.frames[std::size_t(f)].value = 100.0 * shareOf(f, size);
    }
    return sequence;
}

FailureSequence makeBlockedLight(const SequenceSize& size) {
    const auto scene = Shaft::make();
    sweepLight(*scene, size, [](int f) {
        const glm::vec3 at(-0.1f + 0.005f * float(f), 0.75f, 0.02f);
        return makeSpot(at, at + glm::vec3(0.1f, -1.0f, 0.05f), 6.0f, 50.0f);
    });
    const Camera camera = makeCamera({0.3f, 4.6f, 2.4f}, {0.0f, 0.2f, -0.05f}, 40.0f);
    FailureSequence sequence = makeFlight(size, scene, [&](int) { return camera; });
    sequence.truthSamples = 16;  // most of the picture is known to be dark
    sequence.region = [](const SequenceFrame&, const glm::vec3& position) {
        return Shaft::region(position);
    };
    return sequence;
}

}  // namespace studio
