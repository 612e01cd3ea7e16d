// What technique cone_tracing keeps of a view for single cones: mirrored, refracted and towards a light, at every pixel whatever the
// resolution of its light.
#pragma once

#include <optional>

#include "inputs/gbuffer_input.h"
#include "inputs/output_target.h"
#include "passes/cone_rays.h"
#include "techniques/technique.h"

namespace lightwell {

// What of a view is asked for, checked.
struct ConeRaysAsked {
    bool specular = false, refracted = false;
    lw_float4 eye{};                      // of either
    std::optional<ConeLightSource> light;  // of a shadow
    bool hasRays() const { return specular || refracted; }
};

class ConeTracingRays {
public:
    // Of pixels without a roughness image: neither a mirror nor matt.
    static constexpr double kRoughness = 0.5;

    // Throws what a camera that rays cannot come from is told. light: of the last frame's shadow_light; null where that has none.
    static ConeRaysAsked asked(const View& view, const LWGBuffer& gbuffer, const LWOutput& output, const LWConeTracingDesc& desc,
                               const ConeLightSource* light);
    // GBufferNeeds of them.
    static std::uint32_t needs(const ConeRaysAsked& asked, const LWGBuffer& gbuffer);

    void render(Executor& executor, const View& view, const LWOutput& output, const GBufferInput& gbuffer, const ConeRaysAsked& asked,
                double index, ConeRays& rays, const ConeWorld& world);

    static void startReport(Report& report);
    // isAlone: no other output has counted the pixels.
    void report(Device& device, Report& report, bool isAlone) const;
    std::uint64_t bytes() const { return specular_.bytes() + refracted_.bytes() + shadow_.bytes() + counts_.bytes() + refractedCounts_.bytes(); }
    static std::uint64_t estimateBytes(const LWViewDesc& view, bool uploads);

private:
    OutputTarget specular_, refracted_, shadow_;
    Buffer counts_, refractedCounts_;
    ConeRaysAsked asked_;  // of the last render()
};

}  // namespace lightwell
