// The catalogue of failures: frames that are the same every time, ways from frame to frame that are
// true, and truths that keep their noise where nothing changes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <set>

#include <fmt/format.h>
#include <unistd.h>
#include <glm/gtc/quaternion.hpp>

#include "film.h"
#include "path_tracer.h"
#include "render_inputs.h"
#include "sequence.h"
#include "stability_indices.h"
#include "stability_scaled.h"
#include "stability_truth.h"

using namespace studio;

namespace {

constexpr SequenceSize kShort{4, 48, 27};

struct CacheFolder {
    std::filesystem::path path;
    CacheFolder() : path(std::filesystem::temp_directory_path() / fmt::format("lw_seq_{}", getpid())) {
        std::filesystem::create_directories(path);
    }
    ~CacheFolder() { std::filesystem::remove_all(path); }
};

GBuffer viewOf(const RayScene& scene, const SequenceFrame& frame) {
    return renderGBuffer(scene, frame.camera, frame.width, frame.height, frame.camera, frame.time);
}

// Everything that a frame's pictures depend on.
std::uint64_t hashFrame(const SequenceFrame& frame) {
    const RayScene scene(frame.scene, frame.time);
    const std::uint64_t parts[] = {hashScene(scene), hashView(viewOf(scene, frame)),
                                   std::uint64_t(frame.isCut) + 2 * std::uint64_t(frame.reset)};
    return hashBytes(parts, sizeof parts, 1);
}

std::size_t countMatched(const std::vector<glm::vec2>& previous) {
    std::size_t count = 0;
    for (const glm::vec2& at : previous) count += std::isnan(at.x) ? 0 : 1;
    return count;
}

std::size_t countSurfaces(const SeenFrame& seen) {
    std::size_t count = 0;
    for (const std::uint8_t surface : seen.surface) count += surface;
    return count;
}

// Frames with both references of their truths: the first judged by the second.
std::vector<StabilityFrame> noiseFrames(const FailureSequence& sequence, int samples,
                                        const std::string& folder) {
    cli::SequenceTruths truths(folder);
    const SequenceFrame& middle = sequence.frames[sequence.frames.size() / 2];
    const RayScene middleScene(middle.scene, middle.time);
    const auto guide = makeGuide(middleScene, viewOf(middleScene, middle));
    std::vector<StabilityFrame> frames;
    SeenFrame seenBefore;
    for (std::size_t f = 0; f < sequence.frames.size(); ++f) {
        const SequenceFrame& frame = sequence.frames[f];
        const RayScene scene(frame.scene, frame.time);
        cli::SequenceTruths::Request request;
        request.samples = samples;
        request.sharesPoints = sequence.truthSharesPoints;
        request.guide = guide.get();
        const auto truth = truths.obtain(scene, viewOf(scene, frame), request);
        const SeenFrame seen = seeFrame(scene, frame);
        StabilityFrame judged;
        judged.width = frame.width;
        judged.height = frame.height;
        judged.image = truth->first;
        judged.truth = truth->second;
        judged.surface = seen.surface;
        judged.isCut = frame.isCut;
        judged.previous = f == 0 ? std::vector<glm::vec2>(seen.surface.size(), glm::vec2(NAN))
                                 : previousPositions(scene, frame, sequence.frames[f - 1], seenBefore);
        frames.push_back(std::move(judged));
        seenBefore = seen;
    }
    return frames;
}

}  // namespace

TEST_CASE("the catalogue's sequences are the same every time") {
    REQUIRE(sequenceCatalogue().size() >= 18);
    std::set<std::string> names;
    for (const SequenceEntry& entry : sequenceCatalogue()) {
        INFO(entry.name);
        CHECK(names.insert(entry.name).second);
        const FailureSequence a = makeSequence(entry.name, kShort), b = makeSequence(entry.name, kShort);
        REQUIRE(a.frames.size() == std::size_t(kShort.frames));
        CHECK(a.frames[0].isCut);
        CHECK(a.frames[0].reset);
        for (std::size_t f = 0; f < a.frames.size(); ++f)
            CHECK(hashFrame(a.frames[f]) == hashFrame(b.frames[f]));
    }
}

