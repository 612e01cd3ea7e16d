// See host_frame.h.
#include "host_frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cli.h"
#include "host_normals.h"
#include "lightwell/lightwell.hpp"
#include "render_inputs.h"

namespace cli {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr float kReach = 1e9f;        // as lightwell.h: beyond it nothing is a surface
constexpr float kWholeNormal = 0.99f;  // rounding of half floats leaves 0.9995
// A surface this steep to the light tells nothing of the flux by its radiance; what it would reflect is as small.
constexpr double kSteepest = 1e-3;

using Planes = std::vector<std::vector<float>>;

std::optional<Planes> readRole(const studio::ExrLayers& file, const ChannelMap& channels, Role role) {
    const auto names = channels.find(file, role);
    if (!names) return std::nullopt;
    return file.planes(*names);
}

glm::vec3 at(const Planes& planes, std::size_t i) {
    return {planes[0][i], planes[1][i], planes[2][i]};
}

bool isFinite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool isLight(const glm::vec3& v) {
    return isFinite(v) && v.x >= 0.0f && v.y >= 0.0f && v.z >= 0.0f;
}

// What the file has of one picture.
struct Layers {
    std::optional<Planes> position, depth, normal, albedo, direct;
    bool isUncoloured = false;  // `direct` is L_d over albedo
    bool hasNormal = false;     // the file's own; else makeMissingNormals sets `normal`
    bool hasHalfPlaces = false;

    Layers(const studio::ExrLayers& file, const ChannelMap& channels, bool needsAlbedo) {
        if (channels.preferred(Role::Position, Role::Depth) == Role::Position) position = readRole(file, channels, Role::Position);
        if (!position) depth = readRole(file, channels, Role::Depth);
        if (!position && !depth)
            throw UsageError(fmt::format("{}: expected a layer with the position or the depth (or --channels position=... or depth=...), "
                                         "got the channels {}",
                                         file.path(), joinNames(file.names())));
        hasHalfPlaces = file.isHalf(channels.find(file, position ? Role::Position : Role::Depth)->front());
        normal = readRole(file, channels, Role::Normal);
        hasNormal = normal.has_value();
        if (needsAlbedo)
            albedo = file.planes(channels.need(file, Role::Albedo));
        else
            albedo = readRole(file, channels, Role::Albedo);
        if (!albedo && channels.names(Role::DirectUncoloured))
            throw UsageError(fmt::format("{}: expected an albedo beside the direct-uncoloured that is named, for it is over the albedo; "
                                         "got the channels {}",
                                         file.path(), joinNames(file.names())));
        if (channels.preferred(Role::Direct, Role::DirectUncoloured) == Role::Direct) direct = readRole(file, channels, Role::Direct);
        if (!direct && albedo) {
            direct = readRole(file, channels, Role::DirectUncoloured);
            isUncoloured = direct.has_value();
        }
    }

    // None: background.
    std::optional<glm::dvec3> findPlace(const HostCamera::Ray& ray, const HostCamera& camera, std::size_t i) const {
        glm::dvec3 place(0.0);
        if (position) {
            place = at(*position, i);
            // What programs write where they show nothing, if no normal tells.
            if (!hasNormal && place == glm::dvec3(0.0)) return std::nullopt;
        } else {
            const float value = (*depth)[0][i];
            if (!std::isfinite(value) || value <= 0.0f || value >= kReach) return std::nullopt;
            place = camera.placeAt(ray, double(value));
        }
        if (!isFinite(place) || !(glm::length(place) < double(kReach))) return std::nullopt;
        return place;
    }

    // Returns how many surface pixels get none.
    std::uint64_t makeMissingNormals(const HostCamera& camera, int width, int height) {
        if (hasNormal) return 0;
        std::vector<std::optional<glm::dvec3>> places;
        places.reserve(std::size_t(width) * std::size_t(height));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) places.push_back(findPlace(camera.rayThrough(x, y, width, height), camera, places.size()));
        MadeNormals made = makeNormals(width, height, places, camera);
        normal = std::move(made.planes);
        return made.lonely;
    }
};

