// Techniques that have light at points, each with parameters of its own, and a room for them to light.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "support/lpv_room.h"
#include "support/scoped_api.h"
#include "support/small_ssvp.h"

namespace lightwell::test {

// A technique with its own parameters, as tests run over all that have light at points.
struct Maker {
    const char* name;
    std::function<std::unique_ptr<TestTechnique>(LWDevice)> make;
};

inline Maker rsmOf(std::uint32_t vpls, std::uint32_t interleave, LWRsmVisibility visibility = LW_RSM_VISIBILITY_NONE) {
    return {"rsm", [=](LWDevice device) {
                LWRsmDesc desc;
                lwDefaultRsm(&desc);
                desc.vpls = vpls;
                desc.interleave = interleave;
                desc.visibility = visibility;
                desc.voxels = 32;
                return std::make_unique<TestTechnique>(device, desc);
            }};
}
inline Maker ssvpOf(LWVisibility visibility, std::uint32_t bounces, std::uint32_t shadowed = 1, std::uint32_t interleave = 1) {
    return {"ssvp", [=](LWDevice device) {
                LWSsvpDesc desc = smallSsvp(visibility, bounces, shadowed);
                desc.interleave = interleave;
                desc.voxels = 32;
                return std::make_unique<TestTechnique>(device, desc);
            }};
}
inline Maker lpvOf(LWLpvTransport transport, bool damped = false, std::uint32_t frames = 1, std::uint32_t cascades = 1) {
    return {"lpv", [=](LWDevice device) {
                LWLpvDesc desc;
                lwDefaultLpv(&desc);
                desc.size = 16;
                desc.transport = transport;
                desc.damping = damped ? 1 : 0;
                desc.frames = frames;
                desc.cascades = cascades;
                desc.geometryVolume = LW_GEOMETRY_VOLUME_AUTO;
                return std::make_unique<TestTechnique>(device, "lpv", &desc);
            }};
}
inline std::vector<Maker> makers() {
    return {rsmOf(256, 1), rsmOf(0, 1), ssvpOf(LW_VISIBILITY_HARD, 2), ssvpOf(LW_VISIBILITY_SOFT, 3, 2), ssvpOf(LW_VISIBILITY_NONE, 1), ssvpOf(LW_VISIBILITY_STRICT, 2), ssvpOf(LW_VISIBILITY_CAREFUL, 4, 2),
            rsmOf(256, 1, LW_RSM_VISIBILITY_VOXEL), ssvpOf(LW_VISIBILITY_VOXEL, 2, 2),
            lpvOf(LW_LPV_TRANSPORT_PROPAGATE), lpvOf(LW_LPV_TRANSPORT_PROPAGATE, true), lpvOf(LW_LPV_TRANSPORT_SWEEP),
            lpvOf(LW_LPV_TRANSPORT_SWEEP, false, 4), lpvOf(LW_LPV_TRANSPORT_COARSE_TO_FINE),
            lpvOf(LW_LPV_TRANSPORT_PROPAGATE, false, 1, 3), lpvOf(LW_LPV_TRANSPORT_SWEEP, false, 1, 3)};
}

// The lit room with its triangles, as one frame, and a view's pixels of it.
struct PointRoom {
    LitFloor floor;
    WallAndCeiling scene;
    RoomTriangles triangles{1.0};
    std::vector<LWLight> lights{floor.light};
    LWFrame frame{};
    template <class Profile>
    PointRoom(std::uint32_t texels, Profile profile, std::uint32_t width, std::uint32_t height) : floor(texels, profile), scene(width, height) {
        frame.structSize = sizeof frame;
        frame.lights = lights.data();
        frame.lightCount = 1;
        frame.geometry = &triangles.geometry;
    }
    PointRoom(const PointRoom&) = delete;
};

// Descriptors of small techniques: few VPLs, a coarse grid.
inline LWRsmDesc rsmDesc() {
    LWRsmDesc desc;
    lwDefaultRsm(&desc);
    desc.vpls = 64;
    desc.interleave = 1;
    return desc;
}
inline LWLpvDesc lpvDesc(LWLpvTransport transport, double extent = 0.0) {
    LWLpvDesc desc;
    lwDefaultLpv(&desc);
    desc.size = 16;
    desc.transport = transport;
    desc.extent = float(extent);
    desc.center[1] = desc.center[2] = 0.25f;
    return desc;
}

}  // namespace lightwell::test
