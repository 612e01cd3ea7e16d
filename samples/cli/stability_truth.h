// The truth of one frame of a sequence, kept by content like all truths (reference_cache.h).
//
// Two references of one half of the samples each, from independent sample points; the truth is their
// mean. Judging the first by the second gives the floors: what an index reads when there is nothing but
// noise. Each has sqrt(2) of the mean's noise, and both have it, so the floor is twice what the truth's
// noise alone brings into a technique's figures: a bound from above.
//
// Sample points are the same for all pixels and frames (PathTracerOptions::commonPoints, guide) unless
// the sequence wants each pixel's own, and so is their number, so that a surface on which nothing
// changes has the same truth wherever it is seen.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gbuffer.h"
#include "lit_points.h"

namespace cli {

struct FrameTruth {
    std::vector<float> mean, first, second;  // planes R,G,B of irradiance, W/m^2
    double noise = 0.0;                      // relMSE of the mean
    int samples = 0;                         // per pixel, of both together
    std::string name;                        // of the file in the cache; "dark": known without tracing
};

class SequenceTruths {
public:
    explicit SequenceTruths(const std::string& directory);  // "": truthCacheDirectory()

    struct Request {
        int bounces = 1;  // 0: all
        // Of two bounces: the paths' first alone is a truth of one, the same to the bit as if it were
        // traced alone; it is kept too.
        bool keepsFirstBounce = false;
        int samples = 64;
        const studio::LitPoints* guide = nullptr;  // one for the whole sequence
        bool sharesPoints = true;                  // FailureSequence::truthSharesPoints
        // Called now and then; an exception ends the frame's trace, of which nothing is kept.
        std::function<void(double fraction)> progress;
    };
    std::shared_ptr<const FrameTruth> obtain(const studio::RayScene& scene, const studio::GBuffer& view,
                                             const Request& request);
    std::size_t tracedCount() const { return traced_; }  // of all that were not in the cache

private:
    std::string directory_;
    std::map<std::string, std::shared_ptr<const FrameTruth>> recent_;  // of one sequence at most
    std::size_t traced_ = 0;
};

// Exactly no light, of as many pixels.
std::shared_ptr<const FrameTruth> darkTruth(int width, int height);

}  // namespace cli
