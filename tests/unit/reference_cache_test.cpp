// Truths that are kept: found again, gone on with, told apart.
#include <catch2/catch.hpp>

#include <filesystem>
#include <set>
#include <thread>

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

Truth truthOf(const studio::RayScene& scene, const studio::GBuffer& view, const TruthRequest& request) {
    std::vector<Truth> truths = cli::obtainTruths(scene, view, request);
    REQUIRE(truths.size() == 1);
    return std::move(truths.front());
}

double meanGreen(const Truth& truth) {
    double sum = 0.0;
    for (const float value : truth.image.plane("G")) sum += double(value);
    return sum / double(truth.image.pixelCount());
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

TEST_CASE("light of what pictures show is kept apart from all light, and by picture", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    studio::PictureView picture{view.view.camera, 32, 32};
    picture.camera.target = vec3(0, 1, 0);
    TruthRequest some = request(folder.path(), 0.02);
    some.sendersSeenBy = {picture};
    const Truth all = truthOf(scene, view.view, request(folder.path(), 0.02));
    const Truth shown = truthOf(scene, view.view, some);
    picture.camera.target = vec3(0, 1, 9);  // looks away
    some.sendersSeenBy = {picture};
    const Truth none = truthOf(scene, view.view, some);
    CHECK(std::set<std::string>{all.name, shown.name, none.name}.size() == 3);
    CHECK(filesIn(folder.path(), ".exr") == 3);
    CHECK(meanGreen(shown) > 0.0);
    CHECK(meanGreen(none) == 0.0);
    CHECK(sameBits(all, truthOf(scene, view.view, request(folder.path(), 0.02))));
    some.bounces = {2};
    CHECK_THROWS_WITH(cli::obtainTruths(scene, view.view, some), Catch::Contains("expected 1"));
}

TEST_CASE("a truth is traced once, to the noise asked for", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    const Truth first = truthOf(scene, view.view, request(folder.path(), 0.01));
    CHECK(first.noise <= 0.01);
    CHECK(first.samples >= 16);
    CHECK(first.image.metadata.at("layer") == "bounce1");
    CHECK(filesIn(folder.path(), ".exr") == 1);
    CHECK(filesIn(folder.path(), ".film") == 0);

    TruthRequest again = request(folder.path(), 0.01);
    again.progress = [](double, double) { throw Stop(); };  // nothing is traced
    CHECK(sameBits(truthOf(scene, view.view, again), first));

    const Truth better = truthOf(scene, view.view, request(folder.path(), 0.3 * first.noise));
    CHECK(better.noise <= 0.3 * first.noise);
    CHECK(better.samples > first.samples);
    CHECK(filesIn(folder.path(), ".exr") == 1);

    TruthRequest hasty = request(folder.path(), 1e-9);  // ends with less than what is kept
    hasty.seconds = 1e-6;
    CHECK(sameBits(truthOf(scene, view.view, hasty), better));
}

TEST_CASE("an interrupted truth goes on to the same bits", "[chart]") {
    const studio_test::TempFolder folder, straight;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    TruthRequest cut = request(folder.path(), 1e-4);
    cut.progress = [](double, double) { throw Stop(); };
    CHECK_THROWS_AS(truthOf(scene, view.view, cut), Stop);
    CHECK(filesIn(folder.path(), ".film") == 1);
    CHECK(filesIn(folder.path(), ".exr") == 0);
    const Truth resumed = truthOf(scene, view.view, request(folder.path(), 1e-3));
    const Truth whole = truthOf(scene, view.view, request(straight.path(), 1e-3));
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
    const Truth first = truthOf(scene, view.view, hasty);
    CHECK(first.noise > 1e-9);
    CHECK(filesIn(folder.path(), ".film") == 1);
    const Truth second = truthOf(scene, view.view, hasty);
    CHECK(second.samples > first.samples);

    TruthRequest any = hasty;  // what there is will do
    any.takesKept = true;
    any.progress = [](double, double) { throw Stop(); };
    const Truth kept = truthOf(scene, view.view, any);
    CHECK(kept.samples == second.samples);
    CHECK(kept.noise == second.noise);
    CHECK(sameBits(kept, second));
}

TEST_CASE("one run makes the truths of all counts of bounces", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    TruthRequest wanted = request(folder.path(), 0.01);
    wanted.bounces = {1, 2, 0};
    const std::vector<Truth> truths = cli::obtainTruths(scene, view.view, wanted);
    REQUIRE(truths.size() == 3);
    CHECK(filesIn(folder.path(), ".exr") == 1);
    for (std::size_t i = 0; i < truths.size(); ++i) {
        CHECK(truths[i].bounces == wanted.bounces[i]);
        CHECK(truths[i].samples == truths[0].samples);
        CHECK(truths[i].noise <= 0.01);
    }
    CHECK(truths[1].image.metadata.at("layer") == "bounce1+bounce2");
    CHECK(truths[2].image.metadata.at("layer") == "all");
    // Two squares see each other: each bounce adds light.
    CHECK(meanGreen(truths[1]) > meanGreen(truths[0]));
    CHECK(meanGreen(truths[2]) > meanGreen(truths[1]));

    // One of them alone, from the same run: its own, the kept one, not traced again.
    TruthRequest all = wanted;
    all.bounces = {0};
    all.progress = [](double, double) { throw Stop(); };
    CHECK(sameBits(truthOf(scene, view.view, all), truths[2]));
}

TEST_CASE("of several runs each count takes the least noisy", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    TruthRequest wanted = request(folder.path(), 0.1);
    wanted.bounces = {1, 2, 0};
    const std::vector<Truth> coarse = cli::obtainTruths(scene, view.view, wanted);
    const Truth fine = truthOf(scene, view.view, request(folder.path(), 0.2 * coarse[0].noise));
    CHECK(filesIn(folder.path(), ".exr") == 2);  // short paths for the one bounce alone
    wanted.takesKept = true;
    wanted.progress = [](double, double) { throw Stop(); };
    const std::vector<Truth> best = cli::obtainTruths(scene, view.view, wanted);
    CHECK(sameBits(best[0], fine));
    CHECK(sameBits(best[1], coarse[1]));
    CHECK(sameBits(best[2], coarse[2]));
}

TEST_CASE("two runs at once do not disturb each other", "[chart]") {
    const studio_test::TempFolder folder, alone;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(24);
    const TruthRequest wanted = request(folder.path(), 2e-3);
    std::vector<Truth> made(3);
    std::vector<std::thread> threads;
    for (Truth& truth : made)
        threads.emplace_back([&] { truth = cli::obtainTruths(scene, view.view, wanted).front(); });
    for (std::thread& thread : threads) thread.join();
    const Truth expected = truthOf(scene, view.view, request(alone.path(), 2e-3));
    for (const Truth& truth : made) {
        CHECK(truth.samples == expected.samples);
        CHECK(sameBits(truth, expected));
    }
    CHECK(filesIn(folder.path(), ".film") == 0);
}

TEST_CASE("damaged files of the cache are named", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f);
    const test::Receivers view = floorView(12);
    truthOf(scene, view.view, request(folder.path(), 1.0));
    for (const auto& file : fs::directory_iterator(folder.path()))
        if (file.path().extension() == ".exr") fs::resize_file(file.path(), 200);
    CHECK_THROWS_WITH(truthOf(scene, view.view, request(folder.path(), 1.0)),
                      Catch::Contains(".exr") && Catch::Contains("delete it"));
    TruthRequest three = request(folder.path(), 1.0);
    three.bounces = {3};
    CHECK_THROWS_AS(truthOf(scene, view.view, three), std::invalid_argument);
}

TEST_CASE("another scene, view or number of bounces has a truth of its own", "[chart]") {
    const studio_test::TempFolder folder;
    const studio::RayScene scene = corner(0.7f), darker = corner(0.6f);
    const test::Receivers view = floorView(12), finer = floorView(13);
    TruthRequest all = request(folder.path(), 1.0);
    const Truth one = truthOf(scene, view.view, all);
    truthOf(darker, view.view, all);
    truthOf(scene, finer.view, all);
    all.bounces = {2};
    truthOf(scene, view.view, all);
    all.bounces = {0};
    const Truth every = truthOf(scene, view.view, all);
    CHECK(filesIn(folder.path(), ".exr") == 5);
    CHECK(every.image.metadata.at("layer") == "all");
    CHECK(meanGreen(every) > meanGreen(one));
}
