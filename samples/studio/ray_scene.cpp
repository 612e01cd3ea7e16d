// The scene in Embree (3.13, or 4 with the few names that changed) at one time.
//
// Surfaces are double-sided: normals are turned to the ray's side. Alpha masks are cut by a filter on
// both kinds of ray, so that shadows have holes where the picture has. All biases are relative to
// coordinates or to the scene's diagonal, so a scene in other units gives the same picture.
// A few lines over 300: all that touches Embree's scene is here, so that no other file of the studio needs it but the rival.
#include "ray_scene.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#if STUDIO_EMBREE4  // set by the build: the major version that it found
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace studio {
namespace {

// Ray origins move off their surface by kRelativeOffset of their largest coordinate, or of the diagonal
// where that is larger times kDiagonalShare. A float's spacing is 6e-8 of its value and a hit carries
// a few roundings: a tenth of it begins to show acne, ten times as much detaches contact shadows.
constexpr float kDiagonalShare = 0.1f;

struct WorldMesh {
    const Mesh* mesh = nullptr;
    const Material* material = nullptr;
    const Texture* texture = nullptr;  // base colour and alpha, or null
    glm::mat4 pose{1.0f};
    bool moved = false;
    glm::vec3 point(unsigned vertex) const {
        const glm::vec3& p = mesh->positions[vertex];
        return moved ? glm::vec3(pose * glm::vec4(p, 1.0f)) : p;
    }
};

template <class T>
T interpolate(const std::vector<T>& values, const glm::uvec3& t, float u, float v) {
    return values[t.x] * (1.0f - u - v) + values[t.y] * u + values[t.z] * v;
}

void alphaFilter(const RTCFilterFunctionNArguments* args) {
    const auto* world = static_cast<const WorldMesh*>(args->geometryUserPtr);
    for (unsigned i = 0; i < args->N; ++i) {
        if (args->valid[i] != -1) continue;
        const unsigned primitive = RTCHitN_primID(args->hit, args->N, i);
        const float u = RTCHitN_u(args->hit, args->N, i), v = RTCHitN_v(args->hit, args->N, i);
        const glm::vec2 uv = interpolate(world->mesh->uvs, world->mesh->triangles[primitive], u, v);
        if (world->texture->lookup(uv).a < world->material->alphaCutoff) args->valid[i] = 0;
    }
}

void setRay(RTCRay& ray, const glm::vec3& o, const glm::vec3& d, float from, float to) {
    ray.org_x = o.x, ray.org_y = o.y, ray.org_z = o.z;
    ray.dir_x = d.x, ray.dir_y = d.y, ray.dir_z = d.z;
    ray.tnear = from;
    ray.tfar = to;
    ray.time = 0.0f;
    ray.mask = ~0u;
    ray.id = ray.flags = 0;
}

void checkDevice(RTCDevice device, const std::string& what) {
    const RTCError error = rtcGetDeviceError(device);
    if (error != RTC_ERROR_NONE)
        throw std::runtime_error(fmt::format("Embree: {}: error {}", what, int(error)));
}

// Fourth powers of distances appear in estimates of light: beyond these sizes floats can't hold them.
constexpr double kSmallestDiagonal = 1e-8, kLargestDiagonal = 1e9;

float diagonalOf(RTCScene scene, const std::string& name) {
    RTCBounds b;
    rtcGetSceneBounds(scene, &b);
    if (!(b.lower_x <= b.upper_x))  // bounds of nothing
        throw std::runtime_error(
            fmt::format("scene \"{}\": expected at least one triangle, coordinates below 1e18", name));
    const double diagonal = glm::length(glm::dvec3(b.upper_x, b.upper_y, b.upper_z) -
                                        glm::dvec3(b.lower_x, b.lower_y, b.lower_z));
    if (!(diagonal >= kSmallestDiagonal && diagonal <= kLargestDiagonal))
        throw std::runtime_error(
            fmt::format("scene \"{}\": expected a bounding box of diagonal {} to {} m, got {}", name,
                        kSmallestDiagonal, kLargestDiagonal, diagonal));
    return float(diagonal);
}

}  // namespace

struct RayScene::Impl {
    std::shared_ptr<const Scene> scene;
    float time = 0.0f, diagonal = 0.0f;
    std::uint64_t number = 0;
    std::vector<WorldMesh> meshes;
    std::vector<Light> lights;
    RTCDevice device = nullptr;
    RTCScene embree = nullptr;

    ~Impl() {
        if (embree != nullptr) rtcReleaseScene(embree);
        if (device != nullptr) rtcReleaseDevice(device);
    }
    void addMesh(unsigned id);
};

void RayScene::Impl::addMesh(unsigned id) {
    WorldMesh& world = meshes[id];
    const Mesh& mesh = *world.mesh;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), mesh.positions.size()));
    auto* indices = static_cast<glm::uvec3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                mesh.triangles.size()));
    if (vertices != nullptr && indices != nullptr) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) vertices[i] = world.point(unsigned(i));
        std::copy(mesh.triangles.begin(), mesh.triangles.end(), indices);
        if (world.texture != nullptr && world.material->alphaCutoff > 0.0f) {
            rtcSetGeometryUserData(geometry, &world);
            rtcSetGeometryIntersectFilterFunction(geometry, alphaFilter);
            rtcSetGeometryOccludedFilterFunction(geometry, alphaFilter);
        }
        rtcCommitGeometry(geometry);
        rtcAttachGeometryByID(embree, geometry, id);
    }
    rtcReleaseGeometry(geometry);
    checkDevice(device, fmt::format("mesh \"{}\"", mesh.name));
}

