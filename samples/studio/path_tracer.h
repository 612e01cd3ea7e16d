// The truth: indirect diffuse irradiance at each G-buffer pixel by path tracing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "gbuffer.h"
#include "image.h"
#include "seen_surfaces.h"

namespace studio {

class LitPoints;

// A virtual point light written by `lightwell render --vpls-out`.
struct VplRecord {
    glm::vec3 position, normal, flux;
    float area = 0.0f;
};
// Text: a line "lightwell-vpls 1 COUNT", then for each VPL a line of ten numbers: position (m), unit
// normal, flux (W, RGB), area (m^2), with digits enough to give back every float exactly. Errors:
// std::runtime_error naming the path, the line, what was expected and what came.
std::vector<VplRecord> readVpls(const std::string& path);
void writeVpls(const std::string& path, const std::vector<VplRecord>& vpls);

// A checkpoint that cannot be gone on from: another kind of file, damaged, or of another run.
struct CheckpointError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct AmbientOptions {
    double radius = 0.2;     // what counts lies nearer, in heights of the picture at the pixel's depth
    bool isUniform = false;  // all directions alike; else by their cosine
};

struct SpecularOptions {
    double roughness = 0.5;  // of all pixels, 0 .. 1
};

struct PathTracerOptions {
    int samplesPerPixel = 64;  // of both halves together; even
    double untilRelMse = 0.0;  // > 0: go on past samplesPerPixel until the halves agree
    // The relMSE of the sum of these layers is what untilRelMse and progress speak of; empty: "all", or
    // "bounce1" where that is the only layer.
    std::vector<std::string> judgedLayers;
    int maxSamplesPerPixel = 1 << 16;
    std::uint64_t seed = 1;
    int maxBounces = 64;  // of the "all" layer, with unbiased Russian roulette
    // All pixels of a half take the same sample points. A surface at rest then keeps its noise from frame
    // to frame of a sequence, wherever the camera sees it, so that frames differ by what changes; within
    // one picture the noise is no longer independent from pixel to pixel.
    bool commonPoints = false;
    // Which of the light matters; null: judged by the view that is traced. One guide for all frames of a
    // sequence keeps their sample points alike (makeGuide).
    const LitPoints* guide = nullptr;
    // Every surface along the ray sends light, none blocks: the limit of a gather without visibility.
    // Light falls on those surfaces with its shadows. Only "bounce1" is made.
    bool unshadowed = false;
    // Only surfaces that these pictures show send light (see SeenSurfaces): what a technique of the
    // picture can know at best. Empty: all surfaces do. Only "bounce1" is made; goes with `unshadowed`.
    std::vector<PictureView> sendersSeenBy;
    // Not irradiance: "ambient" is the share of the hemisphere that is open, in each channel.
    const AmbientOptions* ambient = nullptr;
    // Not irradiance: "specular" is the radiance that arrives along the pixel's GGX lobe
    // (traceSpecular).
    const SpecularOptions* specular = nullptr;
    // Irradiance from these VPLs (bounded term) with exact visibility of each (pixel, VPL); with
    // `unshadowed`, the same without shadow rays. Only "bounce1" is made, without halves: no noise.
    const std::vector<VplRecord>* vpls = nullptr;
    std::string checkpoint;           // file to resume from and to save to; "" = none; kept at the end
    double checkpointSeconds = 30.0;  // least time between two savings
    int threads = 0;                  // 0: one per hardware thread
    // Called by the calling thread; relMse < 0: not estimated yet. An exception thrown here ends the
    // run with its current pass and comes out of tracePaths; all samples so far are in the checkpoint.
    std::function<void(double fraction, double relMse)> progress;
};

// For PathTracerOptions::guide. `scene` must live as long.
std::unique_ptr<LitPoints> makeGuide(const RayScene& scene, const GBuffer& view);

// Layers (irradiance, W/m^2, at the pixel's surface): "direct" from lights straight to the pixel,
// "bounce1" (one indirect bounce), "bounce2" (the second alone), "all" (every bounce from the first
// on), each with .R .G .B; the same of either half as "a.bounce1.R", "b.bounce1.R" ...; "validity" is 1
// where there is a surface and 0, like every layer there, where there is none. The surfaces' radiance
// etc. is the caller's business. Sky and emissive surfaces are light sources (bounce 0) like punctual
// lights. Metadata: spp, seed, noise.<layer> = estimated relMSE of the mean of the halves; vpls = their
// number. Same seed, same bits, whatever the number of threads; an interrupted and resumed run equals an
// uninterrupted one. A checkpoint with more samples than asked for gives them all.
// Errors: std::invalid_argument naming the option, std::runtime_error for files.
Image tracePaths(const RayScene& scene, const GBuffer& gbuffer, const PathTracerOptions& options);

// Estimated relMSE of the sum of `layers` of an image with halves A and B, whose mean R is the result:
// mean of (A-B)^2/4 / (R^2 + 0.01 mean(R)^2) over channels and valid pixels. 0 without light.
double estimateNoise(const Image& image, const std::vector<std::string>& layers);

}  // namespace studio