// One pixel into `to`; counts what it is.
void readPixel(HostSurfaces& to, const Layers& layers, const HostCamera& camera, bool twoSided, int x, int y) {
    const std::size_t i = std::size_t(y) * std::size_t(to.width) + std::size_t(x);
    const HostCamera::Ray ray = camera.rayThrough(x, y, to.width, to.height);
    glm::vec3 normal = at(*layers.normal, i);
    const float length = glm::length(normal);
    const std::optional<glm::dvec3> found = layers.findPlace(ray, camera, i);
    if (!isFinite(normal) || !(length > 0.0f) || !found) {
        ++to.background;
        return;
    }
    const glm::vec3 place(*found);
    const glm::vec3 albedo = layers.albedo ? at(*layers.albedo, i) : glm::vec3(0.0f);
    glm::vec3 direct = layers.direct ? at(*layers.direct, i) : glm::vec3(0.0f);
    if (layers.isUncoloured) direct *= albedo;
    if (!isLight(albedo) || !isLight(direct)) {
        ++to.background;
        ++to.spoiled;
        return;
    }
    if (length < kWholeNormal) ++to.mixed;
    normal /= length;
    if (glm::dot(glm::dvec3(normal), camera.isOrthographic() ? ray.direction : glm::dvec3(place) - ray.origin) > 0.0) {
        ++to.away;
        if (twoSided) normal = -normal;
    }
    to.position.setRgb(x, y, place);
    to.normal.setRgb(x, y, normal);
    to.albedo.setRgb(x, y, albedo);
    to.direct.setRgb(x, y, direct);
    to.farthest = std::max(to.farthest, glm::dot(glm::dvec3(place) - camera.eye(), camera.forward()));
}

void copyVector(const glm::vec3& from, float (&to)[3]) {
    for (int i = 0; i < 3; ++i) to[i] = from[i];
}

LWLight describeLight(const HostLight& host, const std::vector<LWRsm>& rsms) {
    const studio::Light& from = host.light;
    LWLight to = lightwell::make<LWLight>();
    copyVector(from.position, to.position);
    copyVector(from.direction, to.direction);
    to.kind = from.kind == studio::LightKind::Sun    ? LW_LIGHT_DIRECTIONAL
              : from.kind == studio::LightKind::Spot ? LW_LIGHT_SPOT
                                                     : LW_LIGHT_POINT;
    copyVector(from.emitted, from.kind == studio::LightKind::Sun ? to.irradiance : to.radiantIntensity);
    to.innerConeAngle = from.innerCone;
    to.outerConeAngle = from.outerCone;
    to.rsmCount = std::uint32_t(rsms.size());
    to.rsms = rsms.data();
    to.profileCount = std::uint32_t(host.profile.size());
    to.profile = host.profile.empty() ? nullptr : host.profile.data();
    return to;
}

void requireSurfaces(const std::string& path, const HostSurfaces& surfaces) {
    if (surfaces.farthest > 0.0) return;
    std::string got = "all of them behind it; position and camera do not fit together";
    if (surfaces.background == std::uint64_t(surfaces.width) * std::uint64_t(surfaces.height)) {
        got = "background alone";
        if (surfaces.lonely > 0)
            got += fmt::format(" (no layer with the normal, and {} surface pixels without neighbours to make one of)", surfaces.lonely);
    }
    throw UsageError(fmt::format("{}: expected a surface before the camera, got {}", path, got));
}

}  // namespace

HostSurfaces readSurfaces(const std::string& path, const HostCamera& camera, const ChannelMap& channels, bool twoSided, bool needsAlbedo) {
    const studio::ExrLayers file(path);
    HostSurfaces surfaces;
    surfaces.width = file.width();
    surfaces.height = file.height();
    if (surfaces.width > kMaxSize || surfaces.height > kMaxSize)  // before anything of that size is made
        throw UsageError(fmt::format("{}: expected at most {} pixels a side, got {}x{}", path, kMaxSize, surfaces.width, surfaces.height));
    Layers layers(file, channels, needsAlbedo);
    surfaces.lonely = layers.makeMissingNormals(camera, surfaces.width, surfaces.height);
    surfaces.hasOwnNormals = layers.hasNormal;
    surfaces.hasHalfPlaces = layers.hasHalfPlaces;
    for (studio::PlanarBuffer* buffer : {&surfaces.position, &surfaces.normal, &surfaces.albedo, &surfaces.direct})
        *buffer = studio::PlanarBuffer(surfaces.width, surfaces.height, 3);
    surfaces.hasAlbedo = layers.albedo.has_value();
    surfaces.hasDirect = layers.direct.has_value();
    surfaces.farthest = 0.0;
    for (int y = 0; y < surfaces.height; ++y)
        for (int x = 0; x < surfaces.width; ++x) readPixel(surfaces, layers, camera, twoSided, x, y);
    requireSurfaces(path, surfaces);
    return surfaces;
}