TEST_CASE("sequences that move by steps begin the same, however long they are") {
    for (const char* name : {"camera_pan", "light_sweep_quick", "moving_object", "grid_crossing"}) {
        INFO(name);
        const FailureSequence few = makeSequence(name, kShort);
        const FailureSequence many = makeSequence(name, {9, kShort.width, kShort.height});
        for (std::size_t f = 0; f < few.frames.size(); ++f)
            CHECK(hashFrame(few.frames[f]) == hashFrame(many.frames[f]));
        CHECK(hashFrame(few.frames[0]) != hashFrame(few.frames[1]));
    }
}

TEST_CASE("cuts, sizes and errors") {
    const FailureSequence cut = makeSequence("camera_cut", kShort);
    int cuts = 0;
    for (const SequenceFrame& frame : cut.frames) {
        cuts += frame.isCut ? 1 : 0;
        CHECK(frame.isCut == frame.reset);
    }
    CHECK(cuts == 2);  // the first frame and the one in the middle
    CHECK(cut.frames[2].isCut);

    const FailureSequence sizes = makeSequence("resolution_change", {8, 320, 180});
    CHECK(sizes.frames[0].width == 320);
    CHECK(sizes.frames[2].width == 256);
    CHECK(sizes.frames[4].width == 160);
    CHECK(sizes.frames[4].height == 90);
    CHECK(sizes.frames[7].width == 256);

    CHECK_THROWS_WITH(makeSequence("pan", kShort), Catch::Contains("camera_pan"));
    CHECK_THROWS_WITH(makeSequence("camera_pan", {1, 48, 27}), Catch::Contains("2 frames"));
}

TEST_CASE("ways from frame to frame agree with the G-buffer's motion vectors") {
    // Two programs for one thing: the host's motion vectors know no visibility, these ways do.
    for (const char* name : {"camera_pan", "camera_dolly", "moving_object", "opening_door"}) {
        INFO(name);
        const FailureSequence sequence = makeSequence(name, {4, 96, 54});
        const SequenceFrame &before = sequence.frames[1], &frame = sequence.frames[2];
        const RayScene beforeScene(before.scene, before.time), scene(frame.scene, frame.time);
        const auto previous = previousPositions(scene, frame, before, seeFrame(beforeScene, before));
        const GBuffer view =
            renderGBuffer(scene, frame.camera, frame.width, frame.height, before.camera, before.time);
        std::size_t matched = 0;
        float apart = 0.0f;
        for (int y = 0; y < frame.height; ++y)
            for (int x = 0; x < frame.width; ++x) {
                const glm::vec2 at =
                    previous[std::size_t(y) * std::size_t(frame.width) + std::size_t(x)];
                if (std::isnan(at.x)) continue;
                ++matched;
                const glm::vec2 motion(view.motion.row(0, y)[x], view.motion.row(1, y)[x]);
                apart = std::max(
                    apart, glm::length(at - (glm::vec2(float(x) + 0.5f, float(y) + 0.5f) + motion)));
            }
        CHECK(apart < 1e-3f);  // pixels: rounding of two ways to the same number
        CHECK(matched > countSurfaces(seeFrame(scene, frame)) * 8 / 10);
    }
}

TEST_CASE("what comes into view is revealed, what stays is followed") {
    const FailureSequence object = makeSequence("moving_object", {4, 96, 54});
    const RayScene beforeScene(object.frames[0].scene, object.frames[0].time);
    const RayScene scene(object.frames[1].scene, object.frames[1].time);
    const SeenFrame seen = seeFrame(scene, object.frames[1]);
    const auto previous = previousPositions(scene, object.frames[1], object.frames[0],
                                            seeFrame(beforeScene, object.frames[0]));
    const std::size_t revealed = countSurfaces(seen) - countMatched(previous);
    CHECK(revealed > 0);
    CHECK(revealed < countSurfaces(seen) / 10);
    const int box = seen.mesh.empty() ? -1 : int(object.frames[0].scene->meshes.size()) - 1;
    std::size_t moved = 0;
    for (std::size_t i = 0; i < previous.size(); ++i) {
        if (std::isnan(previous[i].x)) continue;
        const glm::vec2 centre(float(i % 96) + 0.5f, float(i / 96) + 0.5f);
        if (seen.mesh[i] != box)
            CHECK(glm::length(previous[i] - centre) < 1e-3f);  // the camera stands still
        else
            moved += glm::length(previous[i] - centre) > 0.1f ? 1 : 0;
    }
    CHECK(moved > 20);

    const FailureSequence still = makeSequence("camera_cut", {8, 48, 27});
    const RayScene room(still.frames[0].scene, 0.0f);
    const SeenFrame roomSeen = seeFrame(room, still.frames[0]);
    CHECK(countMatched(previousPositions(room, still.frames[1], still.frames[0], roomSeen)) ==
          countSurfaces(roomSeen));
    CHECK(countMatched(previousPositions(room, still.frames[4], still.frames[3], roomSeen)) == 0);
}