RayScene::RayScene(std::shared_ptr<const Scene> scene, float time) : impl_(std::make_unique<Impl>()) {
    static std::atomic<std::uint64_t> made{0};
    Impl& s = *impl_;
    s.number = ++made;
    s.scene = std::move(scene);
    s.time = time;
    s.device = rtcNewDevice(nullptr);
    if (s.device == nullptr)
        throw std::runtime_error(
            fmt::format("Embree: no device: error {}", int(rtcGetDeviceError(nullptr))));
    s.embree = rtcNewScene(s.device);
    // Robust: rays through shared edges never slip between the triangles.
    rtcSetSceneFlags(s.embree, RTC_SCENE_FLAG_ROBUST);

    s.meshes.resize(s.scene->meshes.size());
    for (std::size_t i = 0; i < s.meshes.size(); ++i) {
        WorldMesh& world = s.meshes[i];
        world.mesh = &s.scene->meshes[i];
        world.material = &s.scene->materials.at(std::size_t(world.mesh->material));
        if (world.material->texture >= 0 && !world.mesh->uvs.empty())
            world.texture = &s.scene->textures.at(std::size_t(world.material->texture));
        const Object& object = s.scene->objects.at(std::size_t(world.mesh->object));
        world.moved = !object.keys.empty();
        world.pose = object.poseAt(time);
    }
    for (unsigned i = 0; i < s.meshes.size(); ++i) s.addMesh(i);
    rtcCommitScene(s.embree);
    checkDevice(s.device, "building the scene");

    s.diagonal = diagonalOf(s.embree, s.scene->name);
    for (std::size_t i = 0; i < s.scene->lights.size(); ++i)
        s.lights.push_back(s.scene->lightAt(int(i), time));
}

RayScene::~RayScene() = default;

const Scene& RayScene::scene() const {
    return *impl_->scene;
}
float RayScene::time() const {
    return impl_->time;
}
std::uint64_t RayScene::id() const {
    return impl_->number;
}
float RayScene::diagonal() const {
    return impl_->diagonal;
}

void RayScene::boundsAlong(const glm::mat3& axes, glm::vec3& lower, glm::vec3& upper) const {
    lower = glm::vec3(std::numeric_limits<float>::max());
    upper = -lower;
    for (const WorldMesh& world : impl_->meshes)
        for (const glm::uvec3& triangle : world.mesh->triangles)
            for (int corner = 0; corner < 3; ++corner) {
                const glm::vec3 p = axes * world.point(triangle[corner]);
                lower = glm::min(lower, p);
                upper = glm::max(upper, p);
            }
}

