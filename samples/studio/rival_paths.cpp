// Path tracing of diffuse surfaces, a segment at a time for a whole batch.
//
// Source: J. Kajiya 1986, as integrator.cpp (the reference) has it: with cosine-distributed directions a
// path with vertices y_1 ... y_k of albedos rho_1 ... rho_k brings rho_1 ... rho_k E_direct(y_k) to
// bounce k. Punctual lights are asked at every vertex with a shadow ray each; emissive surfaces by one
// point and by the path's own next ray, joined by the balance heuristic; the sky by that ray alone.
// Wavefronts instead of whole paths: S. Laine, T. Karras, T. Aila, "Megakernels Considered Harmful"
// (2013).
//
// Over 300 lines: the steps of one segment share the batch's planes and the small helpers on them. The calls of
// Embree (packets and single rays) are the part that would stand alone first.
#include "rival_paths.h"

#include <cmath>
#include <limits>

#if STUDIO_EMBREE4  // set by the build: the major version that it found
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "sampler.h"
#include "simd_clones.h"

namespace studio {
namespace {

constexpr int kLanes = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kQuarterPi = 0.78539816339744831f;
constexpr float kInversePi = 0.31830988618379067f;

float largest(const glm::vec3& c) {
    return std::max(c.x, std::max(c.y, c.z));
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

// What one light would bring to every vertex with nothing between.
struct Arrivals {
    alignas(64) float direction[3][PathBatch::kSize], reach[PathBatch::kSize];
    alignas(64) float strength[PathBatch::kSize];  // times Light::emitted; 0: nothing arrives
};

STUDIO_SIMD void sunArrivals(const PathBatch& b, const float* toLight, Arrivals& to) {
    for (int i = 0; i < b.count; ++i) {
        float cosine = 0.0f, side = 0.0f;
        for (int c = 0; c < 3; ++c) {
            cosine += b.normal[c][i] * toLight[c];
            side += b.face[c][i] * toLight[c];
            to.direction[c][i] = toLight[c];
        }
        to.reach[i] = kInfinity;
        to.strength[i] = cosine > 0.0f && side > 0.0f ? cosine : 0.0f;
    }
}

// `scale`, `shift`: of the cosine off the axis, to the ramp between the cones.
STUDIO_SIMD void lampArrivals(const PathBatch& b, const float* position, const float* axis, float scale,
                              float shift, Arrivals& to) {
    for (int i = 0; i < b.count; ++i) {
        const float x = position[0] - b.position[0][i], y = position[1] - b.position[1][i],
                    z = position[2] - b.position[2][i];
        const float squared = x * x + y * y + z * z;
        const float inverse = squared > 0.0f ? 1.0f / std::sqrt(squared) : 0.0f;
        const float lx = x * inverse, ly = y * inverse, lz = z * inverse;
        to.direction[0][i] = lx;
        to.direction[1][i] = ly;
        to.direction[2][i] = lz;
        to.reach[i] = squared * inverse * (1.0f - RayScene::kLightGap);
        const float cosine = b.normal[0][i] * lx + b.normal[1][i] * ly + b.normal[2][i] * lz;
        const float side = b.face[0][i] * lx + b.face[1][i] * ly + b.face[2][i] * lz;
        float ramp = shift - scale * (axis[0] * lx + axis[1] * ly + axis[2] * lz);
        ramp = ramp > 0.0f ? ramp : 0.0f;
        ramp = ramp < 1.0f ? ramp : 1.0f;
        to.strength[i] = cosine > 0.0f && side > 0.0f ? cosine * ramp * ramp * inverse * inverse : 0.0f;
    }
}

void arrivals(const Light& light, const PathBatch& batch, Arrivals& to) {
    if (light.kind == LightKind::Sun) {
        const glm::vec3 toLight = -light.direction;
        sunArrivals(batch, &toLight.x, to);
        return;
    }
    float scale = 0.0f, shift = 1.0f;
    if (light.kind == LightKind::Spot) {
        const float outer = std::cos(light.outerCone), inner = std::cos(light.innerCone);
        // Cones that coincide: a step, as steep as floats tell angles apart.
        scale = 1.0f / std::max(inner - outer, 1e-6f);
        shift = -outer * scale;
    }
    lampArrivals(batch, &light.position.x, &light.direction.x, scale, shift, to);
}

template <class Packet>
void fillRays(Packet& ray, const float (&origin)[3][PathBatch::kSize],
              const float (&direction)[3][PathBatch::kSize], int first) {
    for (int i = 0; i < kLanes; ++i) {
        ray.org_x[i] = origin[0][first + i];
        ray.org_y[i] = origin[1][first + i];
        ray.org_z[i] = origin[2][first + i];
        ray.dir_x[i] = direction[0][first + i];
        ray.dir_y[i] = direction[1][first + i];
        ray.dir_z[i] = direction[2][first + i];
        ray.tnear[i] = 0.0f;
        ray.time[i] = 0.0f;
        ray.mask[i] = ~0u;
        ray.id[i] = ray.flags[i] = 0;
    }
}

template <class Ray>
void fillRay(Ray& ray, const float (&origin)[3][PathBatch::kSize],
             const float (&direction)[3][PathBatch::kSize], int i) {
    ray.org_x = origin[0][i], ray.org_y = origin[1][i], ray.org_z = origin[2][i];
    ray.dir_x = direction[0][i], ray.dir_y = direction[1][i], ray.dir_z = direction[2][i];
    ray.tnear = ray.time = 0.0f;
    ray.mask = ~0u;
    ray.id = ray.flags = 0;
}

#if STUDIO_EMBREE4
struct Context {};
void find16(const int* valid, RTCScene scene, Context&, RTCRayHit16* ray) {
    rtcIntersect16(valid, scene, ray, nullptr);
}
void find1(RTCScene scene, Context&, RTCRayHit* ray) {
    rtcIntersect1(scene, ray, nullptr);
}
void block16(const int* valid, RTCScene scene, Context&, RTCRay16* ray) {
    rtcOccluded16(valid, scene, ray, nullptr);
}
void block1(RTCScene scene, Context&, RTCRay* ray) {
    rtcOccluded1(scene, ray, nullptr);
}
#else
struct Context : RTCIntersectContext {
    Context() { rtcInitIntersectContext(this); }
};
void find16(const int* valid, RTCScene scene, Context& context, RTCRayHit16* ray) {
    rtcIntersect16(valid, scene, &context, ray);
}
void find1(RTCScene scene, Context& context, RTCRayHit* ray) {
    rtcIntersect1(scene, &context, ray);
}
void block16(const int* valid, RTCScene scene, Context& context, RTCRay16* ray) {
    rtcOccluded16(valid, scene, &context, ray);
}
void block1(RTCScene scene, Context& context, RTCRay* ray) {
    rtcOccluded1(scene, &context, ray);
}
#endif

void intersectPackets(RTCScene scene, PathBatch& b) {
    Context context;
    RTCRayHit16 packet;
    for (int first = 0; first < b.count; first += kLanes) {
        fillRays(packet.ray, b.position, b.direction, first);
        alignas(64) int valid[kLanes];
        for (int i = 0; i < kLanes; ++i) {
            valid[i] = first + i < b.count ? b.alive[first + i] : 0;
            packet.ray.tfar[i] = kInfinity;
            packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        find16(valid, scene, context, &packet);
        for (int i = 0; i < kLanes; ++i) {
            const int to = first + i;
            b.distance[to] = packet.ray.tfar[i];
            b.hitFace[0][to] = packet.hit.Ng_x[i];
            b.hitFace[1][to] = packet.hit.Ng_y[i];
            b.hitFace[2][to] = packet.hit.Ng_z[i];
            b.u[to] = packet.hit.u[i];
            b.v[to] = packet.hit.v[i];
            b.mesh[to] = packet.hit.geomID[i];
            b.primitive[to] = packet.hit.primID[i];
        }
    }
}

void intersectSingly(RTCScene scene, PathBatch& b) {
    Context context;
    RTCRayHit ray;
    for (int i = 0; i < b.count; ++i) {
        b.mesh[i] = RTC_INVALID_GEOMETRY_ID;
        if (b.alive[i] == 0) continue;
        fillRay(ray.ray, b.position, b.direction, i);
        ray.ray.tfar = kInfinity;
        ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        find1(scene, context, &ray);
        b.distance[i] = ray.ray.tfar;
        b.hitFace[0][i] = ray.hit.Ng_x;
        b.hitFace[1][i] = ray.hit.Ng_y;
        b.hitFace[2][i] = ray.hit.Ng_z;
        b.u[i] = ray.hit.u;
        b.v[i] = ray.hit.v;
        b.mesh[i] = ray.hit.geomID;
        b.primitive[i] = ray.hit.primID;
    }
}

void findLit(RTCScene scene, ShadowBatch& s, bool asPackets) {
    Context context;
    if (!asPackets) {
        RTCRay ray;
        for (int i = 0; i < s.count; ++i) {
            fillRay(ray, s.origin, s.direction, i);
            ray.tfar = s.reach[i];
            block1(scene, context, &ray);
            s.lit[i] = ray.tfar >= 0.0f;
        }
        return;
    }
    RTCRay16 packet;
    for (int first = 0; first < s.count; first += kLanes) {
        fillRays(packet, s.origin, s.direction, first);
        alignas(64) int valid[kLanes];
        for (int i = 0; i < kLanes; ++i) {
            valid[i] = first + i < s.count ? -1 : 0;
            packet.tfar[i] = s.reach[first + i];
        }
        block16(valid, scene, context, &packet);
        for (int i = 0; i < kLanes; ++i) s.lit[first + i] = packet.tfar[i] >= 0.0f;
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

void RivalPaths::intersect() {
    RTCScene embree = scene_->rays().embree();
    if (asPackets_)
        intersectPackets(embree, *batch_);
    else
        intersectSingly(embree, *batch_);
    rays += std::uint64_t(batch_->count);
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
        if (b.mesh[i] == RTC_INVALID_GEOMETRY_ID) {
            if (bounce > 0) add(sums, b.target[i], throughput * kPi * sky);
            continue;
        }
        const RivalTriangle& triangle = scene_->triangle(b.mesh[i], b.primitive[i]);
        const glm::vec3 direction = at(b.direction, i);
        glm::vec3 face = glm::normalize(at(b.hitFace, i));
        const float facing = glm::dot(face, direction);
        if (facing > 0.0f) face = -face;

        const glm::vec3& emission = scene_->emission(triangle);
        if (bounce > 0 && largest(emission) > 0.0f) {
            const float byRay = std::abs(facing) * glm::dot(at(b.normal, i), direction) * kInversePi;
            const float byLamp = emitters.areaDensity(emission) * b.distance[i] * b.distance[i];
            add(sums, b.target[i], throughput * emission * (kPi * byRay / (byRay + byLamp)));
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

void RivalPaths::connect(float* const sums[3]) {
    findLit(scene_->rays().embree(), shadow_, asPackets_);
    shadowRays += std::uint64_t(shadow_.count);
    for (int i = 0; i < shadow_.count; ++i)
        if (shadow_.lit[i]) add(sums, shadow_.target[i], at(shadow_.irradiance, i));
}

void RivalPaths::punctualLights(float* const sums[3]) {
    PathBatch& b = *batch_;
    Arrivals found;
    const std::vector<Light>& lights = scene_->rays().lights();
    for (std::size_t l = 0; l < lights.size(); ++l) {
        const Light& light = lights[l];
        arrivals(light, b, found);
        shadow_.count = 0;
        for (int i = 0; i < b.count; ++i) {
            if (found.strength[i] <= 0.0f) continue;
            // What connections to lit points leave to rays: the balance heuristic, as in integrator.cpp.
            float share = found.strength[i];
            if (litPoints_ != nullptr)
                share /=
                    1.0f + litPoints_->density(l, at(b.position, i), at(b.face, i)) / b.rayDensity[i];
            const int to = shadow_.count++;
            for (int c = 0; c < 3; ++c) {
                shadow_.origin[c][to] = b.position[c][i];
                shadow_.direction[c][to] = found.direction[c][i];
                shadow_.irradiance[c][to] = b.throughput[c][i] * light.emitted[c] * share;
            }
            shadow_.reach[to] = found.reach[i];
            shadow_.target[to] = b.target[i];
        }
        connect(sums);
    }
}

// One point on the emitters for each vertex; the other share of the light comes with the next ray.
void RivalPaths::emitters(float* const sums[3]) {
    const PathBatch& b = *batch_;
    shadow_.count = 0;
    for (int i = 0; i < b.count; ++i) {
        const AreaLights::Point lamp = scene_->emitters().pick({b.point[0][i], b.point[1][i]});
        const glm::vec3 origin = at(b.position, i), way = lamp.position - origin;
        const float squared = glm::dot(way, way);
        if (squared <= 0.0f) continue;
        const glm::vec3 direction = way / std::sqrt(squared);
        const float cosine = glm::dot(at(b.normal, i), direction);
        const float side = glm::dot(lamp.normal, direction);
        if (cosine <= 0.0f || side == 0.0f || glm::dot(at(b.face, i), direction) <= 0.0f) continue;
        if (scene_->isHole(lamp.mesh, lamp.triangle, lamp.weights)) continue;
        const glm::vec3& emission =
            scene_->emission(scene_->triangle(unsigned(lamp.mesh), unsigned(lamp.triangle)));
        const glm::vec3 end =
            scene_->rays().offset(lamp.position, side > 0.0f ? -lamp.normal : lamp.normal);
        const float reach = glm::length(end - origin);
        if (reach <= 0.0f) continue;
        const float byRay = cosine * std::abs(side) * kInversePi,
                    byLamp = scene_->emitters().areaDensity(emission) * squared;
        const int to = shadow_.count++;
        put(shadow_.origin, to, origin);
        put(shadow_.direction, to, (end - origin) / reach);
        put(shadow_.irradiance, to, at(b.throughput, i) * emission * (kPi * byRay / (byRay + byLamp)));
        shadow_.reach[to] = reach;
        shadow_.target[to] = b.target[i];
    }
    connect(sums);
}

// Each vertex is joined to one place that a lamp shines on, found by a ray from the lamp: where the lamp
// lights little that matters, few of the path's own rays would meet it.
void RivalPaths::litPoints(float* const sums[3]) {
    const PathBatch& b = *batch_;
    shadow_.count = 0;
    for (int i = 0; i < b.count; ++i) {
        LitPoints::Point found;
        if (!litPoints_->sample({b.point[0][i], b.point[1][i]}, found)) continue;
        const Surface& lit = found.surface;
        const glm::vec3 origin = at(b.position, i);
        const glm::vec3 way = scene_->rays().offset(lit.position, lit.geometricNormal) - origin;
        const float squared = glm::dot(way, way), distance = std::sqrt(squared);
        if (squared <= 0.0f) continue;
        const glm::vec3 direction = way / distance;
        const float cosine = glm::dot(at(b.normal, i), direction);
        const float litCosine = -glm::dot(lit.geometricNormal, direction);
        if (cosine <= 0.0f || litCosine <= 0.0f || glm::dot(at(b.face, i), direction) <= 0.0f) continue;
        const LightArrival lamp = arrivalOf(scene_->rays().lights()[found.light], lit.position);
        const float lampCosine = glm::dot(lit.normal, lamp.toLight);
        if (lampCosine <= 0.0f) continue;
        const float byRay = cosine * litCosine * kInversePi / squared;
        const int to = shadow_.count++;
        put(shadow_.origin, to, origin);
        put(shadow_.direction, to, direction);
        put(shadow_.irradiance, to,
            at(b.throughput, i) * found.albedo * lamp.irradiance *
                (lampCosine * byRay / (byRay + found.density)));
        shadow_.reach[to] = distance;
        shadow_.target[to] = b.target[i];
    }
    rays += std::uint64_t(b.count);
    connect(sums);
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
        intersect();
        shade(segment, sums);
        if (segment == bounces_) break;
        punctualLights(sums);
        if (!hasEmitters) continue;
        draw(seed, 3 * segment + 1);
        emitters(sums);
    }
}

}  // namespace studio