TEST_CASE("a truth keeps its noise where nothing changes") {
    const CacheFolder cache;
    // The camera moves, the light does not: every surface keeps its light.
    const FailureSequence dolly = makeSequence("camera_dolly", {3, 64, 36});
    const auto frames = noiseFrames(dolly, 16, cache.path.string());
    const StabilityIndices noise = stabilityIndices(frames);
    INFO("error of one reference by the other " << noise.error << ", flicker " << *noise.flicker);
    CHECK(noise.error > 0.05);  // there is noise,
    // which stands still: with points of each pixel's own, independent from frame to frame, the flicker
    // is 1.4 times the error. What is left is of pixels that fall between two, a whole picture of them
    // here.
    CHECK(*noise.flicker < 0.5 * noise.error);

    // Traced once: the second run takes all from the cache, bit for bit.
    const auto again = noiseFrames(dolly, 16, cache.path.string());
    for (std::size_t f = 0; f < frames.size(); ++f) CHECK(frames[f].image == again[f].image);
}

TEST_CASE("where all light changes pixels' own points keep the truth's drift low") {
    const CacheFolder cache;
    FailureSequence sweep = makeSequence("light_sweep_quick", {32, 48, 27});
    REQUIRE_FALSE(sweep.truthSharesPoints);
    const double own = *stabilityIndices(noiseFrames(sweep, 32, cache.path.string())).drift;
    sweep.truthSharesPoints = true;
    const double shared = *stabilityIndices(noiseFrames(sweep, 32, cache.path.string())).drift;
    INFO("drift of the noise " << own << ", with shared points " << shared);
    CHECK(own < 0.025);  // a quarter of what is noticed
    CHECK(shared > 2.0 * own);
}

TEST_CASE("a kept truth that is damaged is named, with what to do") {
    const CacheFolder cache;
    const FailureSequence dolly = makeSequence("camera_dolly", {2, 16, 9});
    noiseFrames(dolly, 2, cache.path.string());
    for (const auto& file : std::filesystem::directory_iterator(cache.path))
        std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    CHECK_THROWS_WITH(noiseFrames(dolly, 2, cache.path.string()),
                      Catch::Contains("cornell") && Catch::Contains("delete it"));
}

TEST_CASE("one truth serves all scales") {
    const CacheFolder cache;
    const FailureSequence dolly = makeSequence("camera_dolly", {2, 48, 27});
    const SequenceFrame& frame = dolly.frames[1];
    const RayScene scene(frame.scene, frame.time);
    const GBuffer view = viewOf(scene, frame);
    cli::SequenceTruths truths(cache.path.string());
    cli::SequenceTruths::Request request;
    request.samples = 32;
    const auto guide = makeGuide(scene, view);
    request.guide = guide.get();
    const auto truth = truths.obtain(scene, view, request);
    for (const char* name : {"scale_small", "scale_large"}) {
        INFO(name);
        const FailureSequence scaledSequence = makeSequence(name, {2, 48, 27});
        CHECK(hashFrame(scaledSequence.frames[1]) == hashFrame(frame));  // the truth is the dolly's own
        const cli::ScaledFrame scaled(scene, frame, scaledSequence.scale);
        const GBuffer scaledView = renderGBuffer(scaled.scene(), scaled.camera(frame.camera), 48, 27,
                                                 scaled.camera(frame.camera), frame.time);
        const auto other = truths.obtain(scaled.scene(), scaledView, request);
        std::vector<std::uint8_t> surface = seeFrame(scene, frame).surface;
        const std::size_t all = std::size_t(std::count(surface.begin(), surface.end(), 1));
        cli::dropUnlikePixels(scaledView, scaledSequence.scale, seeFrame(scene, frame),
                              frame.camera.position, surface);
        CHECK(std::size_t(std::count(surface.begin(), surface.end(), 1)) > all * 99 / 100);
        // Rounding may turn single rays; the picture as a whole is the same.
        double difference = 0.0, light = 0.0;
        for (std::size_t i = 0; i < truth->mean.size(); ++i) {
            if (surface[i % surface.size()] == 0) continue;
            difference += std::abs(double(truth->mean[i]) - double(other->mean[i]));
            light += double(truth->mean[i]);
        }
        CHECK(light > 0.0);
        CHECK(difference < 2e-3 * light);
    }
}

