// Frame part, report and registration; the table of parameters is lpv_parameters.cpp's.
#include "techniques/lpv.h"

#include <algorithm>
#include <optional>

#include "compute/device.h"
#include "inputs/geometry_box.h"
#include "inputs/rsm_input.h"
#include "passes/lpv_grid.h"
#include "passes/lpv_propagation.h"
#include "passes/lpv_read.h"
#include "techniques/lpv_geometry.h"
#include "techniques/lpv_parameters.h"
#include "techniques/lpv_sweep_volume.h"
#include "techniques/lpv_view.h"
#include "techniques/prewarm.h"
#include "techniques/technique_entry.h"

namespace lightwell {
namespace {

// Light crosses a cell in a step at best (Kaplanyan and Dachsbacher 2010 take as many as the grid is long, twice over).
std::uint32_t stepsOf(const LWLpvDesc& desc) { return desc.steps ? desc.steps : 2 * desc.size; }

bool isHalf(const LWLpvDesc& desc) { return desc.resolution == LW_RESOLUTION_HALF; }

bool sweeps(const LWLpvDesc& desc) { return desc.transport == LW_LPV_TRANSPORT_SWEEP; }

// What steps take; sweeps choose their own blockers.
LWLpvDesc ofSteps(LWLpvDesc desc) {
    if (sweeps(desc)) desc.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
    return desc;
}

// Geometry and source views apart, which LpvGeometry and LpvSweepVolume speak of.
std::vector<LWChoice> unusedInputs(const LWFrame& frame) {
    constexpr const char* kReason = "not used: technique lpv takes light from RSMs and authored VPLs only";
    std::vector<LWChoice> unused;
    if (frame.blockerCount) unused.push_back({"frame.blockers", kReason});
    if (frame.environment[0] > 0.0f || frame.environment[1] > 0.0f || frame.environment[2] > 0.0f)
        unused.push_back({"frame.environment", kReason});
    for (std::uint32_t l = 0; l < frame.lightCount; ++l)
        if (frame.lights[l].rsmCount == 0) {
            unused.push_back({"frame.lights", "some have no RSM: technique lpv makes no indirect light of those"});
            break;
        }
    return unused;
}

// Grids and kernels of one size.
struct Volume {
    Volume(Device& device, std::uint32_t size) : grid(device, size), propagation(device, size), read(device, size) {}
    std::uint64_t bytes() const { return grid.bytes() + propagation.bytes() + read.bytes(); }
    LpvGrid grid;
    LpvPropagation propagation;
    LpvRead read;
};

class LpvTechnique final : public Technique {
public:
    LpvTechnique(Device& device, const LWLpvDesc& desc)
        : device_(device),
          desc_(desc),
          calibration_(LpvPropagation::calibration(desc.size, stepsOf(desc), desc.geometryVolume != LW_GEOMETRY_VOLUME_OFF)),
          geometry_(device, ofSteps(desc)),
          failures_(device.failures()) {
        volume_.emplace(device, desc.size);
        if (sweeps(desc)) sweep_.emplace(device, desc);
        if (isHalf(desc)) bilateral_.emplace(device);
        for (int a = 0; a < 3; ++a) placement_.centre[a] = desc.center[a];
        placement_.extent = desc.extent;
    }

