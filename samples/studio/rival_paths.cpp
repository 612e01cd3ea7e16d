// Path tracing of diffuse surfaces, a segment at a time for a whole batch.
//
// Source: J. Kajiya 1986, as integrator.cpp (the reference) has it: with cosine-distributed directions a
// path with vertices y_1 ... y_k of albedos rho_1 ... rho_k brings rho_1 ... rho_k E_direct(y_k) to
// bounce k. Punctual lights are asked at every vertex with a shadow ray each; emissive surfaces by one
// point and by the path's own next ray, joined by the balance heuristic; the sky by that ray alone.
// Wavefronts instead of whole paths: S. Laine, T. Karras, T. Aila, "Megakernels Considered Harmful"
// (2013).
#include "rival_paths.h"

#include <algorithm>
#include <cmath>

#include "rival_arrivals.h"
#include "rival_rays.h"
#include "sampler.h"
#include "simd_clones.h"

namespace studio {
namespace {

constexpr float kQuarterPi = 0.78539816339744831f;
constexpr float kInversePi = 0.31830988618379067f;

float largest(const glm::vec3& c) {
    return std::max(c.x, std::max(c.y, c.z));
}

// The square of a small triangle's area is beyond floats.
glm::vec3 unitOf(const glm::vec3& v) {
    const glm::vec3 sizes = glm::abs(v);
    const glm::vec3 scaled = v / largest(sizes);
    return scaled / glm::length(scaled);
}

// Owen-scrambled Sobol points of this pair of dimensions, as sampler.h makes them.
STUDIO_SIMD void drawPoints(const std::uint32_t* index, int count, std::uint64_t a, std::uint64_t b,
                            float* u, float* v) {
    const auto shuffle = std::uint32_t(a), first = std::uint32_t(a >> 32), second = std::uint32_t(b);
    for (int i = 0; i < count; ++i) {
        const std::uint32_t at = reverseBits(permuteUpwards(reverseBits(index[i]), shuffle));
        const std::uint32_t x = reverseBits(permuteUpwards(at, first));
        const std::uint32_t y = reverseBits(permuteUpwards(sobolSecondReversed(at), second));
        u[i] = float(std::int32_t(x >> 8)) * (1.0f / 16777216.0f);
        v[i] = float(std::int32_t(y >> 8)) * (1.0f / 16777216.0f);
    }
}

// Cosine-distributed directions by the concentric map (Shirley and Chiu 1997) in the frame of Duff et
// al. 2017; sine and cosine by their series, whose angle never passes pi / 4 (error 3e-7).
STUDIO_SIMD void chooseDirections(PathBatch& b) {
    for (int i = 0; i < b.count; ++i) {
        const float px = 2.0f * b.point[0][i] - 1.0f, py = 2.0f * b.point[1][i] - 1.0f;
        const bool isWide = std::abs(px) > std::abs(py);
        const float radius = isWide ? px : py, other = isWide ? py : px;
        const float angle = radius != 0.0f ? kQuarterPi * (other / radius) : 0.0f;
        const float a2 = angle * angle;
        const float cosine =
            1.0f + a2 * (-0.5f + a2 * (1.0f / 24.0f + a2 * (-1.0f / 720.0f + a2 * (1.0f / 40320.0f))));
        const float sine =
            angle * (1.0f + a2 * (-1.0f / 6.0f + a2 * (1.0f / 120.0f + a2 * (-1.0f / 5040.0f))));
        const float x = radius * (isWide ? cosine : sine), y = radius * (isWide ? sine : cosine);
        const float z2 = 1.0f - x * x - y * y;
        const float z = std::sqrt(z2 > 0.0f ? z2 : 0.0f);

        const float nx = b.normal[0][i], ny = b.normal[1][i], nz = b.normal[2][i];
        const float sign = nz < 0.0f ? -1.0f : 1.0f;
        const float a = -1.0f / (sign + nz), c = nx * ny * a;
        const float dx = x * (1.0f + sign * nx * nx * a) + y * c + z * nx;
        const float dy = x * (sign * c) + y * (sign + ny * ny * a) + z * ny;
        const float dz = x * (-sign * nx) + y * (-ny) + z * nz;
        b.direction[0][i] = dx;
        b.direction[1][i] = dy;
        b.direction[2][i] = dz;
        // Above the shading normal's horizon but under the surface: its own body blocks the ray.
        const float above = dx * b.face[0][i] + dy * b.face[1][i] + dz * b.face[2][i];
        b.alive[i] = above > 0.0f ? -1 : 0;
    }
}

glm::vec3 at(const float (&planes)[3][PathBatch::kSize], int i) {
    return {planes[0][i], planes[1][i], planes[2][i]};
}

void put(float (&planes)[3][PathBatch::kSize], int i, const glm::vec3& value) {
    for (int c = 0; c < 3; ++c) planes[c][i] = value[c];
}

void add(float* const sums[3], int target, const glm::vec3& value) {
    for (int c = 0; c < 3; ++c) sums[c][target] += value[c];
}

}  // namespace

void RivalPaths::draw(std::uint64_t seed, int pair) {
    const std::uint64_t base = mixBits(seed + 1);
    drawPoints(batch_->index, batch_->count, mixBits(base + 2 * std::uint64_t(pair)),
               mixBits(base + 2 * std::uint64_t(pair) + 1), batch_->point[0], batch_->point[1]);
}

// Paths that met a surface move there and close ranks; `bounce`: of the vertex that they leave.
void RivalPaths::shade(int bounce, float* const sums[3]) {
    PathBatch& b = *batch_;
    const glm::vec3 sky = scene_->rays().scene().sky;
    const AreaLights& emitters = scene_->emitters();
    const float floor = scene_->rays().offsetFloor();
    int kept = 0;
    for (int i = 0; i < b.count; ++i) {
        if (b.alive[i] == 0) continue;
        glm::vec3 throughput = at(b.throughput, i);
        if (b.mesh[i] == kNoMesh) {
            if (bounce > 0) add(sums, b.target[i], throughput * kPi * sky);
            continue;
        }
        const RivalTriangle& triangle = scene_->triangle(b.mesh[i], b.primitive[i]);
        const glm::vec3 direction = at(b.direction, i);
        glm::vec3 face = unitOf(at(b.hitFace, i));
        const float facing = glm::dot(face, direction);
        if (facing > 0.0f) face = -face;

        const glm::vec3& emission = scene_->emission(triangle);
        if (bounce > 0 && largest(emission) > 0.0f) {
            const float byRay = std::abs(facing) * glm::dot(at(b.normal, i), direction) * kInversePi;
            const float byLamp = emitters.areaDensity(emission) * b.distance[i] * b.distance[i];
            add(sums, b.target[i], throughput * emission * (kPi * rayShare(byRay, byLamp)));
        }
        if (bounce == bounces_) continue;

        const float density = std::abs(facing) * glm::dot(at(b.normal, i), direction) * kInversePi /
                              (b.distance[i] * b.distance[i]);
        const float u = b.u[i], v = b.v[i], w = 1.0f - u - v;
        throughput *= scene_->albedo(triangle, u, v);
        if (largest(throughput) <= 0.0f) continue;
        glm::vec3 normal;
        for (int c = 0; c < 3; ++c)
            normal[c] =
                triangle.normals[0][c] * w + triangle.normals[1][c] * u + triangle.normals[2][c] * v;
        const float squared = glm::dot(normal, normal);
        normal = squared > 1e-12f ? normal / std::sqrt(squared) : face;
        if (glm::dot(normal, face) < 0.0f) normal = -normal;
        const glm::vec3 position = at(b.position, i) + direction * b.distance[i];
        const float size = std::max(std::max(std::abs(position.x), std::abs(position.y)),
                                    std::max(std::abs(position.z), floor));
        put(b.position, kept, position + face * (RayScene::kRelativeOffset * size));
        put(b.face, kept, face);
        put(b.normal, kept, normal);
        put(b.throughput, kept, throughput);
        b.rayDensity[kept] = density;
        b.index[kept] = b.index[i];
        b.target[kept] = b.target[i];
        ++kept;
    }
    b.count = kept;
}

void RivalPaths::queue(int vertex, const glm::vec3& direction, float reach,
                       const glm::vec3& irradiance) {
    const int to = shadow_.count++;
    put(shadow_.origin, to, at(batch_->position, vertex));
    put(shadow_.direction, to, direction);
    put(shadow_.irradiance, to, irradiance);
    shadow_.reach[to] = reach;
    shadow_.target[to] = batch_->target[vertex];
}

// What arrives of the queued rays, whose `lit` is known.
void RivalPaths::addLit(float* const sums[3]) {
    shadowRays += std::uint64_t(shadow_.count);
    for (int i = 0; i < shadow_.count; ++i)
        if (shadow_.lit[i]) add(sums, shadow_.target[i], at(shadow_.irradiance, i));
    shadow_.count = 0;
}

RivalPaths::Link RivalPaths::linkTo(int vertex, const glm::vec3& position) const {
    Link link;
    const glm::vec3 way = position - at(batch_->position, vertex);
    link.squared = glm::dot(way, way);
    if (link.squared <= 0.0f) return link;
    link.distance = std::sqrt(link.squared);
    link.direction = way / link.distance;
    if (glm::dot(at(batch_->face, vertex), link.direction) <= 0.0f) return link;
    link.cosine = std::max(0.0f, glm::dot(at(batch_->normal, vertex), link.direction));
    return link;
}

void RivalPaths::punctualLights(float* const sums[3]) {
    const PathBatch& b = *batch_;
    Arrivals found;
    const std::vector<Light>& lights = scene_->rays().lights();
    for (std::size_t l = 0; l < lights.size(); ++l) {
        findArrivals(lights[l], b, found);
        for (int i = 0; i < b.count; ++i) {
            if (found.strength[i] <= 0.0f) continue;
            // What connections to lit points leave to rays: the balance heuristic, as in integrator.cpp.
            float share = found.strength[i];
            if (litPoints_ != nullptr)
                share *=
                    rayShare(b.rayDensity[i], litPoints_->density(l, at(b.position, i), at(b.face, i)));
            queue(i, at(found.direction, i), found.reach[i],
                  at(b.throughput, i) * lights[l].emitted * share);
        }
        findLit(scene_->rays().embree(), shadow_, asPackets_);
        addLit(sums);
    }
}

// One point on the emitters for each vertex; the other share of the light comes with the next ray.
void RivalPaths::emitters(float* const sums[3]) {
    const PathBatch& b = *batch_;
    for (int i = 0; i < b.count; ++i) {
        const AreaLights::Point lamp = scene_->emitters().pick({b.point[0][i], b.point[1][i]});
        const Link link = linkTo(i, lamp.position);
        const float side = std::abs(glm::dot(lamp.normal, link.direction));
        if (link.cosine <= 0.0f || side <= 0.0f) continue;
        const glm::vec3& emission =
            scene_->emission(scene_->triangle(unsigned(lamp.mesh), unsigned(lamp.triangle)));
        const float byRay = link.cosine * side * kInversePi,
                    byLamp = scene_->emitters().areaDensity(emission) * link.squared;
        shadow_.mesh[shadow_.count] = std::uint32_t(lamp.mesh);
        shadow_.primitive[shadow_.count] = std::uint32_t(lamp.triangle);
        queue(i, link.direction, link.distance,
              at(b.throughput, i) * emission * (kPi * rayShare(byRay, byLamp)));
    }
    findGlowing(scene_->rays().embree(), shadow_, asPackets_);
    addLit(sums);
}

// Each vertex is joined to one place that a lamp shines on, found by a ray from the lamp: where the lamp
// lights little that matters, few of the path's own rays would meet it.
void RivalPaths::litPoints(float* const sums[3]) {
    const PathBatch& b = *batch_;
    for (int i = 0; i < b.count; ++i) {
        LitPoints::Point found;
        if (!litPoints_->sample({b.point[0][i], b.point[1][i]}, found)) continue;
        const Surface& lit = found.surface;
        const Link link = linkTo(i, scene_->rays().offset(lit.position, lit.geometricNormal));
        const float litCosine = -glm::dot(lit.geometricNormal, link.direction);
        if (link.cosine <= 0.0f || litCosine <= 0.0f) continue;
        const LightArrival lamp = arrivalOf(scene_->rays().lights()[found.light], lit.position);
        const float lampCosine = glm::dot(lit.normal, lamp.toLight);
        if (lampCosine <= 0.0f) continue;
        const float byRay = link.cosine * litCosine * kInversePi / link.squared;
        queue(i, link.direction, link.distance,
              at(b.throughput, i) * found.albedo * lamp.irradiance *
                  (lampCosine * rayShare(byRay, found.density)));
    }
    rays += std::uint64_t(b.count);
    findLit(scene_->rays().embree(), shadow_, asPackets_);
    addLit(sums);
}

void RivalPaths::trace(const RivalScene& scene, const LitPoints* litPoints, std::uint64_t seed,
                       PathBatch& batch, float* const sums[3]) {
    scene_ = &scene;
    litPoints_ = litPoints;
    batch_ = &batch;
    const bool hasEmitters = !scene.emitters().empty();
    const int segments = bounces_ + (hasEmitters || scene.hasSky() ? 1 : 0);
    for (int segment = 0; segment < segments && batch.count > 0; ++segment) {
        if (litPoints_ != nullptr && segment < bounces_) {
            draw(seed, 3 * segment + 2);
            this->litPoints(sums);
        }
        draw(seed, 3 * segment);
        chooseDirections(batch);
        intersectPaths(scene.rays().embree(), batch, asPackets_);
        rays += std::uint64_t(batch.count);
        shade(segment, sums);
        if (segment == bounces_) break;
        punctualLights(sums);
        if (!hasEmitters) continue;
        draw(seed, 3 * segment + 1);
        emitters(sums);
    }
}

}  // namespace studio
