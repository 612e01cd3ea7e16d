// The catalogue: what moves in each sequence. Its scenes are in sequence_scenes.cpp, the way from one
// frame to the next in sequence_motion.cpp. Over 300 lines: a list of 19 short functions.
#include "sequence.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "scene_primitives.h"
#include "sequence_parts.h"

namespace studio {
namespace {

// Frame f of a scene at time f, the scene's keys being one per frame.
SequenceFrame& addFrame(FailureSequence& sequence, const SequenceSize& size,
                        std::shared_ptr<const Scene> scene, const Camera& camera) {
    SequenceFrame frame;
    frame.scene = std::move(scene);
    frame.time = float(sequence.frames.size());
    frame.camera = camera;
    frame.width = size.width;
    frame.height = size.height;
    frame.reset = frame.isCut = sequence.frames.empty();
    sequence.frames.push_back(std::move(frame));
    return sequence.frames.back();
}

template <class CameraOf>  // Camera(int frame)
FailureSequence makeFlight(const SequenceSize& size, const std::shared_ptr<Scene>& scene,
                           CameraOf cameraOf) {
    FailureSequence sequence;
    for (int f = 0; f < size.frames; ++f) addFrame(sequence, size, scene, cameraOf(f));
    return sequence;
}

FailureSequence withSamples(int samples, FailureSequence sequence) {
    sequence.truthSamples = samples;
    return sequence;
}

template <class LightOf>  // Light(int frame), the only light
void sweepLight(Scene& scene, const SequenceSize& size, LightOf lightOf) {
    setLight(scene, lightOf(0));
    Track<Light> track;
    for (int f = 0; f < size.frames; ++f) track.keys.emplace_back(float(f), lightOf(f));
    scene.lightTracks = {track};
}

Camera cameraOf(const Scene& scene, const char* name) {
    return scene.cameras[std::size_t(scene.findCamera(name))];
}

// 0 in the first frame, 1 in the last.
double shareOf(int frame, const SequenceSize& size) {
    return size.frames > 1 ? double(frame) / double(size.frames - 1) : 0.0;
}

FailureSequence makePan(const SequenceSize& size) {
    const auto scene = shippedScene("basic");
    const Camera start = yawed(cameraOf(*scene, "bleeding"), 12.0f);
    return makeFlight(size, scene, [&](int f) { return yawed(start, -0.75f * float(f)); });
}

FailureSequence makeDolly(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    const Camera start = cameraOf(*scene, "front");
    return makeFlight(size, scene, [&](int f) { return moved(start, {0.0f, 0.0f, 0.03f * float(f)}); });
}

FailureSequence makeCut(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    const Camera first = cameraOf(*scene, "inside");
    const Camera second = makeCamera({0.06f, 0.36f, 0.04f}, {0.5f, 0.12f, 0.36f}, 62.0f);
    FailureSequence sequence =
        makeFlight(size, scene, [&](int f) { return f < size.frames / 2 ? first : second; });
    sequence.truthSamples = 128;  // two different frames in all
    SequenceFrame& cut = sequence.frames[std::size_t(size.frames / 2)];
    cut.isCut = cut.reset = true;
    return sequence;
}

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
    return makeFlight(size, scene, [&](int) { return cameraOf(*scene, "lit_room"); });
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
    return makeFlight(size, scene, [&](int f) { return moved(start, step * float(f)); });
}

// A patch of 2 cm, as bright as the whole floor under the usual lamp, wanders over the floor and the
// block.
FailureSequence makeTinyEmitter(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    const glm::vec3 lamp = scene->lights[0].position;
    sweepLight(*scene, size, [&](int f) {
        return makeSpot(lamp, {0.47f - 0.008f * float(f), 0.0f, 0.14f}, 4000.0f, 1.5f);
    });
    return withSamples(8, makeFlight(size, scene, [&](int) { return cameraOf(*scene, "inside"); }));
}

FailureSequence makeOffScreen(const SequenceSize& size) {
    const auto scene = roomsWithDoorAt(4.0f);
    Camera start = cameraOf(*scene, "lit_room");
    start.verticalFov = 45.0f * kPi / 180.0f;
    return withSamples(16,
                       makeFlight(size, scene, [&](int f) { return yawed(start, 2.5f * float(f)); }));
}

FailureSequence makeScaled(const SequenceSize& size, float scale) {
    FailureSequence sequence = makeDolly(size);
    sequence.scale = scale;
    return sequence;
}

FailureSequence makeSmallScale(const SequenceSize& size) {
    return makeScaled(size, 1e-3f);
}

FailureSequence makeLargeScale(const SequenceSize& size) {
    return makeScaled(size, 1e3f);
}

FailureSequence makeResolutionChange(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    FailureSequence sequence = makeFlight(size, scene, [&](int) { return cameraOf(*scene, "inside"); });
    sequence.truthSamples = 128;  // three different frames in all
    constexpr double kFactors[] = {1.0, 0.8, 0.5, 0.8};
    sequence.sweeps = "picture width, pixels";
    for (int f = 0; f < size.frames; ++f) {
        SequenceFrame& frame = sequence.frames[std::size_t(f)];
        const double factor = kFactors[4 * f / size.frames];
        frame.width = std::max(1, int(std::lround(size.width * factor)));
        frame.height = std::max(1, int(std::lround(size.height * factor)));
        frame.value = frame.width;
    }
    return sequence;
}

FailureSequence makeGrazing(const SequenceSize& size) {
    const auto scene = roomsWithDoorAt(4.0f);
    const Camera start = makeCamera({-3.9f, 0.06f, 1.2f}, {0.0f, 0.03f, -0.4f}, 30.0f);
    return withSamples(16, makeFlight(size, scene, [&](int f) {
                           return moved(start, {0.02f * float(f), 0.0f, -0.008f * float(f)});
                       }));
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
    for (int f = 0; f < size.frames; ++f) {
        sequence.frames[std::size_t(f)].time = float(4.0 + 4.0 * shareOf(f, size));
        sequence.frames[std::size_t(f)].value = 100.0 * shareOf(f, size);
    }
    return sequence;
}

// A sun, a lamp, and nothing that either could shine on in view; a speck far behind the camera keeps it
// a scene.
FailureSequence makeEmpty(const SequenceSize& size) {
    const auto scene = std::make_shared<Scene>();
    scene->name = "empty";
    scene->materials.resize(1);
    scene->materials[0].name = "speck";
    Mesh speck = makeQuad({glm::vec3(-0.01f, 0.0f, 9.0f), glm::vec3(0.01f, 0.0f, 9.0f),
                           glm::vec3(0.01f, 0.02f, 9.0f), glm::vec3(-0.01f, 0.02f, 9.0f)});
    speck.name = "speck";
    scene->meshes = {speck};
    setLight(*scene, makeSpot({0.0f, 2.0f, 0.0f}, {0.0f, 0.0f, -2.0f}, 10.0f, 40.0f));
    const Camera start = makeCamera({0.0f, 1.0f, 3.0f}, {0.0f, 0.5f, 0.0f}, 50.0f);
    FailureSequence sequence = makeFlight(size, scene, [&](int f) {
        return moved(start, {0.05f * float(f), 0.0f, 0.0f});
    });
    sequence.truth = SequenceTruth::Dark;
    return sequence;
}

FailureSequence makeNoLight(const SequenceSize& size) {
    const auto scene = shippedScene("cornell");
    scene->lights.clear();
    scene->lightTracks.clear();
    FailureSequence sequence = makeFlight(size, scene, [&](int f) {
        return moved(cameraOf(*scene, "front"), {0.0f, 0.0f, 0.03f * float(f)});
    });
    sequence.truth = SequenceTruth::Dark;
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

}  // namespace

const std::vector<SequenceMaker>& sequenceMakers() {
    static const std::vector<SequenceMaker> kMakers = {
        {{"camera_pan", "a turning camera; a sun's shadow map that follows it", true}, makePan},
        {{"camera_dolly", "a camera that moves into the room", false}, makeDolly},
        {{"camera_cut", "history kept over a cut", true}, makeCut},
        {{"light_sweep_slow", "samples that jump while the light creeps", true}, makeSlowSweep},
        {{"light_sweep_quick", "lag behind a quick light, black stripes", false}, makeQuickSweep},
        {{"moving_object", "ghosts behind a moving box and its shadow", false}, makeMovingObject},
        {{"thin_walls", "light through walls of 30 cm to 1 mm", true}, makeThinWalls},
        {{"grid_crossing", "camera and lamp drift through the cells of a grid", false},
         makeGridCrossing},
        {{"tiny_emitter", "a tiny bright patch that few samples find", false}, makeTinyEmitter},
        {{"emitter_off_screen", "what is lit leaves the screen", false}, makeOffScreen},
        {{"scale_small", "lengths times 1/1000", false}, makeSmallScale},
        {{"scale_large", "lengths times 1000", false}, makeLargeScale},
        {{"resolution_change", "the picture's size changes from frame to frame", false},
         makeResolutionChange},
        {{"grazing_view", "a floor seen from 6 cm above", false}, makeGrazing},
        {{"spherical_room", "light from all sides, cluster means in mid-air", false}, makeSphericalRoom},
        {{"opening_door", "a dark room that gets light through a door", false}, makeOpeningDoor},
        {{"empty_scene", "nothing in view: light exactly 0", true}, makeEmpty},
        {{"no_light", "no lamp: light exactly 0", true}, makeNoLight},
        {{"light_blocked", "a lamp that stands in a shaft: dark around it", false}, makeBlockedLight},
    };
    return kMakers;
}

const std::vector<SequenceEntry>& sequenceCatalogue() {
    static const std::vector<SequenceEntry> kEntries = [] {
        std::vector<SequenceEntry> entries;
        for (const SequenceMaker& maker : sequenceMakers()) entries.push_back(maker.entry);
        return entries;
    }();
    return kEntries;
}

FailureSequence makeSequence(const std::string& name, const SequenceSize& size) {
    if (size.frames < 2 || size.width < 1 || size.height < 1)
        throw std::invalid_argument(fmt::format(
            "sequence size: expected 2 frames or more of 1x1 pixels or more, got {} of {}x{}",
            size.frames, size.width, size.height));
    std::vector<std::string> names;
    for (const SequenceMaker& maker : sequenceMakers()) {
        if (maker.entry.name == name) {
            FailureSequence sequence = maker.make(size);
            sequence.name = name;
            sequence.failure = maker.entry.failure;
            return sequence;
        }
        names.push_back(maker.entry.name);
    }
    throw std::invalid_argument(
        fmt::format("sequence \"{}\": expected one of: {}", name, fmt::join(names, ", ")));
}

}  // namespace studio
