// Path-traced truths that are kept: a view is traced once for everything that its truths depend on.
//
// One run of the path tracer makes the truths of all bounce counts that are asked for together. Their
// file is named by hashes of scene (geometry, materials, textures, lights at the moment) and view, and
// by how far paths go. While a truth is noisier than asked for, the path tracer's checkpoint lies beside
// the file (192 bytes per pixel: 180 MB at 1280x720), and the next call goes on from there. A lock
// beside them lets one process at a time trace a view; others wait for it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "gbuffer.h"
#include "image.h"
#include "seen_surfaces.h"

namespace cli {

struct TruthRequest {
    std::vector<int> bounces{1};  // counts of bounces; 0: all
    // Only surfaces that these pictures show send light (path_tracer.h); one bounce alone. Empty: all
    // do.
    std::vector<studio::PictureView> sendersSeenBy;
    double noise = 1e-3;          // relMSE to be reached by each
    double seconds = 0.0;         // > 0: stop after this time, whatever the noise
    bool takesKept = false;       // what is kept will do, whatever its noise
    std::string directory;        // "": truthCacheDirectory()
    // Called now and then; an exception ends the run, which keeps what it has. noise < 0: not known yet.
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

// One truth for each of request.bounces, in their order.
std::vector<Truth> obtainTruths(const studio::RayScene& scene, const studio::GBuffer& view,
                                const TruthRequest& request);

}  // namespace cli
