// Sequences of the catalogue in which the view moves or changes, and those that have no light to show.
#include <algorithm>
#include <cmath>

#include "scene_primitives.h"
#include "sequence_parts.h"

namespace studio {

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

FailureSequence makeOffScreen(const SequenceSize& size) {
    const auto scene = roomsWithDoorAt(4.0f);
    Camera start = cameraOf(*scene, "lit_room");
    start.verticalFov = 45.0f * kPi / 180.0f;
    return withSamples(16,
                       makeFlight(size, scene, [&](int f) { return yawed(start, 2.5f * float(f)); }));
}

namespace {

FailureSequence makeScaled(const SequenceSize& size, float scale) {
    FailureSequence sequence = makeDolly(size);
    sequence.scale = scale;
    return sequence;
}

}  // namespace

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

}  // namespace studio
