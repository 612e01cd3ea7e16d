// The catalogue. What moves in each sequence is in sequence_views.cpp and sequence_lights.cpp, the
// scenes that no shipped one gives in sequence_scenes.cpp, the movements of any other scene in
// sequence_movements.cpp, the way from one frame to the next in
// sequence_motion.cpp.
#include "sequence.h"

#include <stdexcept>

#include <fmt/format.h>

#include "sequence_parts.h"

namespace studio {

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

void requireSequenceSize(const SequenceSize& size) {
    if (size.frames < 2 || size.width < 1 || size.height < 1)
        throw std::invalid_argument(fmt::format(
            "sequence size: expected 2 frames or more of 1x1 pixels or more, got {} of {}x{}",
            size.frames, size.width, size.height));
}

FailureSequence makeSequence(const std::string& name, const SequenceSize& size) {
    requireSequenceSize(size);
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
