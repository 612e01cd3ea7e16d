// The rival's calls of Embree, for both of its versions: 16 rays at a time or one by one.
#include "rival_rays.h"

#include <limits>

#if STUDIO_EMBREE4  // set by the build: the major version that it found
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace studio {
namespace {

static_assert(kNoMesh == RTC_INVALID_GEOMETRY_ID, "PathBatch::mesh takes over Embree's numbers");
constexpr int kLanes = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

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
        b.mesh[i] = kNoMesh;
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

}  // namespace

void intersectPaths(RTCSceneTy* scene, PathBatch& batch, bool asPackets) {
    if (asPackets)
        intersectPackets(scene, batch);
    else
        intersectSingly(scene, batch);
}

void findLit(RTCSceneTy* scene, ShadowBatch& s, bool asPackets) {
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

void findGlowing(RTCSceneTy* scene, ShadowBatch& s, bool asPackets) {
    Context context;
    if (!asPackets) {
        RTCRayHit ray;
        for (int i = 0; i < s.count; ++i) {
            fillRay(ray.ray, s.origin, s.direction, i);
            ray.ray.tfar = kInfinity;
            ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            find1(scene, context, &ray);
            s.lit[i] = ray.hit.geomID == s.mesh[i] && ray.hit.primID == s.primitive[i];
        }
        return;
    }
    RTCRayHit16 packet;
    for (int first = 0; first < s.count; first += kLanes) {
        fillRays(packet.ray, s.origin, s.direction, first);
        alignas(64) int valid[kLanes];
        for (int i = 0; i < kLanes; ++i) {
            valid[i] = first + i < s.count ? -1 : 0;
            packet.ray.tfar[i] = kInfinity;
            packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        find16(valid, scene, context, &packet);
        for (int i = 0; i < kLanes; ++i)
            s.lit[first + i] = packet.hit.geomID[i] == s.mesh[first + i] &&
                               packet.hit.primID[i] == s.primitive[first + i];
    }
}

}  // namespace studio
