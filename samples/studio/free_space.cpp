// See free_space.h.
//
// Source: G. Papaioannou, Approximate dynamic global illumination for VR, 2025, section 5.2. Its public code
// continues a path from the ray's origin; here it goes on from the surface that it met.
#include "free_space.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "light_rays.h"
#include "parallel.h"
#include "sampler.h"

namespace studio {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
// Rays that a walk may lose through openings before its place counts as outside: where the sky fills half of all
// directions, one walk in 10^19 is given up.
constexpr int kTries = 64;
// Streams of random numbers: any that differ.
constexpr std::uint64_t kWalkStream = 0x77616c6bu, kPointStream = 0x1000000u, kLightStream = 0x2000000u;

glm::vec3 anyDirection(const glm::dvec2& point) {
    const double z = 1.0 - 2.0 * point.x, r = std::sqrt(std::max(0.0, 1.0 - z * z));
    const double angle = 2.0 * double(kPi) * point.y;
    return glm::vec3(r * std::cos(angle), r * std::sin(angle), z);
}

// Where a path begins: a point of free space, or a light.
struct Origin {
    const glm::vec3* point = nullptr;
    const LightRays* light = nullptr;
    std::uint64_t stream = 0;
    std::uint32_t index = 0;  // of the path among those of its origin
};

LightRay firstRay(const Origin& origin, Sampler& sampler) {
    const glm::dvec2 place = sampler.nextFine();
    return origin.light != nullptr ? origin.light->at(place) : LightRay{*origin.point, anyDirection(place)};
}

// Paths dealt out evenly, the first origins taking what is left over.
template <class Make>
void dealPaths(std::vector<Origin>& origins, std::size_t count, int paths, const Make& make) {
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t share = std::size_t(paths) / count + (i < std::size_t(paths) % count ? 1 : 0);
        for (std::size_t k = 0; k < share; ++k) origins.push_back(make(i, std::uint32_t(k)));
    }
}

}  // namespace

std::vector<glm::vec3> exploreFreeSpace(const RayScene& scene, const glm::vec3& from, int count,
                                        std::uint64_t seed) {
    std::vector<glm::vec3> points{from};
    while (int(points.size()) < count) {
        const glm::vec3& here = points.back();
        bool isFound = false;
        for (int attempt = 0; attempt < kTries && !isFound; ++attempt) {
            Sampler sampler(seed, kWalkStream + points.size(), std::uint32_t(attempt));
            const glm::vec3 direction = anyDirection(sampler.nextFine());
            Hit hit;
            if (!scene.trace(here, direction, 0.0f, kFar, hit)) continue;
            points.push_back(here + direction * (0.5f * hit.distance));
            isFound = true;
        }
        if (!isFound)
            throw std::runtime_error(
                fmt::format("free space from {}, {}, {}: expected a place that surfaces surround, got one at "
                            "{}, {}, {} that sees none",
                            from.x, from.y, from.z, here.x, here.y, here.z));
    }
    return points;
}

std::vector<SurfaceHit> findSurfaces(const RayScene& scene, const std::vector<glm::vec3>& points,
                                     const PathOptions& options) {
    std::vector<LightRays> lights;
    for (const Light& light : scene.lights()) lights.emplace_back(scene, light);
    std::vector<Origin> origins;
    dealPaths(origins, points.size(), options.paths, [&](std::size_t i, std::uint32_t k) {
        return Origin{&points[i], nullptr, kPointStream + i, k};
    });
    dealPaths(origins, lights.size(), options.lightPaths, [&](std::size_t i, std::uint32_t k) {
        return Origin{nullptr, &lights[i], kLightStream + i, k};
    });

    std::vector<std::vector<SurfaceHit>> found(origins.size());
    const auto report = [&](std::size_t begun) {
        if (options.progress) options.progress(double(begun) / double(origins.size()));
    };
    parallelFor(
        origins.size(), options.threads,
        [&](std::size_t path) {
            Sampler sampler(options.seed, origins[path].stream, origins[path].index);
            LightRay ray = firstRay(origins[path], sampler);
            for (int depth = 0; depth < options.depth; ++depth) {
                Hit hit;
                if (!scene.trace(ray.origin, ray.direction, 0.0f, kFar, hit)) break;
                const Mesh& mesh = scene.scene().meshes[std::size_t(hit.mesh)];
                found[path].push_back({hit.position, hit.normal, hit.albedo, mesh.object});
                ray = {scene.offset(hit.position, hit.geometricNormal),
                       sampleCosine(hit.geometricNormal, sampler.next())};
            }
        },
        report);

    std::vector<SurfaceHit> hits;
    for (const auto& path : found) hits.insert(hits.end(), path.begin(), path.end());
    return hits;
}

}  // namespace studio
