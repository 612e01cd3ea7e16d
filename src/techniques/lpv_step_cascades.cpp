#include "techniques/lpv_step_cascades.h"

#include <optional>

#include "compute/device.h"
#include "techniques/lpv_step_volume.h"

namespace lightwell {

LpvStepCascades::LpvStepCascades(Device& device, const LWLpvDesc& desc)
    : device_(device),
      desc_(desc),
      calibration_(LpvPropagation::calibration(desc.size, LpvStepVolume::stepsOf(desc), desc.geometryVolume != LW_GEOMETRY_VOLUME_OFF)),
      geometry_(device, desc),
      places_(device, desc),
      cascades_(device, desc.size) {
    for (std::uint32_t c = 0; c < desc.cascades; ++c) {
        levels_.push_back(std::make_unique<Level>(device, desc.size));
        if (desc.autoError == 0.0f) continue;
        levels_[c]->allProgress.emplace(LpvStepVolume::progressOf(device, desc));
        if (c > 0) levels_[c]->outerProgress.emplace(LpvStepVolume::progressOf(device, desc));
    }
}

// From the coarsest grid to the finest: the light of lights outside of the next grid, with what still coarser grids brought, is what
// that one is brought.
void LpvStepCascades::record(Executor& executor, const LWFrame& frame, const RsmInput& rsms, const LpvPlacement& placement) {
    geometry_.import(executor, frame, rsms);
    places_.record(executor, frame, rsms, placement);
    for (std::size_t c = levels_.size(); c-- > 0;) {
        const std::optional<LpvBlockers> found = geometry_.record(executor, places_.grid(c).place(), c);
        const LpvBlockers* blockers = found ? &*found : nullptr;
        if (c > 0) recordField(executor, frame, rsms, c, true, blockers);
        recordField(executor, frame, rsms, c, false, blockers);
    }
    places_.recordTable(executor);
}

void LpvStepCascades::recordField(Executor& executor, const LWFrame& frame, const RsmInput& rsms, std::size_t c, bool isOuter,
                                  const LpvBlockers* blockers) {
    Level& level = *levels_[c];
    LpvGrid& grid = places_.grid(c);
    std::optional<LpvProgress>& progress = isOuter ? level.outerProgress : level.allProgress;
    grid.recordInject(executor, rsms, places_.authored(), frame.vplCount, isOuter ? &places_.grid(c - 1).place() : nullptr,
                      c + 1 == levels_.size() ? frame.environment : nullptr);
    level.propagated = &level.propagation.record(executor, grid.injected(), LpvStepVolume::stepsOf(desc_), blockers,
                                                 progress ? &*progress : nullptr);
    LpvRead& read = isOuter ? level.outer : level.all;
    read.recordPack(executor, *level.propagated, progress ? &progress->state() : nullptr);
    if (c + 1 < levels_.size())
        cascades_.recordSteps(executor, {grid.place(), places_.grid(c + 1).place()}, levels_[c + 1]->outer.cells(), read.cells());
}

void LpvStepCascades::recordGather(Executor& executor, const Planes& position, const Planes& normal, const Planes& irradiance,
                                   const Planes& validity, const Buffer& counts) {
    eachLayer(desc_.cascades, bool(irradiance), [&](LpvLayer layer) {
        levels_[layer.index]->all.recordGather(executor, position, normal, places_.table(), calibration_, desc_.damping != 0, irradiance,
                                               validity, counts, layer);
    });
}

void LpvStepCascades::recordHarmonics(Executor& executor, const Planes& position, const Planes& normal, const Harmonics& harmonics,
                                      const Planes& validity, const Buffer& counts) {
    eachLayer(desc_.cascades, bool(harmonics), [&](LpvLayer layer) {
        levels_[layer.index]->all.recordHarmonics(executor, position, normal, places_.table(), calibration_, harmonics, validity, counts,
                                                  layer);
    });
}

std::vector<LWChoice> LpvStepCascades::choices(const LWFrame& frame, double) const {
    std::vector<LWChoice> choices = geometry_.choices(frame);
    choices.push_back(places_.choice());
    return choices;
}

void LpvStepCascades::report(Report& report) const {
    geometry_.report(report);
    // Of all light that is carried: all lights' in each grid, and that of lights outside of the next finer one.
    report.counts.push_back({"steps", desc_.autoError > 0.0f ? 0 : (2 * desc_.cascades - 1) * LpvStepVolume::stepsOf(desc_)});
    for (const std::unique_ptr<Level>& level : levels_)
        for (const std::optional<LpvProgress>* progress : {&level->allProgress, &level->outerProgress})
            if (*progress && level->propagated) LpvStepVolume::reportProgress(device_, **progress, report);
    report.counts.push_back({"cascades", desc_.cascades});
    report.counts.push_back({"lights_outside", 0});
    if (levels_.back()->propagated)
        report.read(device_, "lights_outside", places_.coarsest().state(), LW_LPV_OUTSIDE * sizeof(cl_uint));
}

void LpvStepCascades::addDebugViews(std::vector<DebugView>& views) const {
    static constexpr const char *kInjected[] = {"injected_0", "injected_1", "injected_2", "injected_3", "injected_4", "injected_5"},
                                *kPropagated[] = {"propagated_0", "propagated_1", "propagated_2", "propagated_3", "propagated_4", "propagated_5"};
    for (std::size_t c = 0; c < levels_.size(); ++c) {
        if (!levels_[c]->propagated) return;
        views.push_back({kInjected[c], "of a grid, 0 the finest: cells, slice below slice with two empty rows between: c0, c1 xyz of red, "
                                       "green, blue (W/sr)",
                         LpvPropagation::debugPlanes(places_.grid(c).injected(), desc_.size), {}});
        views.push_back({kPropagated[c], "the same after all steps, with what was injected, without what coarser grids bring",
                         LpvPropagation::debugPlanes(*levels_[c]->propagated, desc_.size), {}});
    }
    places_.addDebugViews(views);
}

std::uint64_t LpvStepCascades::bytes() const {
    std::uint64_t total = geometry_.bytes() + places_.bytes();
    for (const std::unique_ptr<Level>& level : levels_) {
        total += level->propagation.bytes() + level->all.bytes() + level->outer.bytes();
        for (const std::optional<LpvProgress>* progress : {&level->allProgress, &level->outerProgress})
            if (*progress) total += (*progress)->bytes();
    }
    return total;
}

std::uint64_t LpvStepCascades::estimateBytes(const LWLpvDesc& desc, const FrameShape& shape) {
    const std::uint64_t level = LpvGrid::estimateInjectBytes(desc.size) +
                                LpvPropagation::estimateBytes(desc.size, LpvStepVolume::stepsOf(desc)) + LpvRead::estimateBytes(desc.size);
    const std::uint64_t progress = desc.autoError > 0.0f ? LpvProgress::estimateBytes(desc.size) : 0;
    return desc.cascades * level + (2 * desc.cascades - 1) * progress + (desc.cascades - 1) * LpvRead::estimateBytes(desc.size) +
           LpvPlaces::estimateBytes(desc, shape) + LpvGeometry::estimateBytes(desc, shape);
}

}  // namespace lightwell
