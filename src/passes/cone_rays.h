// Single cones through a voxel volume at a view's pixels: along glossy lobes, along the refracted view
// direction, and towards a light (kernels/cone_gather/cone_rays.cl). docs/techniques/cone_gather.md.
#pragma once

#include "inputs/camera.h"
#include "passes/cone_gather.h"

namespace lightwell {

// A light that shadows are asked of.
struct ConeLightSource {
    float at[3] = {0.0f, 0.0f, 0.0f};  // its place; or, of a directional one, the way towards it
    bool isDirectional = false;
    double fullAngle = 0.05;  // radians that it fills
};

class ConeRays {
public:
    // Of the options size, cascades, mode, sides, startPlane, nudge, step, distance and opacityCorrection count.
    ConeRays(Device& device, const ConeGatherOptions& options);

    // Pass "cone_gather.specular": mean radiance over the lobe, and "cone_gather.refraction": along the
    // direction refracted into what has `index` of the surroundings' refractive index (1 or more); 3
    // planes, W/(sr m^2). roughness: none where `rough` is that of all pixels. counts: ConeGather's.
    void recordSpecular(Executor& executor, const Planes& position, const Planes& normal,
                        const Planes& roughness, double rough, lw_float4 eye, const ConeWorld& world,
                        const Planes& radiance, const Buffer& counts);
    void recordRefraction(Executor& executor, const Planes& position, const Planes& normal,
                          const Planes& roughness, double rough, double index, lw_float4 eye,
                          const ConeWorld& world, const Planes& radiance, const Buffer& counts);
    // Pass "cone_gather.shadow": the share of a light that arrives, 0 where the surface faces away.
    void recordShadow(Executor& executor, const Planes& position, const Planes& normal,
                      const ConeLightSource& light, const ConeWorld& world, const Planes& shadow);

    std::uint64_t bytes() const {
        return cones_.bytes() + steps_.bytes() + shadowCones_.bytes() + shadowSteps_.bytes();
    }
    static std::uint64_t estimateBytes(const ConeGatherOptions& options, bool hasRays,
                                       double shadowAngle);  // 0: no shadow

private:
    void recordRays(Executor& executor, const char* pass, const Planes& position, const Planes& normal,
                    const Planes& roughness, bool refracts, const LwConeView& view,
                    const ConeWorld& world, const Planes& radiance, const Buffer& counts);

    Device& device_;
    ConeGatherOptions options_;
    Buffer cones_, steps_, shadowCones_, shadowSteps_;
    bool isUploaded_ = false;  // cones_, steps_
    double shadowAngle_ = -1.0;
};

// Where a camera's rays come from: recordSpecular's eye.
lw_float4 coneEye(const Camera& camera);

// Half the aperture of class k of LW_CONE_APERTURES: 1 to 80 degrees in all.
double coneAperture(int k);

}  // namespace lightwell
