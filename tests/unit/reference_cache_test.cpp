// Truths that are kept: found again, gone on with, told apart.
#include <catch2/catch.hpp>

#include <filesystem>

#include "../support/quad_scene.h"
#include "../support/studio_scenes.h"
#include "reference_cache.h"

namespace fs = std::filesystem;
using cli::Truth;
using cli::TruthRequest;
using glm::vec3;

namespace {

studio::RayScene corner(float albedo) {
    test::QuadScene s;
    const int grey = s.material(vec3(albedo));
    s.quad(grey, vec3(-1, 0, -1), vec3(1, 0, -1), vec3(1, 0, 1), vec3(-1, 0, 1));
    s.quad(grey, vec3(-1, 0, -1), vec3(-1, 2, -1), vec3(-1, 2, 1), vec3(-1, 0, 1));
    s.point(vec3(0.5f, 1.5f, 0.2f), vec3(1.0f));
    return s.build();
}

test::Receivers floorView(int size) {
    test::Receivers r(size, size, vec3(0, 1, 3));
    r.grid(vec3(-1, 0, -1), vec3(2, 0, 0), vec3(0, 0, 2), vec3(0, 1, 0));
    return r;
}

TruthRequest request(const std::string& folder, double noise) {
    TruthRequest request;
    request.noise = noise;
    request.directory = folder;
    return request;
}

int filesIn(const std::string& folder, const std::string& extension) {
    int count = 0;
    for (const auto& file : fs::directory_iterator(folder))
        count += file.path().extension() == extension;
    return count;
}

bool sameBits(const Truth& a, const Truth& b) {
    for (const char* channel : {"R", "G", "B"})
        if (a.image.plane(channel) != b.image.plane(channel)) return false;
    return true;
}

struct Stop {};

}  // namespace

TEST_CASE("a truth is traced once, to the noise asked for", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    const Truth first = cli::obtainTruth(scene, view.view, request(folder.path(), 0.01));
    CHECK(first.noise <= 0.01);
    CHECK(first.samples >= 16);
    CHECK(first.image.metadata.at("layer") == "bounce1");
    CHECK(filesIn(folder.path(), ".exr") == 1);
    CHECK(filesIn(folder.path(), ".film") == 0);

    TruthRequest again = request(folder.path(), 0.01);
    again.progress = [](double, double) { throw Stop(); };  // nothing is traced
    CHECK(sameBits(cli::obtainTruth(scene, view.view, again), first));

    const Truth better = cli::obtainTruth(scene, view.view, request(folder.path(), 0.3 * first.noise));
    CHECK(better.noise <= 0.3 * first.noise);
    CHECK(better.samples > first.samples);
    CHECK(filesIn(folder.path(), ".exr") == 1);

    TruthRequest hasty = request(folder.path(), 1e-9);  // ends with less than what is kept
    hasty.seconds = 1e-6;
    CHECK(sameBits(cli::obtainTruth(scene, view.view, hasty), better));
}

TEST_CASE("an interrupted truth goes on to the same bits", "[chart]") {
    const studio_test::TempFolder folder, straight;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    TruthRequest cut = request(folder.path(), 1e-4);
    cut.progress = [](double, double) { throw Stop(); };
    CHECK_THROWS_AS(cli::obtainTruth(scene, view.view, cut), Stop);
    CHECK(filesIn(folder.path(), ".film") == 1);
    CHECK(filesIn(folder.path(), ".exr") == 0);
    const Truth resumed = cli::obtainTruth(scene, view.view, request(folder.path(), 1e-3));
    const Truth whole = cli::obtainTruth(scene, view.view, request(straight.path(), 1e-3));
    // The interrupted pass may be longer than what the target needs; equal samples, equal bits.
    if (resumed.samples == whole.samples) CHECK(sameBits(resumed, whole));
    CHECK(resumed.noise <= 1e-3);
    CHECK(filesIn(folder.path(), ".film") == 0);
}

TEST_CASE("time that is up leaves a truth with its noise, and the next call goes on", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    TruthRequest hasty = request(folder.path(), 1e-9);
    hasty.seconds = 1e-6;
    const Truth first = cli::obtainTruth(scene, view.view, hasty);
    CHECK(first.noise > 1e-9);
    CHECK(filesIn(folder.path(), ".film") == 1);
    const Truth second = cli::obtainTruth(scene, view.view, hasty);
    CHECK(second.samples > first.samples);
}

TEST_CASE("another scene, view or number of bounces has a truth of its own", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f), darker = corner(0.6f);
    const test::Receivers view = floorView(12), finer = floorView(13);
    TruthRequest all = request(folder.path(), 1.0);
    const Truth one = cli::obtainTruth(scene, view.view, all);
    cli::obtainTruth(darker, view.view, all);
    cli::obtainTruth(scene, finer.view, all);
    all.bounces = 2;
    cli::obtainTruth(scene, view.view, all);
    all.bounces = 0;
    const Truth every = cli::obtainTruth(scene, view.view, all);
    CHECK(filesIn(folder.path(), ".exr") == 5);
    CHECK(every.image.metadata.at("layer") == "all");
    double sumOne = 0.0, sumAll = 0.0;
    for (std::size_t i = 0; i < one.image.pixelCount(); ++i) {
        sumOne += double(one.image.plane("G")[i]);
        sumAll += double(every.image.plane("G")[i]);
    }
    CHECK(sumAll > sumOne);
}
