// Light of the levels of a pyramid, filtered, up-sampled across no edge, added up, and brought to the host's image.
#pragma once

#include "compute/buffer.h"
#include "compute/executor.h"
#include "shared/screen_types.h"

namespace lightwell {

class Camera;

class ScreenCombine {
public:
    struct Options {
        std::uint32_t interleave;  // of the gather: 1 (no filter), 2 or 4
        std::uint32_t factor;      // pixels of the host's image per texel of the first level along each axis: 1, 2 or 4
        bool adds, joins, moves;   // whether recordAdd, recordJoin and (factor > 1) recordMotion will be called: what is built and never run is never cached
        bool planned = false;  // whether recordFilter will be given a plan
    };
    ScreenCombine(Device& device, const Options& options);

    // Pass "screen_combine.filter": mean over the window in which every pattern of the gather has the same weight; where the
    // patterns are `alike`, the light as it is. interleave > 1 only.
    void recordFilter(Executor& executor, const Planes& texels, bool alike, const Planes& light, const Planes& filtered);
    // The same by a plan of ScreenPlan; alike: sum of the numbers of samples of which the patterns are, and discsAlike that of the
    // level that it starts with. A level without samples has no light.
    void recordFilter(Executor& executor, const Planes& texels, std::uint32_t alike, std::uint32_t discsAlike, const Planes& light,
                      const Planes& filtered, const Buffer& plan, std::uint32_t level);
    // Pass "screen_combine.add": sum = own + up-sampled light of the next coarser level.
    void recordAdd(Executor& executor, const Planes& fine, const Planes& own, const Planes& coarse, const Planes& light,
                   const Planes& sum);
    // Pass "screen_combine.finish": a level's light at the pixels of the host's image. irradiance: 3 planes, or none;
    // validity: 1, or none. Counters LW_SCREEN_FALLBACKS and _SATURATED.
    void recordFinish(Executor& executor, const Planes& position, const Planes& normal, const Planes& texels, const Planes& light,
                      const Planes& irradiance, const Planes& validity, const Buffer& counts);
    // Pass "screen_combine.join": raises the outputs to what another camera's first level (`texels`: all planes of the
    // senders) has for the same surfaces. `camera`: of its base image.
    void recordJoin(Executor& executor, const Planes& position, const Planes& normal, const Planes& texels, const Camera& camera,
                    const Planes& light, const Planes& irradiance, const Planes& validity);

    // Pass "screen_combine.motion": motion vectors of the host's image at the texels of its first level, in texels. factor > 1 only.
    void recordMotion(Executor& executor, const Planes& position, const Planes& motion, const Planes& texels, const Planes& moved);

private:
    std::uint32_t factor_;
    Kernel& finish_;
    Kernel *filter_ = nullptr, *add_ = nullptr, *join_ = nullptr, *motion_ = nullptr;
};

}  // namespace lightwell
