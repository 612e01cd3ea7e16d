// Light along the glossy lobes of a view's pixels, by marching a light propagation volume's cells (kernels/lpv_specular).
// docs/techniques/lpv_specular.md.
#pragma once

#include <cstdint>
#include <utility>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/camera.h"
#include "passes/lpv_sweep.h"
#include "shared/lpv_specular_types.h"

namespace lightwell {

// Of a view, without a roughness image: rays' roughness is `roughness` in all pixels.
LwSpecularRays specularRays(const Camera& camera, const float* environment, float roughness);

// One grid's cells.
class LpvSpecular {
public:
    // keepsShown: what is packed is not marched before complete().
    LpvSpecular(Device& device, std::uint32_t size, bool keepsShown = false);

    // Pass "lpv_specular.pack": the cells of light that was injected for propagation (LpvGrid's), with what blocks about their corners
    // (LpvBlocking's, or null); or of a sweep's bounce, beside that of the bounces before where isAdded.
    void recordPackSteps(Executor& executor, const Buffer& injected, const Buffer& place, const Buffer* corners);
    void recordPackSweep(Executor& executor, const LpvSweepSources& from, bool isAdded);
    // What was packed is what is marched from now on; with keepsShown it was not before.
    void complete();
    // Passes "lpv_specular.halve" and ".ways": the coarser cells of that. recordMarch() calls it, so that frames that nobody
    // marches in do not pay for them; once is enough.
    void show(Executor& executor);

    // Pass "lpv_specular.march". place: LwLpvPlace of what is shown. roughness: none where the view's own is taken. counts: kCounts ints,
    // raised by the number of pixels that are neither surface nor background, of those whose light was brought down, of surfaces that
    // the grid does not have, and of surfaces that it has.
    static constexpr std::size_t kCounts = 4;
    void recordMarch(Executor& executor, const Planes& position, const Planes& normal, const Planes& roughness,
                     const LwSpecularRays& view, const Buffer& place, const Planes& radiance, const Buffer& counts);
    // Pass "lpv_specular.pick": roughness of the surfaces that JointBilateral::recordDownsample took.
    void recordPick(Executor& executor, const Planes& position, const Planes& roughness, const Planes& halfPosition,
                    const Planes& halfRoughness);

    const Buffer& cells() const { return shown_; }
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, bool keepsShown);

private:
    Buffer& packed();

    Device& device_;
    std::uint32_t size_;
    bool keepsShown_, hasFaces_ = false;
    bool isShown_ = false;  // the coarser cells are those of shown_
    Kernel &packSteps_, &packSweep_, &halve_, &ways_, &distance_, &pick_, &march_;
    Buffer packed_, shown_;  // packed_ only where it is another
    Buffer closed_, distances_[2];  // float4 of each cell that is shown: how its ways are closed, how far the next is that is not empty
};

}  // namespace lightwell
