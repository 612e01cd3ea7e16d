// See vpl_placement.h.
//
// Source: G. Papaioannou, Approximate dynamic global illumination for VR, 2025, section 5.2. Its public code
// culls at random; here the places that fewest paths found go first.
#include "vpl_placement.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "vpl_places.h"

namespace studio {
namespace {

// Spacings that are tried, in shares of the diagonal: from one that leaves a thousand places on a wall to one
// that leaves a handful in all.
constexpr double kFinest = 1.0 / 256.0, kCoarsest = 0.25, kCoarser = 1.2;
// Surfaces belong to places within this many spacings; merging leaves none of what was found beyond one.
constexpr double kReach = 2.0;
// What lies lower above its surface, in spacings, hides no part of it from its place.
constexpr double kLift = 0.05;
// Shares of the work, for progress.
constexpr double kPathsShare = 0.3, kMergeShare = 0.5;

void require(bool holds, const char* option, const char* expected, double got) {
    if (!holds)
        throw std::invalid_argument(fmt::format("placement: {}: expected {}, got {}", option, expected, got));
}

void checkOptions(const PlacementOptions& o) {
    require(o.points >= 1, "points", "at least 1", o.points);
    require(o.paths >= 1, "paths", "at least 1", o.paths);
    require(o.lightPaths >= 0, "lightPaths", "at least 0", o.lightPaths);
    require(o.depth >= 1, "depth", "at least 1", o.depth);
    require(o.cap >= 1 && std::size_t(o.cap) <= kMostStaticVpls, "cap", "1 .. 4096", o.cap);
    require(o.spacing >= 0.0 && std::isfinite(o.spacing), "spacing", "0 or a length", o.spacing);
    require(o.degrees >= 0.0 && o.degrees < 90.0, "degrees", "0 to under 90", o.degrees);
    require(o.reflectance >= 0.0, "reflectance", "at least 0", o.reflectance);
    require(o.offset >= 0.0 && std::isfinite(o.offset), "offset", "at least 0", o.offset);
}

// What scene coordinates and Embree's rays bear.
constexpr float kFarthest = 1e9f;

void checkPlaces(const RayScene& scene, const PlacementOptions& o) {
    for (const glm::vec3& from : o.from)
        for (int axis = 0; axis < 3; ++axis)
            require(std::abs(from[axis]) <= kFarthest, "from", "coordinates to 1e9", double(from[axis]));
    require(o.spacing <= double(scene.diagonal()), "spacing",
            fmt::format("at most the scene's diagonal, {:.3g} m", scene.diagonal()).c_str(), o.spacing);
}

// Indices as StaticVpl::object names them; those that never move count as one.
int objectIndex(const Scene& scene, const std::string& name) {
    for (std::size_t i = 1; i < scene.objects.size(); ++i)
        if (!name.empty() && scene.objects[i].name == name)
            return scene.objects[i].keys.empty() ? 0 : int(i);
    return 0;
}

class Placer {
public:
    Placer(const RayScene& scene, const PlacementOptions& options, const StaticVpls& earlier)
        : scene_(scene), options_(options), earlier_(earlier) {}
    Placement run();

private:
    void report(double fraction, const std::string& doing) const {
        if (options_.progress) options_.progress(fraction, doing);
    }
    std::vector<SurfaceHit> findHits();
    std::vector<VplPlace> earlierPlaces() const;
    std::vector<VplPlace> merge(const std::vector<SurfaceHit>& hits);
    void weigh(std::vector<VplPlace>& places);
    StaticVpl made(const VplPlace& place) const;

