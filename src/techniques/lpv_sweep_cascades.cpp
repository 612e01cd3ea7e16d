#include "techniques/lpv_sweep_cascades.h"

#include "compute/device.h"
#include "techniques/lpv_sweep_volume.h"

namespace lightwell {

LpvSweepCascades::LpvSweepCascades(Device& device, const LWLpvDesc& desc, int hidden)
    : device_(device), desc_(desc), surfaces_(device, desc, hidden), places_(device, desc), cascades_(device, desc.size) {
    LpvSweepOptions options = LpvSweepVolume::optionsOf(desc);
    for (std::uint32_t c = 0; c < desc.cascades; ++c) {
        options.hasInner = c > 0;
        sweeps_.push_back(std::make_unique<LpvSweep>(device, options, c > 0 ? sweeps_[0].get() : nullptr));
    }
}

// All sweeps are at the same bounce, from the coarsest grid to the finest, so that surfaces in each send on what lights them from all.
void LpvSweepCascades::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    places_.record(executor, frame, rsms, placement);
    const bool isOther = surfaces_.import(executor, frame);
    std::vector<LpvSweepInput> inputs;
    const bool hasMoved = sweeps_[0]->moves(executor);
    bool all = false;
    for (std::size_t c = 0; c < sweeps_.size(); ++c) {
        inputs.push_back({rsms, places_.authored(), frame.vplCount, places_.grid(c).place(), surfaces_.surfels(), surfaces_.areaScale(),
                          placement.refit || isOther, c + 1 == sweeps_.size() ? frame.environment : nullptr, surfaces_.triangles()});
        all = sweeps_[c]->begin(executor, inputs[c].restart);
    }
    const LpvSweep& any = *sweeps_[0];
    // What is shown lies elsewhere than when it was made where the origin of positions has moved.
    if (hasMoved && any.isShown() && !all)
        for (std::size_t c = 0; c < sweeps_.size(); ++c) places_.recordTable(executor, c, sweeps_[c]->shownPlace());
    do {
        if (any.isAtStart())
            for (std::size_t c = 0; c < sweeps_.size(); ++c) sweeps_[c]->recordStart(executor, inputs[c]);
        for (std::size_t c = sweeps_.size(); c-- > 0;) recordPart(executor, c, inputs[c]);
    } while (all && !any.isDone());
    if (!any.isDone()) return;
    for (std::size_t c = 0; c < sweeps_.size(); ++c) {
        sweeps_[c]->recordEnd(executor);
        places_.recordTable(executor, c, sweeps_[c]->shownPlace());
    }
}

void LpvSweepCascades::recordPart(Executor& executor, std::size_t c, const LpvSweepInput& input) {
    LpvSweep& sweep = *sweeps_[c];
    const bool isComplete = sweep.recordPart(executor, input, c > 0 ? &sweeps_[c - 1]->place() : nullptr);
    if (!isComplete || c + 1 == sweeps_.size()) return;
    const LpvNested grids{sweep.place(), sweeps_[c + 1]->place()};
    const Buffer& far = sweeps_[c + 1]->outerCells();
    if (c > 0) cascades_.recordSweeps(executor, grids, far, sweep.outerCells(), nullptr, sweep.outerLargest());
    cascades_.recordSweeps(executor, grids, far, sweep.bounceCells(), sweep.totalCells(), sweep.largest());
}

void LpvSweepCascades::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                    const Planes& validity, const Buffer& counts) {
    eachLayer(desc_.cascades, bool(irradiance), [&](LpvLayer layer) {
        sweeps_[layer.index]->recordGather(executor, position, normal, irradiance, validity, counts, &places_.table(), layer);
    });
}

void LpvSweepCascades::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                       const Planes& validity, const Buffer& counts) {
    eachLayer(desc_.cascades, bool(harmonics), [&](LpvLayer layer) {
        sweeps_[layer.index]->recordHarmonics(executor, position, normal, harmonics, validity, counts, &places_.table(), layer);
    });
}

std::vector<LWChoice> LpvSweepCascades::choices(const LWFrame& frame, double side) const {
    std::vector<LWChoice> choices = surfaces_.choices(frame, side);
    choices.push_back(places_.choice());
    return choices;
}

void LpvSweepCascades::report(Report& report) const {
    surfaces_.report(report);
    report.counts.push_back({"cascades", desc_.cascades});
    report.counts.push_back({"lights_outside", 0});
    if (sweeps_.back()->outside()) report.read(device_, "lights_outside", sweeps_.back()->outside(), 0);
}

std::uint64_t LpvSweepCascades::bytes() const {
    std::uint64_t total = surfaces_.bytes() + places_.bytes();
    for (const std::unique_ptr<LpvSweep>& sweep : sweeps_) total += sweep->bytes();
    return total;
}

std::uint64_t LpvSweepCascades::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    return LpvPlaces::estimateBytes(desc, shape) + LpvSurfaces::estimateBytes(desc, shape) +
           LpvSweep::estimateBytes(LpvSweepVolume::optionsOf(desc), desc.cascades);
}

}  // namespace lightwell
