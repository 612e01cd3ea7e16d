// The rival: path tracing with Embree on the host's cores, from the same G-buffer that a technique of
// the library gets. It is what a CPU user would do instead; docs/techniques/rival.md says how it is
// built, what was tried and what each choice brought.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gbuffer.h"

namespace studio {

enum class RivalResolution : std::int32_t { Full, Half, Quarter };
// How rays go to Embree.
enum class RivalRays : std::int32_t { Packets, Single };

// Plain data, so that tools can read and set it by offset.
struct RivalOptions {
    std::uint32_t bounces = 1;  // 1 or 2
    std::uint32_t spp = 1;      // paths per traced pixel
    RivalResolution resolution = RivalResolution::Full;
    std::uint32_t filter = 1;   // 1: edge-aware filter, from two paths on guided by their noise; 0: none
    std::uint32_t levels = 0;   // of the filter: each doubles its reach; 0: two or three
    std::uint32_t pattern = 0;  // n: pixels n apart share sample points; 0: no two pixels do
    RivalRays rays = RivalRays::Packets;
    // 1: paths are also joined to places that lamps shine on, found from the lamps (twice the rays).
    // Which of these places matter is judged when a scene is first seen, from that view.
    std::uint32_t connect = 0;
    std::uint32_t seed = 0;
};

struct RivalTimes {
    std::vector<std::pair<std::string, double>> passes;  // ms
    double total = 0.0;
    double processor = 0.0;  // ms of all threads together: other load lengthens it less
    std::uint64_t rays = 0, shadowRays = 0, leftOver = 0;  // leftOver: pixels traced for themselves
};

class Rival {
public:
    Rival(const RivalOptions& options, int width, int height);
    ~Rival();
    Rival(const Rival&) = delete;
    Rival& operator=(const Rival&) = delete;

    // Irradiance (W/m^2, 3 planes) of bounces 1 to `bounces` at each pixel, and 1 where there is a
    // surface. The tables of a scene are made when it is first seen and belong to no frame, like the
    // tree of its triangles. Same inputs, options and machine: same bits, whatever the threads.
    RivalTimes render(const RayScene& scene, const GBuffer& gbuffer, PlanarBuffer& irradiance,
                      PlanarBuffer& validity);
    std::uint64_t bytes() const;  // held beside the inputs

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace studio