TEST_CASE("no light gets into a sealed room, at any bounce") {
    const CacheFolder cache;
    for (const char* name : {"thin_walls", "light_blocked"}) {
        INFO(name);
        const FailureSequence sequence = makeSequence(name, {4, 64, 36});
        for (const std::size_t f : {std::size_t(0), std::size_t(3)}) {
            const SequenceFrame& frame = sequence.frames[f];
            const RayScene scene(frame.scene, frame.time);
            const GBuffer view = viewOf(scene, frame);
            cli::SequenceTruths truths(cache.path.string());
            cli::SequenceTruths::Request request;
            request.bounces = 0;
            request.samples = 32;
            const auto guide = makeGuide(scene, view);
            request.guide = guide.get();
            const auto truth = truths.obtain(scene, view, request);
            const SeenFrame seen = seeFrame(scene, frame);
            std::size_t sealed = 0, lit = 0;
            double inside = 0.0, outside = 0.0;
            for (std::size_t i = 0; i < seen.surface.size(); ++i) {
                const std::uint8_t region =
                    seen.surface[i] != 0 ? sequence.region(frame, seen.position[i]) : 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const double value = double(truth->mean[c * seen.surface.size() + i]);
                    if (region == 1) inside += value;
                    if (region == 2) outside += value;
                }
                sealed += region == 1 ? 1 : 0;
                lit += region == 2 ? 1 : 0;
            }
            CHECK(sealed > 100);
            CHECK(lit > 30);
            CHECK(inside == 0.0);
            CHECK(outside > 0.0);
        }
    }
}

TEST_CASE("the spherical room's truth is the same everywhere") {
    const CacheFolder cache;
    const FailureSequence sequence = makeSequence("spherical_room", {2, 24, 14});
    const auto frames = noiseFrames(sequence, 256, cache.path.string());
    // Flux of the spot, W: intensity times the integral of its profile over solid angle.
    const Light& lamp = sequence.frames[0].scene->lights[0];
    double flux = 0.0;
    constexpr int kSteps = 10000;
    for (int i = 0; i < kSteps; ++i) {
        const double angle = (i + 0.5) * double(lamp.outerCone) / kSteps;
        const glm::vec3 way =
            glm::angleAxis(float(angle), glm::normalize(glm::cross(lamp.direction, {0, 1, 0}))) *
            lamp.direction;
        flux += double(lamp.emitted.x * coneFalloff(lamp, way)) * 2.0 * double(kPi) * std::sin(angle) *
                double(lamp.outerCone) / kSteps;
    }
    const double expected = 0.5 * flux / (4.0 * double(kPi));  // albedo 0.5, radius 1
    for (const StabilityFrame& frame : frames) {
        double sum = 0.0;
        float least = INFINITY, most = 0.0f;
        for (const float value : frame.truth) {
            sum += double(value);
            least = std::min(least, value);
            most = std::max(most, value);
        }
        // 128 paths in each pixel; the mesh's bands stand for a sphere to a thousandth.
        CHECK(sum / double(frame.truth.size()) == Approx(expected).epsilon(0.02));
        CHECK(double(least) > 0.9 * expected);
        CHECK(double(most) < 1.1 * expected);
    }
}
