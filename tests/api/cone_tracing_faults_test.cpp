// A driver that fails at any call of technique cone_tracing's frames: it is told, and the next frames
// are right.
#include <catch2/catch.hpp>

#include "api/failing_frames.h"

using namespace lightwell::test;

TEST_CASE("whichever OpenCL call of a cone_tracing frame fails, it is told, and the next frames are right", "[faults][cone_tracing]") {
    LWConeTracingDesc desc;
    lwDefaultConeTracing(&desc);
    desc.size = 32;
    desc.extent = 3.0f;
    desc.resolution = GENERATE(LW_CONE_RESOLUTION_HALF, LW_CONE_RESOLUTION_INTERLEAVED);
    desc.bounces = desc.resolution == LW_CONE_RESOLUTION_HALF ? 1 : 0;
    FloorAndSlope scene, before;
    faceDown(scene);
    before.geometry.triangleCount = 1;
    before.geometry.vertexCount = 3;
    scene.geometry.version = 1;
    scene.frame.reset = 1;  // further bounces begin with it
    CAPTURE(desc.resolution);
    checkFailingFrames({[&](LWDevice device, LWTechnique* technique) {
                            return lwCreateConeTracing(device, &desc, technique);
                        },
                        29,
                        {}},
                       before, scene);
}
