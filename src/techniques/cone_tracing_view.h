// What technique cone_tracing keeps of a view: cones traced at every pixel, at fewer of them and up-sampled, or a share of them at
// each and filtered.
#pragma once

#include <optional>
#include <vector>

#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "passes/cone_gather.h"
#include "passes/joint_bilateral.h"
#include "techniques/cone_tracing_rays.h"
#include "techniques/technique.h"

namespace lightwell {

// Whether the finest voxels have six sides: voxels that know what faces a cone have to.
inline bool coneSides(const LWConeTracingDesc& desc) { return desc.directionalOpacity != 0 || desc.normalAware != 0; }

// Of a descriptor, for the pass.
ConeGatherOptions coneOptions(const LWConeTracingDesc& desc);

// The passes of all views.
class ConeTracingPasses {
public:
    ConeTracingPasses(Device& device, const LWConeTracingDesc& desc);

    ConeGather gather;
    ConeRays rays;
    double index;                             // of refraction
    std::optional<JointBilateral> bilateral;  // with fewer pixels
    std::uint32_t halvings = 0;               // of the view's sides, of what is traced
    bool interleaved = false, dims = false;   // dims: light is that times ambient occlusion

    std::uint64_t bytes() const { return gather.bytes() + rays.bytes(); }
    static std::uint64_t estimateBytes(const LWConeTracingDesc& desc);

    // Pass "cone_tracing.dim".
    void recordDim(Executor& executor, const Planes& irradiance, const Planes& open);

private:
    Kernel* dim_ = nullptr;
};

class ConeTracingView {
public:
    ConeTracingView(Device& device, const LWConeTracingDesc& desc);

    void startFrame() { isRendered_ = false; }
    void render(Executor& executor, const View& view, const LWGBuffer& gbuffer, const LWOutput& output, ConeTracingPasses& passes,
                const ConeWorld& world, const ConeRaysAsked& rays);

    static void startReport(Report& report);
    void report(Report& report) const;
    void addDebugViews(std::vector<DebugView>& views) const;
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(const LWConeTracingDesc& desc, const LWViewDesc& view, bool uploads);

private:
    // What is asked for, or made on the way; empty where not.
    struct Light {
        Planes irradiance, validity, open;
        explicit operator bool() const { return irradiance || validity || open; }
    };
    struct Level {  // of halved sizes
        PlanarImage position, normal, light;
    };
    void reserve(const View& view, bool wantsOpen);
    // All cones at each of these pixels, or a share of them and a filter.
    void trace(Executor& executor, ConeTracingPasses& passes, const Planes& position, const Planes& normal, const ConeWorld& world,
               const Light& light);
    void traceReduced(Executor& executor, const View& view, ConeTracingPasses& passes, const ConeWorld& world, const Light& light);

    Device& device_;
    std::uint32_t halvings_;
    bool interleaved_, dims_, isRendered_ = false, isGathered_ = false;
    GBufferInput gbuffer_;
    OutputTarget irradiance_, validity_, open_;
    ConeTracingRays rays_;
    PlanarImage gathered_, ownOpen_;
    std::vector<Level> levels_;
    Buffer counts_, upsampleCounts_;
    Planes lastTraced_;  // of this frame, where another image than the host's
};

}  // namespace lightwell
