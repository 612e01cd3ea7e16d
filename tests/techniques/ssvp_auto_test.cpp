// Technique ssvp with an error target: what it leaves out, what that does to the picture, what it says
// of it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

#include "support/choices.h"
#include "support/lit_room.h"
#include "support/scoped_api.h"
#include "support/walls.h"

using namespace lightwell::test;
using lightwell::reference::Vec;

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 64;
constexpr int kSettled = 12;  // frames

LWSsvpDesc descOf(float error) {
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.clusters = 32;
    desc.bounces = 4;
    desc.mapSize = 64;
    desc.autoError = error;
    return desc;
}

// A room of one albedo whose floor is lit, or a part of it.
struct Lit {
    explicit Lit(double albedo, double reach = 1.0)
        : floor(64, [reach](double x,
                            double z) { return std::abs(x) < 0.5 * reach && z < reach ? 0.6 : 0.0; }),
          colours(room.vertices.size() / 3, float(albedo)),
          lights{floor.light} {
        room.geometry.triangleAlbedo = colours.data();
        frame.structSize = sizeof frame;
        frame.lightCount = 1;
        frame.lights = lights.data();
        frame.geometry = room.describe();
    }
    LitFloor floor;
    Walls room = Walls::room();
    std::vector<float> colours;
    std::vector<LWLight> lights;
    WallAndCeiling scene{kWidth, kHeight};
    LWFrame frame{};
};

std::vector<float> settled(TestTechnique& technique, TestView& view, Lit& lit) {
    for (int i = 1; i < kSettled; ++i) technique.update(lit.frame);
    technique.update(lit.frame);
    return technique.render(view, lit.scene.gbuffer);
}

double nrmse(const std::vector<float>& a, const std::vector<float>& b) {
    double square = 0.0, mean = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        square += std::pow(double(a[i]) - double(b[i]), 2.0);
        mean += double(b[i]);
    }
    return std::sqrt(square * double(a.size())) / mean;
}

}  // namespace

TEST_CASE("without an error target nothing is chosen", "[ssvp_auto]") {
    TestDevice device(16);
    Lit lit(0.5);
    TestView view(device, kWidth, kHeight);
    TestTechnique technique(device, descOf(0.0f));
    settled(technique, view, lit);
    CHECK(reasonOf(technique, "vpls_used").empty());
    CHECK(reasonOf(technique, "bounces_used").empty());
}

TEST_CASE("between black walls one bounce is used, and the picture is that of one", "[ssvp_auto]") {
    TestDevice device(GENERATE(1u, 16u));
    Lit lit(0.0);
    TestView view(device, kWidth, kHeight);
    LWSsvpDesc desc = descOf(0.01f), one = desc;
    one.bounces = 1;
    TestTechnique technique(device, desc), single(device, one);
    const auto picture = settled(technique, view, lit);
    CHECK(technique.count("bounces_used") == 1);
    CHECK(reasonOf(technique, "bounces_used").find("less than the error target") != std::string::npos);
    CHECK(nrmse(picture, settled(single, view, lit)) < 1e-5);
}

TEST_CASE("the picture is within about the target of that with the most of everything", "[ssvp_auto]") {
    TestDevice device(16);
    const double albedo = GENERATE(0.2, 0.5, 0.8), reach = GENERATE(0.2, 1.0);
    Lit lit(albedo, reach);
    TestView view(device, kWidth, kHeight);
    TestTechnique all(device, descOf(0.0f));
    const auto full = settled(all, view, lit);
    std::uint64_t vpls = 256, clusters = 32, bounces = 4;
    for (const float error : {0.05f, 0.1f, 0.2f, 0.4f}) {
        TestTechnique technique(device, descOf(error));
        technique.update(lit.frame);
        CHECK(technique.count("vpls_used") == 256);  // a first frame takes the most
        CHECK(technique.count("bounces_used") == 4);
        const auto picture = settled(technique, view, lit);
        const std::uint64_t now[] = {technique.count("vpls_used"), technique.count("clusters_used"),
                                     technique.count("bounces_used")};
        CAPTURE(albedo, reach, error, now[0], now[1], now[2]);
        const double off = nrmse(picture, full);
        CHECK(off < 1.5 * double(error));
        CHECK(now[0] <= vpls);
        CHECK(now[1] <= clusters);
        CHECK(now[2] <= bounces);
        vpls = now[0];
        clusters = now[1];
        bounces = now[2];
        for (int i = 0; i < 3; ++i) {
            technique.update(lit.frame);
            CHECK(technique.render(view, lit.scene.gbuffer) == picture);  // at rest: the same bits
        }
    }
    CHECK(clusters < 32);
}

TEST_CASE("light that grows slowly changes the counts rarely", "[ssvp_auto]") {
    TestDevice device(16);
    TestTechnique technique(device, descOf(0.3f));
    std::uint64_t last[3] = {0, 0, 0};
    int changes[3] = {0, 0, 0};
    for (int i = 0; i < 60; ++i) {
        Lit lit(0.5, 0.1 + 0.9 * std::max(0, i - 10) / 50.0);
        technique.update(lit.frame);
        const std::uint64_t now[] = {technique.count("vpls_used"), technique.count("clusters_used"),
                                     technique.count("bounces_used")};
        for (int k = 0; k < 3; ++k) {
            if (i > 10) changes[k] += now[k] != last[k];
            last[k] = now[k];
        }
    }
    CAPTURE(changes[0], changes[1], changes[2]);
    CHECK(changes[0] <= 3);
    CHECK(changes[1] <= 6);
    CHECK(changes[2] <= 1);
}

TEST_CASE("an error target takes no more memory than estimated, and compiles nothing late",
          "[ssvp_auto]") {
    TestDevice device(16);
    Lit lit(0.5);
    TestView view(device, kWidth, kHeight);
    LWSsvpDesc desc = descOf(0.1f);
    desc.shadowedBounces = 2;
    TestTechnique technique(device, desc);
    REQUIRE(lwPrewarm(technique, view) == LW_SUCCESS);
    const LWDeviceInfo before = device.info();
    settled(technique, view, lit);
    CHECK(device.info().programsBuilt == before.programsBuilt);
    CHECK(device.info().kernelsSpecialised == before.kernelsSpecialised);
    LWViewDesc viewDesc{};
    viewDesc.structSize = sizeof viewDesc;
    viewDesc.maxWidth = kWidth;
    viewDesc.maxHeight = kHeight;
    std::uint64_t estimate = 0;
    REQUIRE(lwEstimateFrameMemory(device, "ssvp", &desc, &viewDesc, &lit.frame, &estimate) ==
            LW_SUCCESS);
    CHECK(technique.stats().deviceBytes <= estimate);
    desc.autoError = -1.0f;
    LWTechnique none = nullptr;
    CHECK(lwCreateSsvp(device, &desc, &none) == LW_ERROR_INVALID_ARGUMENT);
    CHECK(lastError(device).find("auto_error") != std::string::npos);
    desc.autoError = 0.1f;
    desc.sampling = LW_SAMPLING_UNIFORM;
    desc.clusters = 0;
    TestTechnique fixed(device, desc);
    settled(fixed, view, lit);
    CHECK(reasonOf(fixed, "vpls_used").find("drawn by flux") != std::string::npos);
    CHECK(reasonOf(fixed, "clusters_used").find("warm_start") != std::string::npos);
}
