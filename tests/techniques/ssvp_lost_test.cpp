// Technique ssvp after a frame whose commands failed on the device.
#include <catch2/catch.hpp>
#include <vector>

#include "api/api_rig.h"
#include "support/walls.h"

using namespace lightwell::test;

namespace {

std::vector<double> pixelsOf(const HostImage& image) {
    std::vector<double> all;
    for (std::uint32_t y = 0; y < image.height(); ++y)
        for (std::uint32_t x = 0; x < image.width(); ++x)
            for (int c = 0; c < 3; ++c) all.push_back(image.value(x, y, c));
    return all;
}

}  // namespace

TEST_CASE("what a failed frame did not bring, the next one does", "[ssvp][stages]") {
    ApiScene scene;
    AdoptedRig rig(scene);
    LWSsvpDesc desc;
    lwDefaultSsvp(&desc);
    desc.mapSize = 64;
    Walls room = Walls::room();
    scene.frame.geometry = GENERATE(false, true) ? room.describeSurfels(0.05) : room.describe();
    LWTechnique failed = nullptr, fresh = nullptr;
    REQUIRE(lwCreateSsvp(rig.device, &desc, &failed) == LW_SUCCESS);
    REQUIRE(lwCreateSsvp(rig.device, &desc, &fresh) == LW_SUCCESS);
    Gate gate(rig.host);
    scene.frame.sync = gate.sync();
    REQUIRE(lwUpdate(failed, &scene.frame) == LW_SUCCESS);
    gate.open(-7777);
    REQUIRE(lwFinish(rig.device) == LW_ERROR_DEVICE);
    scene.frame.sync = nullptr;
    std::vector<std::vector<double>> pictures;
    for (const LWTechnique technique : {failed, fresh}) {
        REQUIRE(lwUpdate(technique, &scene.frame) == LW_SUCCESS);
        REQUIRE(lwRender(technique, rig.view, &scene.gbuffer, &scene.output) == LW_SUCCESS);
        REQUIRE(lwFinish(rig.device) == LW_SUCCESS);
        pictures.push_back(pixelsOf(scene.irradiance));
        CHECK(lwReleaseTechnique(technique) == LW_SUCCESS);
    }
    CHECK(pictures[0] == pictures[1]);
    CHECK(scene.lit());
}