studio::PlanarBuffer texelFlux(const HostSurfaces& map, const HostLight& host, const HostCamera& camera) {
    studio::PlanarBuffer flux(map.width, map.height, 3);
    const double area = camera.pixelArea(map.width, map.height);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const glm::dvec3 normal(map.normal.rgb(x, y));
            const glm::dvec3 ray = camera.rayThrough(x, y, map.width, map.height).direction;
            const double length = glm::length(ray);  // 1 over the cosine to the axis; of parallel rays 1
            const glm::dvec3 toSurface = ray / length;
            // Background, or the lamp shines on the back of a one-sided surface: what its front would send never arrived there.
            if (!(glm::dot(normal, toSurface) < 0.0)) continue;
            const double solidAngle = area / (length * length * length);  // of a sun: the area itself
            glm::dvec3 value = glm::dvec3(map.albedo.rgb(x, y)) * host.emittedAlong(toSurface) * solidAngle;
            if (host.fluxFromDirect) {
                const double cosine = -glm::dot(normal, toSurface);
                const glm::dvec3 way = glm::dvec3(map.position.rgb(x, y)) - camera.eye();
                const double squared = camera.isOrthographic() ? 1.0 : glm::dot(way, way);
                value = cosine > kSteepest ? kPi * glm::dvec3(map.direct.rgb(x, y)) * (solidAngle * squared / cosine) : glm::dvec3(0.0);
            }
            flux.setRgb(x, y, glm::vec3(value));
        }
    return flux;
}

HostFrame::HostFrame(HostSurfaces view, const HostCamera& camera) : view_(std::move(view)) {
    gbuffer_ = lightwell::make<LWGBuffer>();
    gbuffer_.position = describePlanes(view_.position);
    gbuffer_.normal = describePlanes(view_.normal);
    if (view_.hasAlbedo) gbuffer_.albedo = describePlanes(view_.albedo);
    if (view_.hasDirect) gbuffer_.directRadiance = describePlanes(view_.direct);
    gbuffer_.camera = gbuffer_.previousCamera = camera.describe(view_.width, view_.height, view_.farthest);
    copyVector(glm::vec3(camera.eye()), eye_);
}

void HostFrame::addLight(HostLight light, std::vector<HostSurfaces> maps) {
    lamps_.push_back(std::make_unique<Lamp>());
    Lamp& lamp = *lamps_.back();
    lamp.light = std::move(light);
    lamp.maps = std::move(maps);
    for (std::size_t i = 0; i < lamp.maps.size(); ++i) {
        const HostSurfaces& map = lamp.maps[i];
        const HostCamera& camera = lamp.light.cameras.at(i);
        lamp.flux.push_back(texelFlux(map, lamp.light, camera));
        LWRsm rsm = lightwell::make<LWRsm>();
        rsm.position = describePlanes(map.position);
        rsm.normal = describePlanes(map.normal);
        rsm.flux = describePlanes(lamp.flux.back());
        rsm.camera = camera.describe(map.width, map.height, map.farthest);
        lamp.rsms.push_back(rsm);
    }
    lights_.push_back(describeLight(lamp.light, lamp.rsms));
}

std::uint64_t HostFrame::texelCount() const {
    std::uint64_t count = 0;
    for (const auto& lamp : lamps_)
        for (const HostSurfaces& map : lamp->maps) count += std::uint64_t(map.width) * std::uint64_t(map.height);
    return count;
}

}  // namespace cli
