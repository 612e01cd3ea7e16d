// Technique fallback: wherever a hemisphere is split between two techniques the sum is the same; what the first one vouches
// for is its own; handles, failures and names.
#include <catch2/catch.hpp>
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "inputs/output_target.h"
#include "support/kernel_rig.h"
#include "support/lit_room.h"
#include "support/scoped_api.h"
#include "techniques/fallback.h"

using namespace lightwell;
using namespace lightwell::test;

namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 11;
// One product and one sum in float.
constexpr double kRounding = 3e-7;

// A technique whose light and validity are given.
class Given final : public Technique {
public:
    Given(std::vector<float> irradiance, std::vector<float> validity)
        : irradiance_(std::move(irradiance)), validity_(std::move(validity)) {}

    void update(Executor&, const LWFrame&) override { ++updates; }
    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer&, const LWOutput& output) override {
        write(executor, *view, output.irradiance, irradiance_, 3, irradianceTarget_);
        write(executor, *view, output.validity, validity_, 1, validityTarget_);
    }
    void prewarm(Executor&, const std::shared_ptr<View>&) override {}
    Report report() override {
        Report report;
        report.counts.push_back({"updates", std::uint64_t(updates)});
        return report;
    }
    std::vector<DebugView> debugViews(const View*) override { return {}; }
    std::uint64_t bytes() const override { return 0; }

    int updates = 0;

private:
    static void write(Executor& executor, const View& view, const LWImage& image, const std::vector<float>& packed,
                      std::uint32_t count, OutputTarget& target) {
        const Planes planes = target.begin(executor, view, image, count, "part");
        const Buffer memory = Buffer::retained(executor.device(), planes.memory);
        for (std::uint32_t row = 0; row < count * view.height; ++row) {
            const std::int64_t at = planes.offset + row / view.height * planes.planeStride + row % view.height * planes.rowStride;
            executor.write("part.write", memory, std::size_t(at) * 4, view.width * 4, &packed[row * view.width]);
        }
        target.end(executor);
    }

    std::vector<float> irradiance_, validity_;
    OutputTarget irradianceTarget_, validityTarget_;
};

struct Joined {
    std::vector<float> irradiance, validity;
    std::uint64_t saturated = 0;
};

// One frame of the two joined, on images as a host has them.
Joined joined(Device& device, const std::shared_ptr<Technique>& first, const std::shared_ptr<Technique>& second) {
    const auto technique = joinTechniques(device, {first, second});
    Profile profile;
    Executor executor(device, profile);
    PlanarPixels irradiance(kWidth, kHeight, 3), validity(kWidth, kHeight, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    output.validity = validity.image();
    const auto view = std::make_shared<View>(kWidth, kHeight);
    technique->update(executor, LWFrame{});
    technique->render(executor, view, LWGBuffer{}, output);
    Report report = technique->report();
    device.finish();
    report.resolve();
    Joined result{irradiance.packed(), validity.packed(), 0};
    for (const LWCount& count : report.counts)
        if (std::strcmp(count.name, "saturated_pixels") == 0) result.saturated = count.value;
    return result;
}

std::vector<float> noise(std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<float> values(count);
    for (float& value : values) value = float(random() >> 8) / float(1 << 24);
    return values;
}

constexpr std::size_t kPixels = std::size_t(kWidth) * kHeight;

}  // namespace

TEST_CASE("a furnace split anywhere between two techniques has the same light", "[fallback]") {
    Device& device = sharedDevice(GENERATE(1u, 16u));
    constexpr double kFurnace[] = {3.0, 0.5, 700.0};
    // Nothing, everything and every share between seen by the first.
    std::vector<float> seen = noise(kPixels, 1), light(3 * kPixels), whole(3 * kPixels);
    seen[0] = 0.0f;
    seen[1] = 1.0f;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < kPixels; ++i) {
            light[c * kPixels + i] = float(double(seen[i]) * kFurnace[c]);
            whole[c * kPixels + i] = float(kFurnace[c]);
        }
    const Joined sum = joined(device, std::make_shared<Given>(light, seen),
                              std::make_shared<Given>(whole, std::vector<float>(kPixels, 1.0f)));
    for (std::size_t i = 0; i < 3 * kPixels; ++i) {
        CAPTURE(i);
        CHECK(double(sum.irradiance[i]) == Approx(kFurnace[i / kPixels]).epsilon(kRounding));
    }
    for (const float v : sum.validity) CHECK(double(v) == Approx(1.0).epsilon(kRounding));
    CHECK(sum.saturated == 0);
}

