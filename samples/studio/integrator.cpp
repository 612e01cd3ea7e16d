// Path tracing of diffuse surfaces with next-event estimation, split by bounce.
//
// Source: J. Kajiya, "The Rendering Equation" (SIGGRAPH 1986); docs: "Reference" in accuracy.md. With
// cosine-distributed directions every factor cos / pi of the Lambertian surfaces cancels: a path whose
// vertices y_1 ... y_k have albedos rho_1 ... rho_k brings rho_1 ... rho_k * E_direct(y_k) of irradiance
// to bounce k. Sky and emission are light sources like the punctual ones (bounce 0).
//
// Shading normals: cosines are those of the shading normal. A direction above the shading normal's
// horizon but under the surface itself brings nothing, because the surface's own body blocks it; tracing
// it would meet the back of the very surface it starts from.
#include "integrator.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace studio {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kRouletteFrom = 3;  // bounces; layers one and two are never thinned

// Surfaces nearer to each other along a ray than this share of the distance count as one when a ray
// passes through (coplanar duplicates). Larger: thin sheets lose a side. Smaller: float rounding.
constexpr float kStepThrough = 1e-5f;
constexpr float kTiny = std::numeric_limits<float>::min();  // so that a ray leaves distance 0 as well

float largest(const glm::vec3& c) {
    return std::max(c.x, std::max(c.y, c.z));
}

Surface surfaceOf(const Hit& hit) {
    return {hit.position, hit.geometricNormal, hit.normal};
}

}  // namespace

LayerSample Integrator::tracePath(const Surface& pixel, const glm::vec3& punctual,
                                  Sampler& sampler) const {
    LayerSample sample{};
    Surface at = pixel;
    glm::vec3 throughput(1.0f);
    const auto add = [&](int bounce, const glm::vec3& irradiance) {
        if (bounce <= kBounce2) sample[std::size_t(bounce)] += throughput * irradiance;
        if (bounce >= 1) sample[kAllBounces] += throughput * irradiance;
    };

    for (int bounce = 0;; ++bounce) {
        // Light that comes straight to this vertex: lamps, then a sample of the emissive surfaces.
        add(bounce, bounce == 0 ? punctual : punctualIrradiance(at));
        add(bounce, areaLights_.sampleIrradiance(scene_, at, sampler));

        // One ray brings the sky, the rest of the emission, and the next vertex.
        const glm::vec3 direction = sampleCosine(at.normal, sampler.next());
        if (glm::dot(at.geometricNormal, direction) <= 0.0f) break;
        Hit hit;
        const glm::vec3 origin = scene_.offset(at.position, at.geometricNormal);
        if (!scene_.trace(origin, direction, 0.0f, kInfinity, hit)) {
            add(bounce, kPi * scene_.scene().sky);
            break;
        }
        add(bounce, areaLights_.emissionOfRay(at, direction, hit));
        if (bounce == maxBounces_) break;
        throughput *= hit.albedo;

        // Unbiased Russian roulette in proportion to what the path still carries.
        if (bounce + 1 >= kRouletteFrom) {
            const float survival = std::min(1.0f, largest(throughput));
            if (sampler.next().x >= survival) break;
            throughput /= survival;
        } else if (largest(throughput) <= 0.0f) {
            break;
        }
        at = surfaceOf(hit);
    }
    return sample;
}

glm::vec3 Integrator::directIrradiance(const Surface& at, Sampler& sampler) const {
    glm::vec3 irradiance = punctualIrradiance(at);
    const glm::vec3 sky = scene_.scene().sky;
    if (areaLights_.empty() && largest(sky) <= 0.0f) return irradiance;

    irradiance += areaLights_.sampleIrradiance(scene_, at, sampler);
    const glm::vec3 direction = sampleCosine(at.normal, sampler.next());
    if (glm::dot(at.geometricNormal, direction) <= 0.0f) return irradiance;
    Hit hit;
    const glm::vec3 origin = scene_.offset(at.position, at.geometricNormal);
    if (!scene_.trace(origin, direction, 0.0f, kInfinity, hit)) return irradiance + kPi * sky;
    return irradiance + areaLights_.emissionOfRay(at, direction, hit);
}

// The limit of a gather from virtual point lights without visibility, in that gather's own measure.
//
// A VPL that stands for the area dA of a surface (geometric normal g, shading normal n) carries the flux
// rho E_g dA, E_g the irradiance on the geometric surface, and sends (1/pi) max(0, n.w) of it towards
// the pixel; seen from the pixel dA = d^2 dw / |g.w|. A ray's radiance is therefore
//     rho/pi * E_g * max(0, n.w) / |g.w|,
// which is the usual rho/pi * E wherever n = g. The lobe stands about n, so the side that counts is the
// one n turns to the pixel, and the pixel's whole hemisphere about its shading normal receives, the part
// under its own surface too: nothing blocks.
glm::vec3 Integrator::traceUnshadowed(const Surface& pixel, Sampler& sampler) const {
    const glm::vec3 direction = sampleCosine(pixel.normal, sampler.next());
    const bool above = glm::dot(pixel.geometricNormal, direction) > 0.0f;
    const glm::vec3 origin =
        scene_.offset(pixel.position, above ? pixel.geometricNormal : -pixel.geometricNormal);

    glm::vec3 irradiance(0.0f);
    Hit hit;
    for (float from = 0.0f; scene_.trace(origin, direction, from, kInfinity, hit);
         from = hit.distance * (1.0f + kStepThrough) + kTiny) {
        const float facing = -glm::dot(hit.normal, direction);
        const float projected = -glm::dot(hit.geometricNormal, direction);
        if (projected <= 0.0f || largest(hit.albedo) <= 0.0f) continue;
        const glm::vec3 lobeSide = facing > 0.0f ? hit.geometricNormal : -hit.geometricNormal;
        const Surface lit{hit.position, lobeSide, lobeSide};
        irradiance += hit.albedo * directIrradiance(lit, sampler) * (std::abs(facing) / projected);
    }
    return irradiance;
}

}  // namespace studio