    void update(Executor& executor, const LWFrame& frame) override {
        const bool failed = device_.failures() != failures_ || isCut_;
        geometry_.check(frame);
        box_.look(frame.geometry);
        if (sweep_) sweep_->check(frame);
        rsms_.import(executor, frame);
        isCut_ = true;
        if (failed) geometry_.forget();
        geometry_.import(executor, frame, rsms_);
        failures_ = device_.failures();
        if (failed) {  // what their memory holds is not known
            volume_.emplace(device_, desc_.size);
            if (sweep_) sweep_.emplace(device_, desc_);
        }
        placement_.hasBox = box_.isSome();
        for (int a = 0; a < 3; ++a) {
            placement_.low[a] = box_.low()[a];
            placement_.high[a] = box_.high()[a];
        }
        placement_.refit = frame.reset != 0 || failed;
        if (sweep_)
            recordSweep(executor, frame);
        else
            recordSteps(executor, frame);
        isCut_ = false;
        states_.purge();
        states_.each([](LpvView& state) { state.startFrame(); });
    }

    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output) override {
        checkLightOutputs(device_, *view, output, "lpv");
        LpvView& state = states_.get(view, [&] { return std::make_unique<LpvView>(device_, *view, isHalf(desc_)); });
        const auto gather = [&](const Planes& position, const Planes& normal, const Planes& irradiance, const Planes& validity,
                                const Buffer& counts) {
            if (sweep_)
                sweep_->sweep().recordGather(executor, position, normal, irradiance, validity, counts);
            else
                volume_->read.recordGather(executor, position, normal, volume_->grid.place(), calibration_, desc_.damping != 0,
                                           irradiance, validity, counts);
        };
        state.render(executor, *view, gbuffer, output, bilateral_ ? &*bilateral_ : nullptr, gather);
    }

    void prewarm(Executor& executor, const std::shared_ptr<View>&) override {
        LWLpvDesc desc = desc_;
        desc.steps = std::min(stepsOf(desc), 2u);
        if (sweep_)
            prewarmSweep(executor, desc);
        else
            prewarmSteps(executor, desc);
    }

    Report report() override;
    std::vector<DebugView> debugViews(const View* view) override;
    std::uint64_t bytes() const override;

private:
    void recordSteps(Executor& executor, const LWFrame& frame) {
        volume_->grid.record(executor, rsms_, frame.vpls, frame.vplCount, placement_);
        const std::optional<LpvBlockers> blockers = geometry_.record(executor, volume_->grid.place());
        propagated_ = &volume_->propagation.record(executor, volume_->grid.injected(), stepsOf(desc_),
                                                   blockers ? &*blockers : nullptr);
        volume_->read.recordPack(executor, *propagated_);
        choices_ = unusedInputs(frame);
        for (const LWChoice& choice : geometry_.choices(frame)) choices_.push_back(choice);
    }
    void recordSweep(Executor& executor, const LWFrame& frame) {
        volume_->grid.recordPlace(executor, rsms_, frame.vpls, frame.vplCount, placement_);
        sweep_->record(executor, frame, rsms_, volume_->grid, placement_.refit);
        choices_ = unusedInputs(frame);
        const double side = desc_.extent > 0.0f ? double(desc_.extent) : double(box_.longest());
        for (const LWChoice& choice : sweep_->choices(frame, side)) choices_.push_back(choice);
    }

    // Frames may bring all of the sources or none, and `auto` takes the first there is.
    void prewarmSteps(Executor& executor, LWLpvDesc desc) {
        for (int source = LW_GEOMETRY_VOLUME_TRIANGLES; source <= LW_GEOMETRY_VOLUME_SCREEN; ++source) {
            if (desc_.geometryVolume == LW_GEOMETRY_VOLUME_AUTO) desc.geometryVolume = LWGeometryVolume(source);
            else if (source != LW_GEOMETRY_VOLUME_TRIANGLES) break;
            LpvTechnique twin(device_, desc);
            exerciseTechnique(executor, twin);
        }
        desc.geometryVolume = LW_GEOMETRY_VOLUME_OFF;
        LpvTechnique(device_, desc).prewarmVpls(executor);
    }
    void prewarmSweep(Executor& executor, LWLpvDesc desc) {
        desc.size = 16;  // the same kernels, in less memory
        desc.directions = 24;
        for (int hidden = 0; hidden < LpvSweepVolume::kSources; ++hidden) {
            LpvTechnique twin(device_, desc);
            twin.sweep_->hide(hidden);
            twin.prewarmVpls(executor);
            exerciseTechnique(executor, twin);
        }
    }
    // A frame of VPLs, which exerciseTechnique's have none of.
    void prewarmVpls(Executor& executor) {
        LWVpl vpl{};
        vpl.normal[1] = vpl.flux[0] = 1.0f;
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.vpls = &vpl;
        frame.vplCount = 1;
        update(executor, frame);
    }

