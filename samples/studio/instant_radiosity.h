// Instant radiosity (A. Keller 1997): photons traced from the lights by Embree become virtual point lights,
// which light the picture with or without shadows. What technique static_vpl is compared with;
// docs/techniques/instant_radiosity.md.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gbuffer.h"
#include "path_tracer.h"

namespace studio {

// Plain data, so that tools can read and set it by offset.
struct InstantRadiosityOptions {
    std::uint32_t vpls = 200;   // photons of each light
    std::uint32_t shadows = 0;  // 1: a shadow ray for each pair of pixel and VPL
    std::uint32_t seed =
        0;  // turns the pattern of directions; 0: a single photon goes along the light's axis
};

struct InstantRadiosityTimes {
    std::vector<std::pair<std::string, double>> passes;  // ms
    double total = 0.0;
    double processor = 0.0;  // ms of all threads together
    std::uint64_t photons = 0, shadowRays = 0;
};

// First-bounce VPLs of all punctual lights of the scene, `perLight` photons each, in directions that are the
// same in every frame. A photon that leaves the scene, or lies outside the light's cone, makes none.
std::vector<VplRecord> tracePhotons(const RayScene& scene, std::uint32_t perLight, std::uint32_t seed);

class InstantRadiosity {
public:
    explicit InstantRadiosity(const InstantRadiosityOptions& options);
    ~InstantRadiosity();
    InstantRadiosity(const InstantRadiosity&) = delete;
    InstantRadiosity& operator=(const InstantRadiosity&) = delete;

    // Irradiance (W/m^2, 3 planes) at each pixel, and 1 where there is a surface. Same inputs and options:
    // same bits, whatever the threads.
    InstantRadiosityTimes render(const RayScene& scene, const GBuffer& gbuffer, PlanarBuffer& irradiance,
                                 PlanarBuffer& validity);
    const std::vector<VplRecord>& vpls() const;  // of the last picture
    std::uint64_t bytes() const;                 // held beside the inputs

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace studio
