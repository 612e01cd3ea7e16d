// Faults of known kinds, planted over real techniques in sequences of the catalogue: each is caught by
// its index, and the others stay quiet.
#include <catch2/catch.hpp>

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "parameters.h"
#include "support/planted_faults.h"
#include "support/sequence_rig.h"

using namespace stability_test;
using studio::StabilityIndices;

namespace {

// What the techniques stay under at this size without a fault and each fault exceeds, at about half of
// what it reads; a truth's noise has to stay under a quarter of it.
struct Bounds {
    double flicker = 0.1, ghost = 0.5, leak = 0.005, drift = 0.1, spike = 0.25;
};
constexpr double kFloorShare = 0.25;

constexpr int kFrames = 32;
constexpr int kSamples = 64;  // per pixel, of each truth

// The still pictures are smaller, which is quicker; a moving one has to have pixels enough for its noise to
// average away.
const SequenceRig& rigOf(const std::string& name) {
    static std::map<std::string, std::unique_ptr<SequenceRig>> rigs;
    std::unique_ptr<SequenceRig>& rig = rigs[name];
    const studio::SequenceSize size =
        name == "camera_pan" ? studio::SequenceSize{kFrames, 96, 54} : studio::SequenceSize{kFrames, 64, 36};
    if (rig == nullptr) rig = std::make_unique<SequenceRig>(name, size, kSamples);
    return *rig;
}

std::unique_ptr<cli::IndirectRenderer> sound(const SequenceRig& rig, const std::string& technique) {
    cli::Parameters parameters(technique);
    if (technique == "rival") parameters.set("spp=16");
    return cli::makeRenderer(parameters, rig.firstInputs(), cli::DeviceOptions());
}

template <class Fault, class... Sizes>
StabilityIndices judge(const std::string& sequence, const std::string& technique, Sizes... sizes) {
    const SequenceRig& rig = rigOf(sequence);
    Fault fault(sound(rig, technique), sizes...);
    return rig.judge(fault);
}

// All indices but `caught` are under their bounds.
void checkQuiet(const StabilityIndices& indices, double share = 1.0, const std::string& caught = "") {
    const Bounds bounds;
    INFO("flicker " << indices.flicker.value_or(0.0) << ", ghost " << indices.ghost.value_or(0.0)
                    << ", leak " << indices.leak.value_or(0.0) << ", drift "
                    << indices.drift.value_or(0.0) << ", spike " << indices.spike.value_or(0.0));
    if (caught != "flicker") CHECK(indices.flicker.value_or(0.0) < share * bounds.flicker);
    if (caught != "ghost") CHECK(indices.ghost.value_or(0.0) < share * bounds.ghost);
    if (caught != "leak") CHECK(indices.leak.value_or(0.0) < share * bounds.leak);
    if (caught != "drift") CHECK(indices.drift.value_or(0.0) < share * bounds.drift);
    if (caught != "spike") CHECK(indices.spike.value_or(0.0) < share * bounds.spike);
}

}  // namespace

TEST_CASE("a second truth stays under a quarter of every bound") {
    for (const char* sequence : {"camera_pan", "camera_cut", "thin_walls"}) {
        INFO(sequence);
        const StabilityIndices floors = rigOf(sequence).floors();
        checkQuiet(floors, kFloorShare);
        CHECK(floors.ghost.value_or(0.0) > -kFloorShare * Bounds().ghost);
    }
}

TEST_CASE("techniques without a planted fault stay under the bounds") {
    for (const char* sequence : {"camera_pan", "camera_cut", "thin_walls"}) {
        INFO(sequence);
        const SequenceRig& rig = rigOf(sequence);
        checkQuiet(rig.judge(*sound(rig, "rival")));
    }
    const SequenceRig& cut = rigOf("camera_cut");
    checkQuiet(cut.judge(*sound(cut, "rsm")));
}

TEST_CASE("a technique that adds noise flickers") {
    for (const auto& [sequence, technique] :
         {std::pair{"camera_pan", "rival"}, std::pair{"camera_cut", "rival"},
          std::pair{"camera_cut", "rsm"}}) {
        INFO(sequence << ", " << technique);
        const StabilityIndices indices = judge<NoisyFault>(sequence, technique, 0.3f);
        CHECK(indices.flicker.value() > Bounds().flicker);
        checkQuiet(indices, 1.0, "flicker");
    }
}

TEST_CASE("a technique that lags has ghosts") {
    for (const char* technique : {"rival", "rsm"}) {
        INFO(technique);
        const StabilityIndices indices = judge<LaggingFault>("camera_cut", technique, 0.2f);
        CHECK(indices.ghost.value() > Bounds().ghost);
        CHECK(indices.frames[std::size_t(kFrames / 2 + studio::kGhostAge)].ghost.has_value());
        checkQuiet(indices, 1.0, "ghost");
    }
    // In motion the picture's own light lags with it, which is drift, too.
    CHECK(judge<LaggingFault>("camera_pan", "rival", 0.2f).ghost.value() > Bounds().ghost);
}

TEST_CASE("a technique that leaks does so into the sealed room") {
    const StabilityIndices indices = judge<LeakingFault>("thin_walls", "rival", 0.05f);
    CHECK(indices.leak.value() > Bounds().leak);
    CHECK(indices.worstReason == studio::StabilityReason::Leak);
    checkQuiet(indices, 1.0, "leak");
    // rsm knows no walls at all.
    const SequenceRig& rig = rigOf("thin_walls");
    CHECK(rig.judge(*sound(rig, "rsm")).leak.value() > Bounds().leak);
}

TEST_CASE("a technique that gains light drifts") {
    for (const auto& [sequence, technique] :
         {std::pair{"camera_pan", "rival"}, std::pair{"camera_cut", "rival"},
          std::pair{"camera_cut", "rsm"}}) {
        INFO(sequence << ", " << technique);
        for (float share : {0.01f, -0.01f}) {
            const StabilityIndices indices = judge<DriftingFault>(sequence, technique, share);
            CHECK(indices.drift.value() > Bounds().drift);
            checkQuiet(indices, 1.0, "drift");
        }
    }
}

TEST_CASE("a technique that flashes has a spike") {
    constexpr int kFrame = 13;
    for (const auto& [sequence, technique] :
         {std::pair{"camera_pan", "rival"}, std::pair{"camera_cut", "rival"},
          std::pair{"camera_cut", "rsm"}})
        for (const auto& [radius, times] : {std::pair{0.08f, 1.0f}, std::pair{9.0f, 0.4f}}) {
            INFO(sequence << ", " << technique << ", radius " << radius);
            const StabilityIndices indices =
                judge<FlashingFault>(sequence, technique, kFrame, radius, times);
            CHECK(indices.spike.value() > Bounds().spike);
            CHECK(indices.spike.value() == indices.frames[kFrame].spike.value());
            CHECK(indices.worstFrame == kFrame);
            checkQuiet(indices, 1.0, "spike");
        }
}
