// Path-traced truths that are kept: a picture is traced once for everything that it depends on.
//
// A truth's file is named by hashes of all of that: scene (geometry, materials, textures, lights at the
// moment), view and options. While it is noisier than asked for, the path tracer's checkpoint lies
// beside it (48 bytes per pixel, layer and half: 180 MB at 1280x720), and the next call goes on from
// there.
#pragma once

#include <functional>
#include <string>

#include "gbuffer.h"
#include "image.h"

namespace cli {

struct TruthRequest {
    int bounces = 1;        // 0: all
    double noise = 1e-3;    // relMSE to be reached
    double seconds = 0.0;   // > 0: stop after this time, whatever the noise
    std::string directory;  // "": truthCacheDirectory()
    // Called now and then; an exception ends the run, which keeps what it has.
    std::function<void(double fraction, double noise)> progress;
};

struct Truth {
    studio::Image
        image;  // irradiance in R, G, B (W/m^2); metadata `layer` and the noise, as metrics.h reads them
    int bounces = 1;     // 0: all
    double noise = 0.0;  // relMSE
    int samples = 0;     // per pixel
    std::string name;    // of the file in the cache: equal names, equal pictures but for their noise
};

// $LIGHTWELL_CACHE_DIR/references, $XDG_CACHE_HOME/lightwell/references or
// ~/.cache/lightwell/references, beside the library's own cache of programs.
std::string truthCacheDirectory();

Truth obtainTruth(const studio::RayScene& scene, const studio::GBuffer& view,
                  const TruthRequest& request);

}  // namespace cli
