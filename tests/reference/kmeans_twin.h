// Plain serial double-precision twin of pass `kmeans`.
#pragma once

#include "reference/surfaces.h"

namespace lightwell::reference {

struct KMeansTwin {
    struct Mean {
        Vec position, normal;
        double members = 0;  // 0: no such cluster
    };

    std::size_t clusters = 8;
    double positionWeight = double(0.6f), normalWeight = double(0.4f);

    double diagonal = 0;
    std::vector<Mean> means;        // what an iteration ends with
    std::vector<Mean> assignedTo;   // the means that the assignment was made by
    std::vector<int> assignment;    // by slot, -1 without flux
    std::vector<double> distances;  // squared, from those means

    static Vec position(const lw_vpl& v) { return {v.positionArea.s[0], v.positionArea.s[1], v.positionArea.s[2]}; }
    static Vec normal(const lw_vpl& v) { return {v.normal.s[0], v.normal.s[1], v.normal.s[2]}; }
    static bool lit(const lw_vpl& v) { return v.flux.s[0] > 0 || v.flux.s[1] > 0 || v.flux.s[2] > 0; }

    // `before`: the clusters to start from, or none for k-means++.
    void run(const std::vector<lw_vpl>& vpls, const std::vector<lw_cluster>& before, int iterations) {
        diagonal = diagonalOf(vpls);
        means.assign(clusters, {});
        for (std::size_t k = 0; k < before.size(); ++k)
            means[k] = {{before[k].position.s[0], before[k].position.s[1], before[k].position.s[2]},
                        {before[k].normal.s[0], before[k].normal.s[1], before[k].normal.s[2]},
                        before[k].position.s[3]};
        for (int i = 0; i < iterations; ++i) {
            assign(vpls);
            seed(vpls);
            assignedTo = means;
            update(vpls);
        }
    }

    static double diagonalOf(const std::vector<lw_vpl>& vpls) {
        double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
        bool any = false;
        for (const lw_vpl& v : vpls)
            if (lit(v)) {
                any = true;
                for (int c = 0; c < 3; ++c) {
                    low[c] = std::min(low[c], double(v.positionArea.s[c]));
                    high[c] = std::max(high[c], double(v.positionArea.s[c]));
                }
            }
        return any ? std::sqrt(dot(Vec{high[0], high[1], high[2]} - Vec{low[0], low[1], low[2]},
                                   Vec{high[0], high[1], high[2]} - Vec{low[0], low[1], low[2]}))
                   : 0.0;
    }

    double distance(const lw_vpl& v, const Mean& mean) const {
        const Vec offset = position(v) - mean.position;
        const double place = diagonal > 0 ? dot(offset, offset) / (diagonal * diagonal) : 0.0;
        return positionWeight * place + normalWeight * (1.0 - dot(normal(v), mean.normal));
    }

    // -ln of the number in (0, 1) that slot and round determine.
    static double variate(std::uint32_t slot, std::uint32_t round) {
        std::uint32_t h = slot * 0x9e3779b9u + round * 0xc2b2ae3du + 0x27d4eb2fu;
        h = (h ^ (h >> 16)) * 0x85ebca6bu;
        h = (h ^ (h >> 13)) * 0xc2b2ae35u;
        h ^= h >> 16;
        return -std::log(((h >> 9) + 0.5) / 8388608.0);
    }

private:
    void assign(const std::vector<lw_vpl>& vpls) {
        assignment.assign(vpls.size(), -1);
        distances.assign(vpls.size(), 1e30);
        for (std::size_t i = 0; i < vpls.size(); ++i)
            for (std::size_t k = 0; k < clusters && lit(vpls[i]); ++k)
                if (means[k].members > 0 && distance(vpls[i], means[k]) < distances[i]) {
                    distances[i] = distance(vpls[i], means[k]);
                    assignment[i] = int(k);
                }
    }

    int firstEmpty() const {
        for (std::size_t k = 0; k < clusters; ++k)
            if (std::find(assignment.begin(), assignment.end(), int(k)) == assignment.end()) return int(k);
        return -1;
    }

    void seed(const std::vector<lw_vpl>& vpls) {
        const bool draw = std::all_of(assignment.begin(), assignment.end(), [](int k) { return k < 0; });
        for (std::size_t round = 0; round < clusters; ++round) {
            const int empty = firstEmpty();
            if (empty < 0) return;
            int best = -1;
            double most = 1e-12;  // what rounding leaves between coincident sites in double
            for (std::size_t i = 0; i < vpls.size(); ++i) {
                const double key =
                    draw ? distances[i] / variate(std::uint32_t(i), std::uint32_t(round)) : distances[i];
                if (lit(vpls[i]) && distances[i] > 1e-12 && key > most) {
                    most = key;
                    best = int(i);
                }
            }
            if (best < 0) return;
            const lw_vpl& seed = vpls[std::size_t(best)];
            means[std::size_t(empty)] = {position(seed), normal(seed), 1};
            for (std::size_t i = 0; i < vpls.size(); ++i) {
                if (!lit(vpls[i])) continue;
                const double d = distance(vpls[i], means[std::size_t(empty)]);
                if (d < distances[i] || (d == distances[i] && empty < assignment[i])) {
                    distances[i] = d;
                    assignment[i] = empty;
                }
            }
        }
    }

    void update(const std::vector<lw_vpl>& vpls) {
        means.assign(clusters, {});
        for (std::size_t i = 0; i < vpls.size(); ++i) {
            if (assignment[i] < 0) continue;
            Mean& mean = means[std::size_t(assignment[i])];
            mean.position = mean.position + position(vpls[i]);
            mean.normal = mean.normal + normal(vpls[i]);
            mean.members += 1;
        }
        for (std::size_t k = 0; k < clusters; ++k) {
            if (means[k].members == 0) continue;
            means[k].position = means[k].position * (1.0 / means[k].members);
            if (dot(means[k].normal, means[k].normal) > 1e-12 * means[k].members * means[k].members)
                means[k].normal = unit(means[k].normal);
            else
                means[k].normal = normal(vpls[std::size_t(
                    std::find(assignment.begin(), assignment.end(), int(k)) - assignment.begin())]);
        }
    }
};

}  // namespace lightwell::reference
