// See vpl_places.h.
#include "vpl_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "parallel.h"
#include "sampler.h"
#include "scene_triangles.h"

namespace studio {
namespace {

// Samples of the surface for each place: half of them see it, so that an area is good to some 5 %.
constexpr std::size_t kSamplesPerPlace = 512, kMostSamples = std::size_t(1) << 18;
// Nearest places that a sample looks for. More cost rays where a surface is hidden; fewer lose surfaces behind
// clutter.
constexpr std::size_t kCandidates = 8;
constexpr std::uint64_t kStream = 0x61726561u;  // of random numbers; any
constexpr std::size_t kBlock = 1024;            // samples of a work item

// As much as is told apart from places set by hand where the heaviest are kept; a file may say anything.
constexpr std::uint32_t kByHand = std::numeric_limits<std::uint32_t>::max(),
                        kMostPopulation = kByHand - 1;

bool isAlike(const SurfaceHit& hit, const VplPlace& place, const MergeOptions& options) {
    if (hit.object != place.object) return false;
    if (double(glm::dot(hit.normal, place.normal)) < options.leastCosine) return false;
    const glm::vec3 difference = glm::abs(hit.reflectance - place.reflectance);
    return double(std::max({difference.x, difference.y, difference.z})) <= options.reflectance;
}

void takeUp(const SurfaceHit& hit, VplPlace& place) {
    if (place.population == 0) return;  // set by hand
    const float share = float(1.0 / (double(place.population) + 1.0));
    place.position += (hit.position - place.position) * share;
    place.normal = glm::normalize(place.normal + (hit.normal - place.normal) * share);
    place.reflectance += (hit.reflectance - place.reflectance) * share;
    if (place.population < kMostPopulation) ++place.population;
}

struct Sample {
    glm::vec3 position{0.0f}, normal{0.0f};  // normal: of the face, one of its sides
};

// Points evenly over the area of a scene's triangles.
class SurfaceSamples {
public:
    SurfaceSamples(const RayScene& scene, std::size_t count, std::uint64_t seed)
        : triangles_(sceneTriangles(scene)), count_(count), seed_(seed) {
        double sum = 0.0;
        for (std::size_t t = 0; t < triangles_.count(); ++t) {
            sum += 0.5 * glm::length(glm::cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0)));
            upTo_.push_back(sum);
        }
    }
    double area() const { return upTo_.empty() ? 0.0 : upTo_.back(); }
    Sample at(std::size_t index) const {
        Sampler sampler(seed_, kStream, std::uint32_t(index));
        const glm::dvec2 place = sampler.nextFine();
        const double choice = (double(index) + sampler.nextFine().x) / double(count_) * area();
        const auto found = std::upper_bound(upTo_.begin(), upTo_.end() - 1, choice);
        const auto t = std::size_t(found - upTo_.begin());
        const glm::dvec3 a = corner(t, 0), u = corner(t, 1) - a, v = corner(t, 2) - a;
        const double root = std::sqrt(place.x);
        return {glm::vec3(a + u * (root * (1.0 - place.y)) + v * (root * place.y)),
                glm::vec3(glm::normalize(glm::cross(u, v)))};
    }

private:
    glm::dvec3 corner(std::size_t triangle, std::size_t which) const {
        const float* p = &triangles_.vertices[9 * triangle + 3 * which];
        return {double(p[0]), double(p[1]), double(p[2])};
    }
    SceneTriangles triangles_;
    std::vector<double> upTo_;
    std::size_t count_;
    std::uint64_t seed_;
};

bool sees(const RayScene& scene, const Sample& sample, const VplPlace& place, float lift) {
    const glm::vec3 from = sample.position + sample.normal * lift;
    const glm::vec3 way = place.position + place.normal * lift - from;
    const float distance = glm::length(way);
    return !(distance > 0.0f) || !scene.occluded(from, way / distance, 0.0f, distance);
}

// The place that a side of a surface belongs to, or -1.
int ownerOf(const RayScene& scene, const Sample& sample, const WeighOptions& options,
            const std::vector<VplPlace>& places) {
    std::array<std::pair<float, int>, kCandidates> nearest;
    std::size_t count = 0;
    const float reach2 = float(options.reach * options.reach);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const glm::vec3 way = places[i].position - sample.position;
        const float distance2 = glm::dot(way, way);
        if (distance2 > reach2 || (count == kCandidates && distance2 >= nearest[count - 1].first)) continue;
        if (double(glm::dot(sample.normal, places[i].normal)) < options.leastCosine) continue;
        std::size_t at = count < kCandidates ? count++ : count - 1;
        for (; at > 0 && nearest[at - 1].first > distance2; --at) nearest[at] = nearest[at - 1];
        nearest[at] = {distance2, int(i)};
    }
    for (std::size_t i = 0; i < count; ++i)
        if (sees(scene, sample, places[std::size_t(nearest[i].second)], float(options.lift)))
            return nearest[i].second;
    return -1;
}

}  // namespace

bool mergeHits(const std::vector<SurfaceHit>& hits, const MergeOptions& options, std::size_t most,
               std::vector<VplPlace>& places) {
    const float spacing2 = float(options.spacing * options.spacing);
    for (const SurfaceHit& hit : hits) {
        VplPlace* nearest = nullptr;
        float nearest2 = spacing2;
        for (VplPlace& place : places) {
            const glm::vec3 way = place.position - hit.position;
            const float distance2 = glm::dot(way, way);
            if (distance2 >= nearest2 || !isAlike(hit, place, options)) continue;
            nearest = &place, nearest2 = distance2;
        }
        if (nearest != nullptr) {
            takeUp(hit, *nearest);
            continue;
        }
        if (places.size() >= most) return false;
        places.push_back({hit.position, hit.normal, hit.reflectance, hit.object, 1, 0.0});
    }
    return true;
}

std::uint64_t keepHeaviest(std::size_t cap, std::vector<VplPlace>& places) {
    if (places.size() <= cap) return 0;
    const auto heaviness = [&](std::size_t i) {
        return places[i].population == 0 ? kByHand : std::min(places[i].population, kMostPopulation);
    };
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return heaviness(a) > heaviness(b); });
    std::uint64_t lost = 0;
    for (std::size_t i = cap; i < order.size(); ++i) lost += places[order[i]].population;
    order.resize(cap);
    std::sort(order.begin(), order.end());
    std::vector<VplPlace> kept;
    for (const std::size_t i : order) kept.push_back(places[i]);
    places = std::move(kept);
    return lost;
}

void weighPlaces(const RayScene& scene, const WeighOptions& options, std::vector<VplPlace>& places) {
    if (places.empty()) return;
    const std::size_t count = std::min(kSamplesPerPlace * places.size(), kMostSamples);
    const SurfaceSamples samples(scene, count, options.seed);
    std::vector<std::array<int, 2>> owners(count);
    const std::size_t blocks = (count + kBlock - 1) / kBlock;
    parallelFor(
        blocks, options.threads,
        [&](std::size_t block) {
            for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
                Sample sample = samples.at(i);
                for (const std::size_t side : {std::size_t(0), std::size_t(1)}) {
                    owners[i][side] = ownerOf(scene, sample, options, places);
                    sample.normal = -sample.normal;
                }
            }
        },
        [&](std::size_t begun) {
            if (options.progress) options.progress(double(begun) / double(blocks));
        });
    for (VplPlace& place : places) place.area = 0.0;
    for (const auto& sides : owners)
        for (const int owner : sides)
            if (owner >= 0) places[std::size_t(owner)].area += samples.area() / double(count);
}

}  // namespace studio