TEST_CASE("the sum and its validity are those of the equations", "[fallback]") {
    Device& device = sharedDevice(GENERATE(1u, 16u));
    const std::vector<float> e1 = noise(3 * kPixels, 2), v1 = noise(kPixels, 3), e2 = noise(3 * kPixels, 4), v2 = noise(kPixels, 5);
    const Joined sum = joined(device, std::make_shared<Given>(e1, v1), std::make_shared<Given>(e2, v2));
    for (std::size_t i = 0; i < 3 * kPixels; ++i)
        CHECK(double(sum.irradiance[i]) ==
              Approx(double(e1[i]) + (1.0 - double(v1[i % kPixels])) * double(e2[i])).epsilon(kRounding));
    for (std::size_t i = 0; i < kPixels; ++i)
        CHECK(double(sum.validity[i]) == Approx(double(v1[i]) + (1.0 - double(v1[i])) * double(v2[i])).epsilon(kRounding));
}

TEST_CASE("a sum beyond the largest irradiance is brought down and counted", "[fallback]") {
    Device& device = sharedDevice(16);
    std::vector<float> most(3 * kPixels, 0.0f);
    most[5] = most[kPixels + 7] = most[2 * kPixels + 7] = 1e36f;
    const auto part = [&] { return std::make_shared<Given>(most, std::vector<float>(kPixels, 0.0f)); };
    const Joined sum = joined(device, part(), part());
    CHECK(sum.irradiance[5] == 1e36f);
    CHECK(sum.irradiance[4] == 0.0f);
    CHECK(sum.saturated == 2);
}

namespace {

double uniformProfile(double, double) { return 1.0; }

// rsm and ssvp over a lit floor, and the two joined.
struct JoinRig {
    explicit JoinRig(std::uint32_t width)
        : device(width), floor(24, uniformProfile), scene(kWidth, kHeight), view(device, kWidth, kHeight),
          rsm(std::make_unique<TestTechnique>(device, "rsm", nullptr)),
          ssvp(std::make_unique<TestTechnique>(device, "ssvp", nullptr)) {}

    LWFallbackDesc desc() const {
        LWFallbackDesc desc;
        lwDefaultFallback(&desc);
        desc.first = *rsm;
        desc.second = *ssvp;
        return desc;
    }
    // lwCreateTechnique of what it refuses.
    LWStatus refused(const LWFallbackDesc& desc) {
        LWTechnique technique = nullptr;
        const LWStatus status = lwCreateFallback(device, &desc, &technique);
        CHECK(technique == nullptr);
        return status;
    }

    TestDevice device;
    LitFloor floor;
    WallAndCeiling scene;
    TestView view;
    std::unique_ptr<TestTechnique> rsm, ssvp;
};

}  // namespace

TEST_CASE("what the first technique vouches for is its own, bit for bit, also after the handles are let go", "[fallback]") {
    JoinRig rig(GENERATE(1u, 16u));
    const LWFallbackDesc desc = rig.desc();
    TestTechnique joined(rig.device, "fallback", &desc);
    rig.rsm->update({rig.floor.light});
    const std::vector<float> expected = rig.rsm->render(rig.view, rig.scene.gbuffer);
    rig.rsm.reset();
    rig.ssvp.reset();
    joined.update({rig.floor.light});
    CHECK(bitDifference(joined.render(rig.view, rig.scene.gbuffer), expected) == "");
    CHECK(joined.count("first.vpls") == 256);
    CHECK(joined.count("second.vpls") > 0);
}

