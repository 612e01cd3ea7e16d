// Techniques from text: the same light as from a descriptor, parts made on the way, and every word that is not valid named.
#include <catch2/catch.hpp>
#include <string>

#include "api/api_rig.h"
#include "lightwell/lightwell.hpp"

using namespace lightwell::test;
using Catch::Matchers::Contains;

namespace {

struct TextRig {
    TextRig() { REQUIRE(device); }
    ~TextRig() { lwReleaseDevice(device); }
    std::string refuse(const char* name, const char* settings) {
        LWTechnique technique = reinterpret_cast<LWTechnique>(1);
        CHECK(lwCreateTechniqueFromText(device, name, settings, &technique) == LW_ERROR_INVALID_ARGUMENT);
        CHECK(technique == nullptr);
        return lastError(device);
    }
    LWDevice device = makeDevice(16);
};

std::vector<float> lightOf(ApiScene& scene, LWDevice device, LWTechnique technique) {
    const LWViewDesc desc = scene.viewDesc();
    LWView view = nullptr;
    REQUIRE(lwCreateView(device, &desc, &view) == LW_SUCCESS);
    CHECK(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
    CHECK(lwRender(technique, view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
    CHECK(lwFinish(device) == LW_SUCCESS);
    CHECK(lastError(device) == "");
    lwReleaseView(view);
    std::vector<float> light;
    for (std::uint32_t y = 0; y < scene.irradiance.height(); ++y)
        for (std::uint32_t x = 0; x < scene.irradiance.width(); ++x)
            for (std::uint32_t c = 0; c < 3; ++c) light.push_back(scene.irradiance.get<float>(x, y, 0, int(4 * c)));
    return light;
}

}  // namespace

TEST_CASE("a technique from text is the one that its descriptor makes", "[api]") {
    TextRig rig;
    ApiScene scene;
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = 77;
    desc.sampling = LW_SAMPLING_UNIFORM;
    desc.filter = 0;
    desc.historyClamp = 0.25f;
    LWTechnique described = nullptr, worded = nullptr, plain = nullptr, defaults = nullptr;
    REQUIRE(lwCreateRsm(rig.device, &desc, &described) == LW_SUCCESS);
    REQUIRE(lwCreateTechniqueFromText(rig.device, "rsm", "  vpls=3 vpls=77\tsampling=uniform\n filter=off history_clamp=2.5e-1 ", &worded) == LW_SUCCESS);
    REQUIRE(lwCreateTechniqueFromText(rig.device, "rsm", nullptr, &plain) == LW_SUCCESS);
    REQUIRE(lwCreateTechnique(rig.device, "rsm", nullptr, &defaults) == LW_SUCCESS);
    const auto ofDescriptor = lightOf(scene, rig.device, described), ofDefaults = lightOf(scene, rig.device, defaults);
    CHECK(lightOf(scene, rig.device, worded) == ofDescriptor);
    CHECK(lightOf(scene, rig.device, plain) == ofDefaults);
    CHECK(ofDescriptor != ofDefaults);
    for (LWTechnique technique : {described, worded, plain, defaults}) lwReleaseTechnique(technique);
}

TEST_CASE("a technique of techniques is made with its parts", "[api]") {
    TextRig rig;
    ApiScene scene;
    LWTechnique joined = nullptr;
    REQUIRE(lwCreateTechniqueFromText(rig.device, "fallback", "first=rsm first.vpls=16 second=rsm second.vpls=64", &joined) == LW_SUCCESS);
    // rsm vouches for nothing but what it lights: the sum is the joined technique's own.
    CHECK(lightOf(scene, rig.device, joined).size() == 24 * 10 * 3);
    LWStats stats{};
    stats.structSize = sizeof stats;
    REQUIRE(lwGetStats(joined, &stats) == LW_SUCCESS);
    std::uint64_t first = 0, second = 0;
    for (std::uint32_t i = 0; i < stats.countCount; ++i) {
        if (std::string(stats.counts[i].name) == "first.vpls") first = stats.counts[i].value;
        if (std::string(stats.counts[i].name) == "second.vpls") second = stats.counts[i].value;
    }
    CHECK(first == 16);
    CHECK(second == 64);
    lwReleaseTechnique(joined);
}

TEST_CASE("lightwell.hpp makes techniques from text", "[api]") {
    auto desc = lightwell::Device::defaults();
    desc.width = 16;
    lightwell::Device device(desc);
    CHECK(lightwell::Technique::fromText(device, "rsm", "vpls=16").get() != nullptr);
    CHECK_THROWS_WITH(lightwell::Technique::fromText(device, "rsm", "vpls=many"), Contains("vpls") && Contains("many"));
}

TEST_CASE("text that makes no technique is refused by the word that is wrong", "[api]") {
    TextRig rig;
    CHECK_THAT(rig.refuse("fog", ""), Contains("lwCreateTechniqueFromText") && Contains("fog") && Contains("ssvp"));
    CHECK_THAT(rig.refuse(nullptr, ""), Contains("name") && Contains("null"));
    CHECK_THAT(rig.refuse("rsm", "vpls"), Contains("key=value") && Contains("\"vpls\""));
    CHECK_THAT(rig.refuse("rsm", "=3"), Contains("key=value"));
    CHECK_THAT(rig.refuse("rsm", "vpl=3"), Contains("vpls") && Contains("\"vpl\"") && Contains("\"rsm\""));
    CHECK_THAT(rig.refuse("rsm", "vpls=-1"), Contains("vpls") && Contains("whole number") && Contains("-1"));
    CHECK_THAT(rig.refuse("rsm", "vpls=1.5"), Contains("1.5"));
    CHECK_THAT(rig.refuse("rsm", "vpls=99999999999999999999999"), Contains("999"));
    CHECK_THAT(rig.refuse("rsm", "vpls="), Contains("vpls"));
    CHECK_THAT(rig.refuse("rsm", "interleave=3"), Contains("interleave") && Contains("1, 2, 4, 8") && Contains("\"3\""));
    CHECK_THAT(rig.refuse("rsm", "sampling=1"), Contains("flux, uniform"));
    CHECK_THAT(rig.refuse("rsm", "filter=yes"), Contains("on, off"));
    CHECK_THAT(rig.refuse("rsm", "history_clamp=nan"), Contains("history_clamp") && Contains("nan"));
    CHECK_THAT(rig.refuse("rsm", "vpls.a=1"), Contains("vpls.a"));
    CHECK_THAT(rig.refuse("fallback", "first=fallback"), Contains("first") && Contains("horizon"));
    CHECK_THAT(rig.refuse("fallback", "second.vpls=3 second=rsm"), Contains("second=rsm") && Contains("before"));
    CHECK_THAT(rig.refuse("fallback", "third=rsm"), Contains("third") && Contains("first.KEY"));
    CHECK_THAT(rig.refuse("fallback", "second.vpl=3"), Contains("\"ssvp\"") && Contains("\"vpl\""));
    CHECK_THAT(rig.refuse("rsm", ("vpls=" + std::string(100000, '7')).c_str()), Contains("..."));
    CHECK(lwCreateTechniqueFromText(rig.device, "rsm", "", nullptr) == LW_ERROR_INVALID_ARGUMENT);
    LWTechnique technique = nullptr;
    CHECK(lwCreateTechniqueFromText(nullptr, "rsm", "", &technique) == LW_ERROR_INVALID_HANDLE);
}
