// The truth: indirect diffuse irradiance at each G-buffer pixel by path tracing.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gbuffer.h"
#include "image.h"

namespace studio {

// A virtual point light written by `lightwell render --vpls-out`.
struct VplRecord {
    glm::vec3 position, normal, flux;
    float area = 0.0f;
};
std::vector<VplRecord> readVpls(const std::string& path);
void writeVpls(const std::string& path, const std::vector<VplRecord>& vpls);

struct PathTracerOptions {
    int samplesPerPixel = 64;        // of both halves together; even
    double untilRelMse = 0.0;        // > 0: go on past samplesPerPixel's first pass until the halves agree
    int maxSamplesPerPixel = 1 << 16;
    std::uint64_t seed = 1;
    int maxBounces = 64;             // of the "all" layer, with unbiased Russian roulette
    // Every surface along the ray sends light, none blocks: the limit of a gather without visibility.
    bool unshadowed = false;
    const std::vector<VplRecord>* vpls = nullptr;  // exact visibility of each (pixel, VPL), bounded term
    std::string checkpoint;          // file to resume from and to save to; "" = none
    std::function<void(double fraction, double relMse)> progress;
};

// Layers (irradiance, W/m^2, at the pixel's surface): "direct" from lights straight to the pixel,
// "bounce1" (one indirect bounce), "bounce2" (the second alone), "all" (every bounce from the first
// on), each with .R .G .B; the same of either half as "a.bounce1.R", "b.bounce1.R" ...; plus "direct"
// radiance etc. is the caller's business. Metadata: spp, seed, noise.<layer> = estimated relMSE of the
// mean of the halves. Same seed, same bits, whatever the number of threads; an interrupted and
// resumed run equals an uninterrupted one.
Image tracePaths(const RayScene& scene, const GBuffer& gbuffer, const PathTracerOptions& options);

}  // namespace studio
