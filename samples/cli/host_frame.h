// What another program wrote as EXR, as Lightwell takes it: a view's G-buffer, lamps and their reflective shadow maps.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gbuffer.h"
#include "host_camera.h"
#include "host_channels.h"
#include "host_light.h"
#include "lightwell/lightwell.h"

namespace cli {

// One picture of surfaces. A pixel whose normal is zero, or whose place or normal is not finite, or whose depth is 0, not finite or beyond
// 1e9, is background, and zero everywhere.
struct HostSurfaces {
    int width = 0, height = 0;
    studio::PlanarBuffer position, normal, albedo, direct;  // 3 planes; world; normals unit; direct: L_d, W/(sr m^2)
    bool hasAlbedo = false, hasDirect = false;
    bool hasOwnNormals = true;     // else made of the places (host_normals.h); then a place of exactly zero is background, too
    bool hasHalfPlaces = false;    // position or depth were half floats
    double farthest = 1.0;         // along the camera's axis
    std::uint64_t background = 0;  // pixels
    std::uint64_t spoiled = 0;     // of these, pixels that show a surface, but whose albedo or direct radiance is not finite or negative
    std::uint64_t lonely = 0;      // of these, surfaces that no normal could be made for
    std::uint64_t away = 0;        // surfaces whose normal points away from the camera (with `twoSided`: that were turned about)
    std::uint64_t mixed = 0;       // surfaces whose normal was shorter than 0.99: averaged over several
};

// `twoSided`: normals that point away from the camera are turned about. Needs position or depth; albedo where `needsAlbedo`; takes normals
// (makes them where it has none) and direct radiance where the file has them. UsageError naming the file and what it has.
HostSurfaces readSurfaces(const std::string& path, const HostCamera& camera, const ChannelMap& channels, bool twoSided, bool needsAlbedo);

// A texel's reflected flux, W (docs/conventions.md), three planes: albedo times what the lamp sends through the texel; or, with
// HostLight::fluxFromDirect, pi times the direct radiance times the texel's surface. None from surfaces whose normal points away from the lamp.
studio::PlanarBuffer texelFlux(const HostSurfaces& map, const HostLight& light, const HostCamera& camera);

// The structs point into the buffers beside them: made once, never moved.
class HostFrame {
public:
    HostFrame(HostSurfaces view, const HostCamera& camera);
    HostFrame(const HostFrame&) = delete;
    HostFrame& operator=(const HostFrame&) = delete;

    // `maps`: of the lamp's cameras, in their order.
    void addLight(HostLight light, std::vector<HostSurfaces> maps);

    const HostSurfaces& view() const { return view_; }
    const std::vector<HostSurfaces>& maps(std::size_t light) const { return lamps_.at(light)->maps; }
    const LWGBuffer& gbuffer() const { return gbuffer_; }
    const std::vector<LWLight>& lights() const { return lights_; }
    const float* eye() const { return eye_; }
    std::uint64_t texelCount() const;

private:
    struct Lamp {
        HostLight light;
        std::vector<HostSurfaces> maps;
        std::vector<studio::PlanarBuffer> flux;
        std::vector<LWRsm> rsms;
    };
    HostSurfaces view_;
    LWGBuffer gbuffer_{};
    std::vector<std::unique_ptr<Lamp>> lamps_;
    std::vector<LWLight> lights_;
    float eye_[3] = {};
};

}  // namespace cli
