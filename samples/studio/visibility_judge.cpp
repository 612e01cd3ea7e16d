#include "visibility_judge.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "parallel.h"
#include "vpl_visibility.h"

namespace studio {
namespace {

constexpr int kRays[] = {int(Sight::medoid), int(Sight::mean)};

bool isSame(const VplRecord& a, const VplRecord& b) {
    return a.position == b.position && a.normal == b.normal && a.flux == b.flux && a.area == b.area;
}

double meanOf(const glm::dvec3& rgb) {
    return (rgb.x + rgb.y + rgb.z) / 3.0;
}

// Of one pair or a pixel's: what `seen` gives where `truth` is right.
struct Wrong {
    double light = 0.0, shadow = 0.0, lightWeight = 0.0, shadowWeight = 0.0;
    void add(double seen, double truth, double weight) {
        const double over = std::max(0.0, seen - truth), under = std::max(0.0, truth - seen);
        light += over;
        shadow += under;
        lightWeight += over * weight;
        shadowWeight += under * weight;
    }
    Wrong& operator+=(const Wrong& other) {
        light += other.light;
        shadow += other.shadow;
        lightWeight += other.lightWeight;
        shadowWeight += other.shadowWeight;
        return *this;
    }
    Misjudged share(double pairs, double weight) const {
        if (pairs == 0.0) return {};
        return {light / pairs, shadow / pairs, lightWeight / weight, shadowWeight / weight};
    }
};

// Rays from a pixel to the clusters' places, each traced when it is first asked for.
class ClusterRays {
public:
    ClusterRays(const RayScene& scene, const Surface& at, const std::vector<ClusterPlace>& clusters)
        : scene_(scene), at_(at), clusters_(clusters), known_(2 * clusters.size(), -1) {}
    bool sees(int cluster, Sight way) {
        const bool toMedoid = way == Sight::medoid;
        signed char& known = known_[2 * std::size_t(cluster) + (toMedoid ? 1 : 0)];
        if (known < 0) {
            const ClusterPlace& place = clusters_[std::size_t(cluster)];
            const VplRecord end{toMedoid ? place.medoid : place.mean,
                                toMedoid ? place.medoidNormal : place.meanNormal, glm::vec3(0.0f)};
            known = vplVisible(scene_, end, at_) ? 1 : 0;
        }
        return known == 1;
    }

private:
    const RayScene& scene_;
    const Surface& at_;
    const std::vector<ClusterPlace>& clusters_;
    std::vector<signed char> known_;
};

}  // namespace

// One pixel's pairs.
struct VisibilityJudge::Tally {
    std::uint64_t pairs = 0;
    double lit = 0.0, litWeight = 0.0, weight = 0.0;
    std::array<Wrong, kSightCount> against;
    Wrong mapAgainstMedoid;
    std::array<glm::dvec3, kSightCount> irradiance{};
};

VisibilityJudge::VisibilityJudge(const RayScene& scene, const GBuffer& pixels)
    : scene_(scene), width_(pixels.width), height_(pixels.height), pixels_(scene, pixels) {}

void VisibilityJudge::check(const std::vector<ClusteredVpl>& vpls,
                            const std::vector<ClusterPlace>& clusters,
                            const std::vector<float>& seen) const {
    const std::size_t expected = clusters.size() * pixels_.surface.size();
    if (seen.size() != expected)
        throw std::runtime_error(
            fmt::format("visibility: expected {} values, one for each pixel and cluster, got {}",
                        expected, seen.size()));
    for (const ClusteredVpl& v : vpls)
        if (v.cluster < 0 || std::size_t(v.cluster) >= clusters.size())
            throw std::runtime_error(fmt::format("cluster of a VPL: expected 0 to {}, got {}",
                                                 int(clusters.size()) - 1, v.cluster));
    for (const float value : seen)
        if (!(value >= 0.0f && value <= 1.0f))
            throw std::runtime_error(fmt::format("visibility: expected values in [0,1], got {}", value));
}

bool VisibilityJudge::isVisible(std::size_t pixel, std::size_t vpl) const {
    return (exact_[pixel * words_ + vpl / 64] >> (vpl % 64) & 1u) != 0;
}

void VisibilityJudge::traceExact(const std::vector<ClusteredVpl>& vpls) {
    const bool isKnown =
        std::equal(vpls.begin(), vpls.end(), traced_.begin(), traced_.end(),
                   [](const ClusteredVpl& a, const VplRecord& b) { return isSame(a.vpl, b); });
    if (isKnown && !traced_.empty()) return;
    words_ = (vpls.size() + 63) / 64;
    exact_.assign(words_ * pixels_.surface.size(), 0);
    traced_.clear();
    parallelRows(height_, [&](int row) {
        const std::size_t first = std::size_t(row) * std::size_t(width_);
        // VPLs outside, pixels inside, so that rays converge.
        for (std::size_t v = 0; v < vpls.size(); ++v)
            for (std::size_t pixel = first; pixel < first + std::size_t(width_); ++pixel) {
                if (!pixels_.valid[pixel]) continue;
                const Surface& at = pixels_.surface[pixel];
                if (vplIrradiance(vpls[v].vpl, at) == glm::dvec3(0.0)) continue;
                if (vplVisible(scene_, vpls[v].vpl, at))
                    exact_[pixel * words_ + v / 64] |= std::uint64_t(1) << (v % 64);
            }
    });
    for (const ClusteredVpl& v : vpls) traced_.push_back(v.vpl);
}

VisibilityJudge::Tally VisibilityJudge::judgePixel(std::size_t pixel,
                                                   const std::vector<ClusteredVpl>& vpls,
                                                   const std::vector<ClusterPlace>& clusters,
                                                   const std::vector<float>& seen) const {
    Tally tally;
    const Surface& at = pixels_.surface[pixel];
    ClusterRays rays(scene_, at, clusters);
    for (std::size_t v = 0; v < vpls.size(); ++v) {
        const glm::dvec3 light = vplIrradiance(vpls[v].vpl, at);
        if (light == glm::dvec3(0.0)) continue;
        const int cluster = vpls[v].cluster;
        std::array<double, kSightCount> sees{};
        sees[int(Sight::none)] = 1.0;
        sees[int(Sight::map)] = double(seen[std::size_t(cluster) * pixels_.surface.size() + pixel]);
        for (const int way : kRays) sees[std::size_t(way)] = rays.sees(cluster, Sight(way)) ? 1.0 : 0.0;
        const double exact = isVisible(pixel, v) ? 1.0 : 0.0, weight = meanOf(light);
        sees[int(Sight::exact)] = exact;
        ++tally.pairs;
        tally.lit += exact;
        tally.litWeight += exact * weight;
        tally.weight += weight;
        for (std::size_t way = 0; way < kSightCount; ++way) {
            tally.against[way].add(sees[way], exact, weight);
            tally.irradiance[way] += light * sees[way];
        }
        tally.mapAgainstMedoid.add(sees[int(Sight::map)], sees[int(Sight::medoid)], weight);
    }
    return tally;
}

VisibilityVerdict VisibilityJudge::sum(const std::vector<Tally>& tallies) const {
    VisibilityVerdict verdict;
    verdict.pictures = Image(width_, height_);
    Tally all;
    for (std::size_t way = 0; way < kSightCount; ++way) {
        verdict.irradiance[way] = Image(width_, height_);
        const std::string name = kSightNames[way];
        std::vector<float>&light = verdict.pictures.plane(name + ".light"),
        &shadow = verdict.pictures.plane(name + ".shadow");
        for (std::size_t i = 0; i < tallies.size(); ++i) {
            all.against[way] += tallies[i].against[way];
            light[i] = float(tallies[i].against[way].lightWeight);
            shadow[i] = float(tallies[i].against[way].shadowWeight);
        }
        for (int channel = 0; channel < 3; ++channel) {
            std::vector<float>& plane = verdict.irradiance[way].plane(std::string(1, "RGB"[channel]));
            for (std::size_t i = 0; i < tallies.size(); ++i)
                plane[i] = float(tallies[i].irradiance[way][channel]);
        }
    }
    for (const Tally& tally : tallies) {
        all.pairs += tally.pairs;
        all.lit += tally.lit;
        all.litWeight += tally.litWeight;
        all.weight += tally.weight;
        all.mapAgainstMedoid += tally.mapAgainstMedoid;
    }
    verdict.pairs = all.pairs;
    if (all.pairs == 0) return verdict;
    const double pairs = double(all.pairs);
    verdict.lit = all.lit / pairs;
    verdict.litWeight = all.litWeight / all.weight;
    for (std::size_t way = 0; way < kSightCount; ++way)
        verdict.against[way] = all.against[way].share(pairs, all.weight);
    verdict.mapAgainstMedoid = all.mapAgainstMedoid.share(pairs, all.weight);
    return verdict;
}

VisibilityVerdict VisibilityJudge::judge(const std::vector<ClusteredVpl>& vpls,
                                         const std::vector<ClusterPlace>& clusters,
                                         const std::vector<float>& seen) {
    check(vpls, clusters, seen);
    traceExact(vpls);
    std::vector<Tally> tallies(pixels_.surface.size());
    parallelRows(height_, [&](int row) {
        const std::size_t first = std::size_t(row) * std::size_t(width_);
        for (std::size_t pixel = first; pixel < first + std::size_t(width_); ++pixel)
            if (pixels_.valid[pixel]) tallies[pixel] = judgePixel(pixel, vpls, clusters, seen);
    });
    return sum(tallies);
}

}  // namespace studio