    Device& device_;
    LWLpvDesc desc_;
    double calibration_;
    LpvGeometry geometry_;
    std::uint64_t failures_;  // that the device had seen when the last update began
    bool isCut_ = false;      // the last update was not recorded to its end: what is kept from frame to frame may be half made
    GeometryBox box_;
    LpvPlacement placement_;
    RsmInput rsms_;
    std::optional<Volume> volume_;
    std::optional<LpvSweepVolume> sweep_;  // with transport=sweep; of `volume_` only the grid's place is used then
    std::optional<JointBilateral> bilateral_;  // with resolution=half
    const Buffer* propagated_ = nullptr;
    PerView<LpvView> states_;
    std::vector<LWChoice> choices_;  // of the last update
};

Report LpvTechnique::report() {
    Report report;
    rsms_.report(report);
    geometry_.report(report);
    for (const LWChoice& choice : choices_) report.choose(choice.name, choice.reason);
    if (sweep_)
        sweep_->report(report);
    else
        report.counts.push_back({"steps", stepsOf(desc_)});
    report.counts.push_back({"lights_outside", 0});
    LpvView::startReport(report);
    if (sweep_ && sweep_->sweep().outside()) report.read(device_, "lights_outside", sweep_->sweep().outside(), 0);
    if (propagated_) report.read(device_, "lights_outside", volume_->grid.state(), LW_LPV_OUTSIDE * sizeof(cl_uint));
    states_.each([&](const LpvView& state) { state.report(device_, report); });
    return report;
}

std::vector<DebugView> LpvTechnique::debugViews(const View* view) {
    std::vector<DebugView> views;
    if (propagated_) {
        views.push_back({"injected", "cells, slice below slice with two empty rows between: c0, c1 xyz of red, green, blue (W/sr)",
                         LpvPropagation::debugPlanes(volume_->grid.injected(), desc_.size), {}});
        views.push_back({"propagated", "the same after all steps, with what was injected",
                         LpvPropagation::debugPlanes(*propagated_, desc_.size), {}});
    }
    if (const LpvView* state = states_.find(view)) state->addDebugViews(views);
    return views;
}

std::uint64_t LpvTechnique::bytes() const {
    std::uint64_t total = rsms_.bytes() + geometry_.bytes() + volume_->bytes() + (sweep_ ? sweep_->bytes() : 0);
    states_.each([&](const LpvView& state) { total += state.bytes(); });
    return total;
}

// ------------------------------------------------------------------------------------- registration

std::uint64_t estimateBytes(const void* desc, const LWViewDesc& view, const FrameShape& shape) {
    const LWLpvDesc& lpv = *static_cast<const LWLpvDesc*>(desc);
    std::uint64_t volume = 0;
    if (sweeps(lpv))
        volume = LpvGrid::estimatePlaceBytes(shape.vplCount) + LpvSweepVolume::estimateBytes(lpv, shape);
    else
        volume = LpvGrid::estimateBytes(lpv.size, shape.vplCount) + LpvPropagation::estimateBytes(lpv.size, stepsOf(lpv)) +
                 LpvRead::estimateBytes(lpv.size) + LpvGeometry::estimateBytes(lpv, shape);
    return RsmInput::estimateBytes(shape) + volume + LpvView::estimateBytes(view, isHalf(lpv), shape.uploads);
}

}  // namespace

const TechniqueEntry& lpvEntry() {
    static const TechniqueEntry entry = techniqueEntry<LpvTechnique, LWLpvDesc, lwDefaultLpv>(
        "lpv", "light propagation volumes: RSMs' light spread from cell to cell of a grid", 1, lpvParameters(),
        lpvSettings(), estimateBytes);
    return entry;
}

}  // namespace lightwell
