// Path tracing of diffuse surfaces with next-event estimation, split by bounce.
//
// Source: J. Kajiya, "The Rendering Equation" (SIGGRAPH 1986); docs/accuracy.md, "The reference". With
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

// Density per area with which a cosine-sampled ray from `at` finds a place: c c_p / (pi d^2).
float rayDensity(float cosine, float geometricCosine, float squaredDistance) {
    return cosine * geometricCosine / (kPi * squaredDistance);
}

// The normal a shadow map's texel has, on the lit side of its surface: the shading normal, unless that
// leans away from the lamp although the surface faces it.
glm::vec3 lobeNormal(const glm::vec3& litSide, const glm::vec3& shading, const glm::vec3& toLamp) {
    const glm::vec3 turned = glm::dot(shading, litSide) > 0.0f ? shading : -shading;
    return glm::dot(turned, toLamp) > 0.0f ? turned : litSide;
}

// The connection's two ends, off their surfaces, and what lies between.
struct Link {
    glm::vec3 origin, direction;
    float distance, squared;
    Link(const glm::vec3& from, const glm::vec3& to) : origin(from) {
        const glm::vec3 way = to - from;
        squared = glm::dot(way, way);
        distance = std::sqrt(squared);
        direction = distance > 0.0f ? way / distance : glm::vec3(0.0f);
    }
};

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

    add(0, punctual);
    for (int bounce = 0;; ++bounce) {
        // From this vertex towards light: to emissive surfaces, and to what lamps shine on.
        add(bounce, areaLights_.sampleIrradiance(scene_, at, sampler));
        if (bounce < maxBounces_) add(bounce + 1, connect(at, sampler));

        // One ray brings the sky, the rest of the emission and of the lamplit surfaces, and the next
        // vertex. Past the last bounce only sky and emission are left to find.
        if (bounce == maxBounces_ && !hasExtendedLight_) break;
        const glm::vec3 direction = sampleCosine(at.normal, sampler.next());
        if (glm::dot(at.geometricNormal, direction) <= 0.0f) break;
        Hit hit;
        const glm::vec3 origin = scene_.offset(at.position, at.geometricNormal);
        if (!scene_.trace(origin, direction, 0.0f, kInfinity, hit)) {
            add(bounce, kPi * scene_.scene().sky);
            break;
        }
        add(bounce, areaLights_.emissionOfRay(at, direction, hit));
        if (bounce == maxBounces_ || !sends(hit.position, hit.geometricNormal)) break;
        throughput *= hit.albedo;
        add(bounce + 1, punctualOfRay(at, direction, hit));

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

// The balance heuristic over two ways to a surface that lamp l lights: a cosine-sampled ray of density
// p_ray per area, and a lit point of density p_l. Either way the irradiance at the ray's start is
//     rho E_l p_ray / (p_ray + p_l),
// because rho/pi E_l c c_p / d^2 = rho E_l p_ray.
glm::vec3 Integrator::punctualOfRay(const Surface& at, const glm::vec3& direction,
                                    const Hit& hit) const {
    const float byRay =
        rayDensity(glm::dot(at.normal, direction), -glm::dot(hit.geometricNormal, direction),
                   hit.distance * hit.distance);
    glm::vec3 irradiance(0.0f);
    for (std::size_t l = 0; l < scene_.lights().size(); ++l) {
        const glm::vec3 fromLamp =
            scene_.directIrradiance(scene_.lights()[l], hit.position, hit.geometricNormal, hit.normal);
        if (largest(fromLamp) <= 0.0f) continue;
        const float byLamp = litPoints_.density(l, hit.position, hit.geometricNormal);
        irradiance += fromLamp * rayShare(byRay, byLamp);
    }
    return irradiance;
}

glm::vec3 Integrator::connect(const Surface& at, Sampler& sampler) const {
    LitPoints::Point point;
    if (litPoints_.empty() || !litPoints_.sample(sampler, point)) return glm::vec3(0.0f);
    const Surface& lit = point.surface;
    const Link link(scene_.offset(at.position, at.geometricNormal),
                    scene_.offset(lit.position, lit.geometricNormal));
    const float cosine = glm::dot(at.normal, link.direction);
    const float litCosine = -glm::dot(lit.geometricNormal, link.direction);
    if (cosine <= 0.0f || litCosine <= 0.0f || glm::dot(at.geometricNormal, link.direction) <= 0.0f)
        return glm::vec3(0.0f);
    const LightArrival lamp = arrivalOf(scene_.lights()[point.light], lit.position);
    const float lampCosine = glm::dot(lit.normal, lamp.toLight);
    if (lampCosine <= 0.0f || scene_.occluded(link.origin, link.direction, 0.0f, link.distance) ||
        !sends(lit.position, lit.geometricNormal))
        return glm::vec3(0.0f);
    const float byRay = rayDensity(cosine, litCosine, link.squared);
    return point.albedo * lamp.irradiance * (lampCosine * rayShare(byRay, point.density));
}

// The limit of a gather from virtual point lights without visibility, in that gather's own measure.
//
// A VPL that stands for the area dA of a surface (geometric normal g on the lit side, lobe's normal n,
// see lobeNormal) carries the flux rho E_g dA, E_g the irradiance on the geometric surface, and sends
// (1/pi) max(0, n.w) of it towards the pixel; seen from the pixel dA = d^2 dw / |g.w|. A ray's radiance
// is therefore
//     rho/pi E_g max(0, n.w) / |g.w|,
// which is the usual rho/pi E wherever n = g. The pixel's whole hemisphere about its shading normal
// receives, the part under its own surface too: nothing blocks. Rays and lit points share the light as
// above, p_ray = c |g.w| / (pi d^2), so that the quotient's pole does no harm.
glm::vec3 Integrator::traceUnshadowed(const Surface& pixel, Sampler& sampler) const {
    glm::vec3 irradiance = connectUnshadowed(pixel, sampler);
    const glm::vec3 direction = sampleCosine(pixel.normal, sampler.next());
    const bool above = glm::dot(pixel.geometricNormal, direction) > 0.0f;
    const glm::vec3 origin =
        scene_.offset(pixel.position, above ? pixel.geometricNormal : -pixel.geometricNormal);
    Hit hit;
    for (float from = 0.0f; scene_.trace(origin, direction, from, kInfinity, hit);
         from = hit.distance * (1.0f + kStepThrough) + kTiny)
        if (largest(hit.albedo) > 0.0f)
            irradiance += hit.albedo * lightThrough(pixel, direction, hit, sampler);
    return irradiance;
}

// Light on `hit`, of albedo 1, as a ray through everything finds it.
glm::vec3 Integrator::lightThrough(const Surface& pixel, const glm::vec3& direction, const Hit& hit,
                                   Sampler& sampler) const {
    const float projected = -glm::dot(hit.geometricNormal, direction);
    if (projected <= 0.0f) return glm::vec3(0.0f);
    const float byRay =
        rayDensity(glm::dot(pixel.normal, direction), projected, hit.distance * hit.distance);

    // Sky and emission come from everywhere: the side whose lobe meets the pixel is the one that counts.
    const float facing = -glm::dot(hit.normal, direction);
    const glm::vec3 lobeSide = facing > 0.0f ? hit.geometricNormal : -hit.geometricNormal;
    glm::vec3 light(0.0f);
    if (hasExtendedLight_ && sends(hit.position, lobeSide))
        light = extendedIrradiance(scene_, areaLights_, {hit.position, lobeSide, lobeSide}, sampler) *
                (std::abs(facing) / projected);
    for (std::size_t l = 0; l < scene_.lights().size(); ++l) {
        const Light& lamp = scene_.lights()[l];
        const glm::vec3 toLamp = arrivalOf(lamp, hit.position).toLight;
        const glm::vec3 side =
            glm::dot(hit.geometricNormal, toLamp) > 0.0f ? hit.geometricNormal : -hit.geometricNormal;
        const float lobe = -glm::dot(lobeNormal(side, hit.normal, toLamp), direction);
        if (lobe <= 0.0f || !sends(hit.position, side)) continue;
        const float share = rayShare(byRay, litPoints_.density(l, hit.position, side));
        light += scene_.directIrradiance(lamp, hit.position, side, side) * (share * lobe / projected);
    }
    return light;
}

glm::vec3 Integrator::connectUnshadowed(const Surface& at, Sampler& sampler) const {
    LitPoints::Point point;
    if (litPoints_.empty() || !litPoints_.sample(sampler, point)) return glm::vec3(0.0f);
    const Surface& lit = point.surface;
    const LightArrival lamp = arrivalOf(scene_.lights()[point.light], lit.position);
    const Link link(at.position, lit.position);
    const float cosine = glm::dot(at.normal, link.direction);
    const float lobe =
        -glm::dot(lobeNormal(lit.geometricNormal, lit.normal, lamp.toLight), link.direction);
    if (cosine <= 0.0f || lobe <= 0.0f || !sends(lit.position, lit.geometricNormal))
        return glm::vec3(0.0f);
    const float lampCosine = glm::dot(lit.geometricNormal, lamp.toLight);
    const float projected = std::abs(glm::dot(lit.geometricNormal, link.direction));
    const float transfer = cosine * lobe / (kPi * link.squared);
    const float densities = rayDensity(cosine, projected, link.squared) + point.density;
    return point.albedo * lamp.irradiance * (lampCosine * transfer / densities);
}

}  // namespace studio