TEST_CASE("wrong parts are refused by name", "[fallback]") {
    JoinRig rig(16);
    LWFallbackDesc desc = rig.desc();
    desc.second = nullptr;
    CHECK(rig.refused(desc) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(rig.device) == "lwCreateFallback: desc.second: expected a technique, got null");
    desc.second = desc.first;
    CHECK(rig.refused(desc) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Catch::Contains("desc.second: expected another technique than desc.first"));
    TestDevice elsewhere(16);
    TestTechnique foreign(elsewhere, "rsm", nullptr);
    desc.second = foreign;
    CHECK(rig.refused(desc) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(rig.device), Catch::Contains("desc.second: expected a technique of the same device"));
    desc.second = reinterpret_cast<LWTechnique>(LWView(rig.view));
    CHECK(rig.refused(desc) == LW_ERROR_INVALID_HANDLE);
    CHECK_THAT(lastError(rig.device), Catch::Contains("desc.second"));
    CHECK(lwCreateFallback(rig.device, nullptr, nullptr) == LW_ERROR_INVALID_ARGUMENT);
    lastError(rig.device);
    LWTechnique none = nullptr;
    CHECK(lwCreateTechnique(rig.device, "fallback", nullptr, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Catch::Contains("desc.first: expected a technique, got null"));
}

TEST_CASE("a frame that only one part accepts is not rendered", "[fallback]") {
    JoinRig rig(16);
    // ssvp refuses a frame without the triangles that it is to take its maps from; rsm does not ask.
    LWSsvpDesc ssvpDesc;
    lwDefaultSsvp(&ssvpDesc);
    ssvpDesc.occluders = LW_OCCLUDERS_TRIANGLES;
    const TestTechnique demanding(rig.device, ssvpDesc);
    LWFallbackDesc desc = rig.desc();
    desc.second = demanding;
    TestTechnique joined(rig.device, "fallback", &desc);
    const LWLight light = rig.floor.light;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = 1;
    frame.lights = &light;
    CHECK(lwUpdate(joined, &frame) == LW_ERROR_INVALID_ARGUMENT);
    CHECK_THAT(lastError(rig.device), Catch::Contains("geometry"));
    PlanarPixels irradiance(kWidth, kHeight, 3);
    LWOutput output{};
    output.structSize = sizeof output;
    output.irradiance = irradiance.image();
    CHECK(lwRender(joined, rig.view, &rig.scene.gbuffer, &output) == LW_ERROR_NOT_UPDATED);
}

TEST_CASE("only irradiance and validity, and memory as estimated", "[fallback]") {
    JoinRig rig(16);
    const LWFallbackDesc desc = rig.desc();
    TestTechnique joined(rig.device, "fallback", &desc);
    const LWLight light = rig.floor.light;
    joined.update({light});
    PlanarPixels plane(kWidth, kHeight, 1);
    LWOutput output{};
    output.structSize = sizeof output;
    output.ambientOcclusion = plane.image();
    CHECK(lwRender(joined, rig.view, &rig.scene.gbuffer, &output) == LW_ERROR_UNSUPPORTED);
    CHECK_THAT(lastError(rig.device), Catch::Contains("output.ambientOcclusion"));
    joined.render(rig.view, rig.scene.gbuffer);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.lightCount = 1;
    frame.lights = &light;
    std::uint64_t whole = 0, first = 0, second = 0;
    const auto estimate = [&](const char* name, const void* of, std::uint64_t* bytes) {
        REQUIRE(lwEstimateFrameMemory(rig.device, name, of, &viewDesc, &frame, bytes) == LW_SUCCESS);
    };
    estimate("fallback", &desc, &whole);
    estimate("rsm", nullptr, &first);
    estimate("ssvp", nullptr, &second);
    // Two irradiances and two validities between, and what an output may need.
    const std::uint64_t plane4 = 48u * kHeight * 4u;
    CHECK(whole - first - second >= 8 * plane4);
    CHECK(whole - first - second <= 12 * plane4 + 64);
    CHECK(joined.stats().deviceBytes <= whole);
}

TEST_CASE("nothing is built after lwPrewarm of the joined technique", "[fallback]") {
    JoinRig rig(16);
    const LWFallbackDesc desc = rig.desc();
    TestTechnique joined(rig.device, "fallback", &desc);
    REQUIRE(lwPrewarm(joined, rig.view) == LW_SUCCESS);
    const auto before = rig.device.info().programsBuilt;
    joined.update({rig.floor.light});
    joined.render(rig.view, rig.scene.gbuffer);
    CHECK(rig.device.info().programsBuilt == before);
    // Names of both, told apart.
    std::uint32_t count = 0;
    REQUIRE(lwCountDebugViews(joined, rig.view, &count) == LW_SUCCESS);
    bool own = false, part = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        LWDebugView info{};
        info.structSize = sizeof info;
        REQUIRE(lwDescribeDebugView(joined, rig.view, i, &info) == LW_SUCCESS);
        own = own || std::strcmp(info.name, "first_validity") == 0;
        part = part || std::strcmp(info.name, "second.gathered") == 0;
    }
    CHECK(own);
    CHECK(part);
}