bool RayScene::trace(const glm::vec3& origin, const glm::vec3& direction, float from, float to,
                     Hit& hit) const {
    RTCRayHit ray;
    setRay(ray.ray, origin, direction, from, to);
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if STUDIO_EMBREE4
    rtcIntersect1(impl_->embree, &ray, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(impl_->embree, &context, &ray);
#endif
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

    const WorldMesh& world = impl_->meshes[ray.hit.geomID];
    const Mesh& mesh = *world.mesh;
    const glm::uvec3& t = mesh.triangles[ray.hit.primID];
    const float u = ray.hit.u, v = ray.hit.v;
    hit.mesh = int(ray.hit.geomID);
    hit.triangle = int(ray.hit.primID);
    hit.u = u;
    hit.v = v;
    hit.distance = ray.ray.tfar;
    const glm::vec3 a = world.point(t.x), b = world.point(t.y), c = world.point(t.z);
    hit.position = a * (1.0f - u - v) + b * u + c * v;

    // In double: the sides of a sliver are too nearly parallel for a float cross product.
    const glm::vec3 face(
        glm::normalize(glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a))));
    hit.geometricNormal = glm::dot(face, direction) > 0.0f ? -face : face;
    glm::vec3 normal = interpolate(mesh.normals, t, u, v);
    if (world.moved) normal = glm::vec3(world.pose * glm::vec4(normal, 0.0f));
    const float length = glm::length(normal);
    // Opposed corner normals cancel; the face then has no better normal than its own.
    hit.normal = length > 1e-6f ? normal / length : hit.geometricNormal;
    if (glm::dot(hit.normal, hit.geometricNormal) < 0.0f) hit.normal = -hit.normal;

    hit.albedo = world.material->albedo;
    if (world.texture != nullptr)
        hit.albedo *= glm::vec3(world.texture->lookup(interpolate(mesh.uvs, t, u, v)));
    hit.emission = impl_->scene->emissiveSurfaces ? world.material->emission : glm::vec3(0.0f);
    return true;
}

bool RayScene::occluded(const glm::vec3& origin, const glm::vec3& direction, float from,
                        float to) const {
    RTCRay ray;
    setRay(ray, origin, direction, from, to);
#if STUDIO_EMBREE4
    rtcOccluded1(impl_->embree, &ray, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(impl_->embree, &context, &ray);
#endif
    return ray.tfar < 0.0f;
}

RTCSceneTy* RayScene::embree() const {
    return impl_->embree;
}
float RayScene::offsetFloor() const {
    return kDiagonalShare * impl_->diagonal;
}

glm::vec3 RayScene::offset(const glm::vec3& position, const glm::vec3& geometricNormal) const {
    const glm::vec3 size = glm::abs(position);
    const float scale = std::max({size.x, size.y, size.z, offsetFloor()});
    return position + geometricNormal * (kRelativeOffset * scale);
}

const std::vector<Light>& RayScene::lights() const {
    return impl_->lights;
}

glm::vec3 RayScene::directIrradiance(const Light& light, const glm::vec3& position,
                                     const glm::vec3& geometricNormal, const glm::vec3& normal) const {
    const LightArrival arrival = arrivalOf(light, position);
    const float cosine = glm::dot(normal, arrival.toLight);
    if (cosine <= 0.0f || glm::dot(geometricNormal, arrival.toLight) <= 0.0f) return glm::vec3(0.0f);
    if (arrival.irradiance == glm::vec3(0.0f)) return glm::vec3(0.0f);
    const glm::vec3 origin = offset(position, geometricNormal);
    const float reach = light.kind == LightKind::Sun
                            ? arrival.distance
                            : glm::length(light.position - origin) * (1.0f - kLightGap);
    if (occluded(origin, arrival.toLight, 0.0f, reach)) return glm::vec3(0.0f);
    return arrival.irradiance * cosine;
}

glm::vec3 RayScene::directIrradiance(const glm::vec3& position, const glm::vec3& geometricNormal,
                                     const glm::vec3& normal) const {
    glm::vec3 sum(0.0f);
    for (const Light& light : impl_->lights)
        sum += directIrradiance(light, position, geometricNormal, normal);
    return sum;
}

glm::vec3 RayScene::surfacePointAt(const Hit& hit, float otherTime) const {
    const Mesh& mesh = impl_->scene->meshes.at(std::size_t(hit.mesh));
    const glm::uvec3& t = mesh.triangles.at(std::size_t(hit.triangle));
    const Object& object = impl_->scene->objects[std::size_t(mesh.object)];
    if (object.keys.empty()) return hit.position;
    const glm::vec3 p = interpolate(mesh.positions, t, hit.u, hit.v);
    return glm::vec3(object.poseAt(otherTime) * glm::vec4(p, 1.0f));
}

}  // namespace studio
