// What the times of a chart are made of, and what its techniques get of a scene's triangles.
#include <algorithm>

#include <catch2/catch.hpp>
#include <memory>
#include <vector>

#include "../support/quad_scene.h"
#include "chart_frames.h"

TEST_CASE("median and 99th percentile by nearest rank", "[chart]") {
    CHECK(cli::summarise({5.0}).median == 5.0);
    CHECK(cli::summarise({5.0}).p99 == 5.0);
    CHECK(cli::summarise({4.0, 1.0, 3.0, 2.0}).median == 2.5);
    CHECK(cli::summarise({4.0, 1.0, 3.0, 2.0}).p99 == 4.0);  // under 100 frames the slowest
    std::vector<double> many;
    for (int i = 200; i >= 1; --i) many.push_back(double(i));
    CHECK(cli::summarise(many).median == 100.5);
    CHECK(cli::summarise(many).p99 == 198.0);  // 99 % of the frames take no longer
}

TEST_CASE("times of a queue that measures none are unavailable", "[chart]") {
    CHECK(cli::summarise({}).median < 0.0);
    CHECK(cli::summarise({-1.0, -1.0}).p99 < 0.0);
}

namespace {

// Counts frames; its picture is the number of the frame until it settles.
class Counting final : public cli::IndirectRenderer {
public:
    explicit Counting(int settlesAfter) : settles_(settlesAfter) {}
    cli::FrameSample renderFrame(const cli::RenderInputs&, bool reset) override {
        frames_ = reset ? 1 : frames_ + 1;
        irradiance_.row(0, 0)[0] = float(std::min(frames_, settles_));
        cli::FrameSample sample;
        sample.wallMilliseconds = sample.totalMilliseconds = 1.0;
        return sample;
    }
    int frames() const { return frames_; }
    const studio::PlanarBuffer& irradiance() const override { return irradiance_; }
    const studio::PlanarBuffer& validity() const override { return irradiance_; }
    std::uint64_t estimatedBytes() const override { return 0; }
    const LWDeviceInfo* device() const override { return nullptr; }
    cli::DebugPlanes readDebugView(const std::string&) const override { return {}; }

private:
    int settles_, frames_ = 0;
    studio::PlanarBuffer irradiance_{2, 2, 3};
};

const cli::RenderInputs& anyInputs() {
    static const studio::RayScene scene = [] {
        test::QuadScene s;
        s.quad(s.material(glm::vec3(0.5f)), {-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1});
        return s.build();
    }();
    static const cli::RenderInputs inputs = [] {
        cli::InputOptions options;
        options.width = options.height = 2;
        return cli::RenderInputs(scene, studio::Camera{}, options);
    }();
    return inputs;
}

}  // namespace

TEST_CASE("a frame longer than the patience is measured cold, others after the warm-up", "[chart]") {
    cli::FrameLimits limits;
    limits.fewest = 2;
    limits.seconds = 0.0;
    Counting quick(0);
    const cli::ChartedFrames warm = cli::timeFrames(quick, anyInputs(), limits);
    CHECK(warm.warmUp == 3);
    CHECK(warm.frames == 2);
    CHECK(quick.frames() == 5);
    CHECK(warm.processor.median >= 0.0);

    limits.patience = 0.0;
    Counting slow(0);
    const cli::ChartedFrames cold = cli::timeFrames(slow, anyInputs(), limits);
    CHECK(cold.warmUp == 0);
    CHECK(cold.frames == 1);
    CHECK(slow.frames() == 1);
    CHECK(cold.wall.median == 1.0);
}

TEST_CASE("a picture is rendered again until it repeats, or as often as it was", "[chart]") {
    Counting still(0), history(4), longHistory(100);
    cli::renderAgain(still, anyInputs(), 12);
    CHECK(still.frames() == 2);
    cli::renderAgain(history, anyInputs(), 12);
    CHECK(history.frames() == 5);
    cli::renderAgain(longHistory, anyInputs(), 12);
    CHECK(longHistory.frames() == 12);
}

TEST_CASE("what glows is handed over with the triangles, where the scene lets it light", "[chart]") {
    const auto sceneOf = [](bool glows, bool lights) {
        test::QuadScene quads;
        quads.quad(quads.material(glm::vec3(0.5f)), {-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1});
        const int lamp = quads.material(glm::vec3(0.25f));
        quads.quad(lamp, {-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1});
        if (glows) quads.scene.materials[std::size_t(lamp)].emission = {3.0f, 2.0f, 1.0f};
        quads.scene.emissiveSurfaces = lights;
        return std::make_unique<studio::RayScene>(std::make_shared<const studio::Scene>(quads.scene),
                                                  0.0f);
    };
    cli::InputOptions options;
    options.width = options.height = 2;
    const auto dark = sceneOf(false, true), off = sceneOf(true, false), on = sceneOf(true, true);
    const cli::RenderInputs none(*dark, studio::Camera{}, options),
        unlit(*off, studio::Camera{}, options), lit(*on, studio::Camera{}, options);
    CHECK(none.geometry().triangleEmission == nullptr);
    CHECK(unlit.geometry().triangleEmission == nullptr);
    REQUIRE(lit.geometry().triangleCount == 4);
    REQUIRE(lit.geometry().triangleEmission != nullptr);
    const float* emission = lit.geometry().triangleEmission;
    CHECK(std::vector<float>(emission, emission + 12) ==
          std::vector<float>{0, 0, 0, 0, 0, 0, 3, 2, 1, 3, 2, 1});
    CHECK(none.geometry().version == unlit.geometry().version);
    CHECK(lit.geometry().version !=
          none.geometry().version);  // else a technique would keep the dark ones
}
