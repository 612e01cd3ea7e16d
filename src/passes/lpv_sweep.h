// Light carried straight through a grid of cells in a fixed set of directions (kernels/lpv_sweep): discrete ordinates by plane
// sweeps. docs/techniques/lpv_sweep.md.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/rsm_input.h"
#include "inputs/surfel_set.h"
#include "shared/lpv_types.h"

namespace lightwell {

class LpvSpecular;

struct LpvSweepOptions {
    std::uint32_t size = 16;         // cells a side, a multiple of 16
    std::uint32_t directions = 384;  // see sweep_directions.h
    std::uint32_t bounces = 1;       // of light that surfels send on
    std::uint32_t frames = 1;        // that a bounce's directions are spread over: divides LW_SWEEP_GROUPS
};

// A frame's lights, and what stands in their way.
struct LpvSweepInput {
    const RsmInput& rsms;
    const Buffer& authored;  // lw_vpl
    std::uint32_t authoredCount;
    const Buffer& place;  // LwLpvPlace
    SurfelSet surfels;    // where it has none: the RSMs' texels
    float areaScale;      // of the surfels
    bool restart;         // nothing of the frames before is right any more
    LpvSpecular* specular = nullptr;  // gets each bounce's light as well, and is told when to show it
};

// What surfaces send and cover in a bounce's cells, as lpv_sweep_resolve leaves it.
struct LpvSweepSources {
    const Buffer &sources, &sheets, &used;
};

class LpvSweep {
public:
    // Largest size: its sums of light take 164 MB, those of the next eight times as much.
    static constexpr std::uint32_t kLargestSize = 64;

    LpvSweep(Device& device, const LpvSweepOptions& options);

    // Passes "lpv_sweep.*". Without a result to show yet, or when told to restart, all of it; else the next of options.frames parts
    // of each bounce, of the lights as they were when the first part began. The result is the same to the bit.
    void record(Executor& executor, const LpvSweepInput& input);

    // Pass "lpv_sweep.gather", of LpvRead::recordGather's outputs and counts.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts);

    const Buffer& shownPlace() const { return shownPlace_; }  // LwLpvPlace of what is gathered
    const Buffer& parts() const { return parts_; }      // of the last sweep, see lpv_sweep_types.h
    const Buffer& outside() const { return outside_; }  // a cl_uint: lights that no cell took
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LpvSweepOptions& options);

private:
    void reserve(Executor& executor);
    void recordLights(Executor& executor, const LpvSweepInput& input);
    void recordCover(Executor& executor, const LpvSweepInput& input);
    void recordRelight(Executor& executor, const SurfelSet& surfels);
    void recordResolve(Executor& executor, const Buffer& place);
    void recordGroups(Executor& executor, std::uint32_t count);
    void recordBounce(Executor& executor);

    Device& device_;
    LpvSweepOptions options_;
    Kernel &injectTexels_, &injectVpls_, &unit_, &relight_, &begin_, &clear_, &coverTexels_, &coverSurfels_, &resolve_, &march_,
        &combine_, &pack_, &gather_;
    Buffer directions_, lights_, areas_, cover_, sources_, sheets_, used_, carried_, parts_, sides_, outside_, largest_;
    Buffer place_, unitPlace_, shownPlace_;  // of the light that is under way, in the last bounce's unit, of what is shown
    Buffer bounceCells_, totalCells_, shownCells_;
    std::uint32_t nextGroup_ = 0, bounce_ = 0;
    bool isShown_ = false;
};

}  // namespace lightwell