    const RayScene& scene_;
    const PlacementOptions& options_;
    const StaticVpls& earlier_;
    PlacementReport report_;
};

std::vector<SurfaceHit> Placer::findHits() {
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < options_.from.size(); ++i)
        for (const glm::vec3& point :
             exploreFreeSpace(scene_, options_.from[i], options_.points, options_.seed + (i << 32)))
            points.push_back(point);
    report_.points = points.size();
    PathOptions paths;
    paths.paths = options_.paths;
    paths.lightPaths = options_.lightPaths;
    paths.depth = options_.depth;
    paths.seed = options_.seed;
    paths.threads = options_.threads;
    paths.progress = [&](double done) { report(kPathsShare * done, "paths"); };
    std::vector<SurfaceHit> hits = findSurfaces(scene_, points, paths);
    // Objects without movement are the world at rest.
    for (SurfaceHit& hit : hits)
        if (scene_.scene().objects[std::size_t(hit.object)].keys.empty()) hit.object = 0;
    report_.hits = hits.size();
    return hits;
}

std::vector<VplPlace> Placer::earlierPlaces() const {
    const StaticVpls world = posedVpls(earlier_, scene_.scene(), scene_.time());
    std::vector<VplPlace> places;
    for (std::size_t i = 0; i < world.vpls.size(); ++i) {
        const StaticVpl& v = world.vpls[i];
        // What was set back behind its surface before it is weighed on it again.
        const float back = v.population > 0 ? float(options_.offset) : 0.0f;
        places.push_back({v.position + v.normal * back, v.normal, v.reflectance,
                          objectIndex(scene_.scene(), earlier_.vpls[i].object), v.population, 0.0});
    }
    return places;
}

std::vector<VplPlace> Placer::merge(const std::vector<SurfaceHit>& hits) {
    MergeOptions merging;
    merging.leastCosine = std::cos(options_.degrees * double(kPi) / 180.0);
    merging.reflectance = options_.reflectance;
    const std::vector<VplPlace> before = earlierPlaces();
    std::vector<VplPlace> places;
    const auto mergedAt = [&](double spacing, std::size_t most) {
        report(kPathsShare, fmt::format("merging at {:.3g} m", spacing));
        merging.spacing = report_.spacing = spacing;
        places = before;
        return mergeHits(hits, merging, most, places);
    };
    if (options_.spacing > 0.0) {
        mergedAt(options_.spacing, std::size_t(-1));
    } else {
        const double diagonal = double(scene_.diagonal());
        double spacing = kFinest * diagonal;
        while (spacing < kCoarsest * diagonal && !mergedAt(spacing, std::size_t(options_.cap)))
            spacing *= kCoarser;
        if (spacing >= kCoarsest * diagonal) mergedAt(kCoarsest * diagonal, std::size_t(-1));
    }
    report_.places = places.size();
    report_.lostHits = keepHeaviest(std::size_t(options_.cap), places);
    return places;
}

void Placer::weigh(std::vector<VplPlace>& places) {
    WeighOptions weighing;
    weighing.reach = kReach * report_.spacing;
    weighing.lift = kLift * report_.spacing;
    weighing.leastCosine = std::cos(options_.degrees * double(kPi) / 180.0);
    weighing.seed = options_.seed;
    weighing.threads = options_.threads;
    weighing.progress = [&](double done) {
        report(kMergeShare + (1.0 - kMergeShare) * done, "areas");
    };
    weighPlaces(scene_, weighing, places);
}

StaticVpl Placer::made(const VplPlace& place) const {
    const float unit = earlier_.metresPerUnit;
    StaticVpl vpl;
    vpl.position = place.position - place.normal * float(options_.offset);
    vpl.normal = place.normal;
    vpl.reflectance = glm::clamp(place.reflectance, 0.0f, 1.0f);
    if (place.object != 0) {
        const Object& object = scene_.scene().objects[std::size_t(place.object)];
        const glm::mat4 inverse = glm::inverse(object.poseAt(scene_.time()));
        vpl.object = object.name;
        vpl.position = glm::vec3(inverse * glm::vec4(vpl.position, 1.0f));
        vpl.normal = glm::normalize(glm::vec3(inverse * glm::vec4(vpl.normal, 0.0f)));
    }
    vpl.position /= unit;
    const double perWeight = double(earlier_.areaPerWeight) * double(unit) * double(unit);
    vpl.weight = float(place.area / perWeight);
    if (!(*vpl.weight > 0.0f && std::isfinite(*vpl.weight)))
        throw std::invalid_argument(
            fmt::format("placement: area_per_weight: expected one in which {:.3g} m^2 is a weight that "
                        "floats hold, got {:.3g} m^2",
                        place.area, perWeight));
    vpl.population = place.population;
    return vpl;
}

Placement Placer::run() {
    const std::vector<SurfaceHit> hits = findHits();
    std::vector<VplPlace> places = merge(hits);
    weigh(places);

    Placement placement;
    placement.vpls = earlier_;
    placement.vpls.vpls.clear();
    report_.earlier = earlier_.vpls.size();
    std::size_t next = 0;  // by hand: the same ones in the same order
    for (const VplPlace& place : places) {
        if (place.population == 0) {
            while (earlier_.vpls[next].population != 0) ++next;
            placement.vpls.vpls.push_back(earlier_.vpls[next++]);
            ++report_.byHand;
        } else if (place.area <= 0.0) {
            ++report_.withoutArea;
        } else {
            placement.vpls.vpls.push_back(made(place));
        }
    }
    const double perWeight =
        double(earlier_.areaPerWeight) * double(earlier_.metresPerUnit) * double(earlier_.metresPerUnit);
    for (const StaticVpl& vpl : placement.vpls.vpls)
        report_.area += double(vpl.weight.value_or(0.0f)) * perWeight;
    placement.report = report_;
    return placement;
}

}  // namespace

Placement placeVpls(const RayScene& scene, const PlacementOptions& options, const StaticVpls& earlier) {
    checkOptions(options);
    checkPlaces(scene, options);
    std::size_t byHand = 0;
    for (const StaticVpl& vpl : earlier.vpls) byHand += vpl.population == 0 ? 1 : 0;
    require(byHand <= std::size_t(options.cap), "cap", "at least the number of VPLs set by hand",
            options.cap);
    return Placer(scene, options, earlier).run();
}

}  // namespace studio
