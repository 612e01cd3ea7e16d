// Specular rays in tests: points of one normal and roughness seen from an eye, and the radiance that the pass finds for them.
#pragma once

#include <vector>

#include "passes/lpv_specular.h"
#include "shared/lpv_types.h"
#include "support/kernel_rig.h"
#include "support/sweep_rig.h"

namespace lightwell::test {

struct SpecularPoint {
    reference::Vec position, normal;
    double roughness = 0.0;
};

inline LwSpecularRays raysFrom(reference::Vec eye, double environment = 0.0) {
    LwSpecularRays view{};
    view.eye = float4(eye.x, eye.y, eye.z, 1.0);
    view.environment = float4(environment, environment, environment, 0.0);
    return view;
}

// Planes of three colours, packed; counts as the pass has them.
struct SpecularLight {
    std::vector<float> radiance;
    std::vector<cl_int> counts;
    double red(std::size_t i) const { return double(radiance[i]); }
};

inline SpecularLight marchSpecular(KernelRig& rig, LpvSpecular& pass, const std::vector<SpecularPoint>& points,
                                   const LwSpecularRays& view, const Buffer& place) {
    const auto count = std::uint32_t(points.size());
    std::vector<float> positions(3 * count), normals(3 * count), roughness(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        const double p[3] = {points[i].position.x, points[i].position.y, points[i].position.z};
        const double n[3] = {points[i].normal.x, points[i].normal.y, points[i].normal.z};
        for (std::uint32_t a = 0; a < 3; ++a) {
            positions[a * count + i] = float(p[a]);
            normals[a * count + i] = float(n[a]);
        }
        roughness[i] = float(points[i].roughness);
    }
    const Guarded at = rig.uploadPlanes(positions, count, 1, 3, 0.0f), facing = rig.uploadPlanes(normals, count, 1, 3, 0.0f),
                  rough = rig.uploadPlanes(roughness, count, 1, 1, 0.0f), out = rig.makePlanes(count, 1, 3);
    const Guarded counts = rig.upload(std::vector<cl_int>(LpvSpecular::kCounts));
    const Planes light = rig.planes(out, count, 1, 3);
    pass.recordMarch(rig.executor(), rig.planes(at, count, 1, 3), rig.planes(facing, count, 1, 3), rig.planes(rough, count, 1, 1), view,
                     place, light, counts);
    rig.device().finish();
    return {rig.downloadPlanes(light), rig.download<cl_int>(counts)};
}

inline LwLpvPlace placeOf(double cell, reference::Vec origin = {}) {
    LwLpvPlace place{};
    place.origin = float4(origin.x, origin.y, origin.z, 1.0 / cell);
    place.cell = float4(cell, 1.0, 1.0, 0.0);
    return place;
}

}  // namespace lightwell::test
