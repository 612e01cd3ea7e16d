// A driver that fails at any call of technique lpv's frames: it is told, and the next frames are right.
#include <catch2/catch.hpp>

#include "api/failing_frames.h"

using namespace lightwell::test;

namespace {

struct Whole : FloorAndSlope {
    Whole() {
        vpl.position[1] = 0.2f;
        vpl.normal[1] = 1;
        vpl.flux[0] = 0.1f;
        frame.vpls = &vpl;
        frame.vplCount = 1;
    }
    LWVpl vpl{};
};

}  // namespace

TEST_CASE("whichever OpenCL call of an lpv frame fails, it is told, and the next frames are right", "[faults][lpv]") {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.steps = 4;
    desc.directions = 24;
    const std::uint32_t frames = GENERATE(0u, 1u, 4u);
    desc.transport = frames ? LW_LPV_TRANSPORT_SWEEP : LW_LPV_TRANSPORT_PROPAGATE;
    desc.frames = frames ? frames : 1;
    desc.bounces = 2;
    desc.extent = 3.0f;
    Whole scene, before;
    faceDown(scene);
    before.geometry.triangleCount = 1;
    before.geometry.vertexCount = 3;
    scene.geometry.version = 1;
    scene.frame.reset = frames > 1 ? 1 : 0;  // or the picture is the last one's
    CAPTURE(frames);
    checkFailingFrames(
        {[&](LWDevice device, LWTechnique* technique) { return lwCreateLpv(device, &desc, technique); },
         5,
         {}},
        before, scene);
}
