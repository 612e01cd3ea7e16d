// Light carried straight through a grid of cells in a fixed set of directions (kernels/lpv_sweep): discrete ordinates by plane
// sweeps. docs/techniques/lpv_sweep.md.
#pragma once

#include <cstdint>
#include <memory>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/geometry_input.h"
#include "inputs/rsm_input.h"
#include "inputs/surfel_set.h"
#include "passes/harmonics.h"
#include "passes/lpv_cascades.h"
#include "passes/lpv_rest.h"
#include "passes/world_shift.h"
#include "shared/lpv_types.h"

namespace lightwell {

class LpvSpecular;

struct LpvSweepOptions {
    std::uint32_t size = 16;         // cells a side, a multiple of 16
    std::uint32_t directions = 384;  // see sweep_directions.h
    std::uint32_t bounces = 1;       // of light that surfels send on
    std::uint32_t frames = 1;        // that a bounce's directions are spread over: divides LW_SWEEP_GROUPS
    bool hasInner = false;           // a finer grid lies in this one, which has the light of lights outside of that one as well
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
    const float* environment = nullptr;  // radiance from outside of the grid, of three colours; none: 0
    const GeometryInput* triangles = nullptr;  // block in place of the surfels, as samples on the grid's own lattice
    LpvSpecular* specular = nullptr;  // gets each bounce's light as well, and is told when that is all
    LpvRest* rest = nullptr;  // of record(), one bounce in one frame: where it finds the light to be as it was, the last result stays
};

// What surfaces send and cover in a bounce's cells, as lpv_sweep_resolve leaves it.
struct LpvSweepSources {
    const Buffer &sources, &sheets, &used;
};

class LpvSweep {
public:
    // Largest size: its sums of light take 164 MB, those of the next eight times as much.
    static constexpr std::uint32_t kLargestSize = 64;

    // sharing: another sweep of the same options, but for hasInner, that is recorded in turn with this one and owns memory of both.
    LpvSweep(Device& device, const LpvSweepOptions& options, const LpvSweep* sharing = nullptr);

    // Passes "lpv_sweep.*". Without a result to show yet, or when told to restart, all of it; else the next of options.frames parts
    // of each bounce, of the lights as they were when the first part began. The result is the same to the bit.
    void record(Executor& executor, const LpvSweepInput& input);

    // Its steps, for grids that lie in each other: what one bounce brings from grid to grid comes before the next. begin() says
    // whether all shall be done; while not done: of all grids recordStart() where isAtStart(), recordPart(), then recordEnd() once.
    bool begin(Executor& executor, bool restart);
    bool moves(const Executor& executor) const { return kept_.moves(executor); }  // places in begin(), to another origin
    bool isAtStart() const { return nextGroup_ == 0 && bounce_ == 0; }
    bool isShown() const { return isShown_; }  // there is a result
    bool isDone() const { return bounce_ == options_.bounces; }
    void recordStart(Executor& executor, const LpvSweepInput& input);
    // True once a bounce is complete. inner: place() of the grid within this one, with options.hasInner.
    bool recordPart(Executor& executor, const LpvSweepInput& input, const Buffer* inner);
    void recordEnd(Executor& executor, LpvSpecular* specular = nullptr);

    // After recordPart() has completed a bounce: its cells, those of the sum of all where they are others, and the largest that
    // arrives at a side; with options.hasInner the cells of the light of lights outside of that grid.
    const Buffer& bounceCells() const { return bounce_ == 1 ? totalCells_ : bounceCells_; }
    const Buffer* totalCells() const { return bounce_ == 1 ? nullptr : &totalCells_; }
    const Buffer& largest() const { return largest_; }
    const Buffer& outerCells() const { return outerCells_; }
    const Buffer& outerLargest() const { return outerLargest_; }
    const Buffer& place() const { return place_; }            // of the light that is under way
    const Buffer& shownPlace() const { return shownPlace_; }  // of what recordGather() reads

    // Pass "lpv_sweep.gather", of LpvRead::recordGather's outputs and counts. places: of all grids, where `layer` is one of several.
    void recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                      const Planes& validity, const Buffer& counts, const Buffer* places = nullptr, LpvLayer layer = {});

    // Pass "lpv_sweep.harmonics", as LpvRead::recordHarmonics. places, layer: as recordGather's.
    void recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                         const Planes& validity, const Buffer& counts, const Buffer* places = nullptr, LpvLayer layer = {});

    // Of the last bounce, until the next one begins.
    LpvSweepSources sources() const { return {flights_[kAll]->sources, flights_[kAll]->sheets, flights_[kAll]->used}; }
    const Buffer& parts() const { return flights_[kAll]->parts; }  // of the last sweep, see lpv_sweep_types.h
    const Buffer& outside() const { return outside_; }  // a cl_uint: lights that no cell took
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LpvSweepOptions& options, std::uint32_t grids = 1);  // each in the next one

private:
    // Lights that are carried through the grid: all, or those outside of the inner grid.
    enum Field { kAll, kOuter, kFields };
    // Of a field that is under way.
    struct Flight {
        Buffer sources, sheets, used, parts;
    };
    // Of what comes and goes within a call.
    struct Scratch {
        Buffer directions, lights, carried, sides;
    };
    const Buffer& cells() const { return options_.frames > 1 ? shownCells_ : totalCells_; }
    void reserve(Executor& executor);
    void reserve(Flight& flight) const;
    void recordLights(Executor& executor, const LpvSweepInput& input, const Buffer* inner);
    void recordCover(Executor& executor, const LpvSweepInput& input);
    void recordRelight(Executor& executor, const SurfelSet& surfels, const Buffer* inner);
    void recordResolve(Executor& executor, const Buffer& place, const Flight& flight, LpvRest* rest);
    void recordGroups(Executor& executor, const Flight& flight, const LpvRest* rest);
    void recordBounce(Executor& executor, Field field, const LpvRest* rest);

    Device& device_;
    LpvSweepOptions options_;
    Kernel &injectTexels_, &injectVpls_, &unit_, &relight_, &begin_, &clear_, &coverTexels_, &coverSurfels_, &coverTriangles_,
        &resolve_, &march_, &combine_, &pack_, &gather_, &harmonics_;
    std::shared_ptr<Scratch> scratch_;
    std::shared_ptr<Flight> flights_[kFields];
    bool ownsScratch_, ownsFlights_;
    Buffer areas_, cover_, outside_, largest_, outerLargest_;
    KeptPlaces kept_;                        // the next three
    Buffer place_, unitPlace_, shownPlace_;  // of the light that is under way, in the last bounce's unit, of what is shown
    Buffer bounceCells_, totalCells_, shownCells_, outerCells_;
    std::uint32_t step_ = 0;  // groups of directions that a call does
    std::uint32_t nextGroup_ = 0, bounce_ = 0;
    cl_float4 environment_{};  // of the light that is under way
    bool isShown_ = false, isWhole_ = false;  // isWhole_: the last record() came to its end
    bool isSameSky_ = false;                  // as the last one's
};

}  // namespace lightwell
