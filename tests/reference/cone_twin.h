// Cones through voxels in double precision, sample by sample, from the words that kernels read.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "passes/cone_directions.h"
#include "reference/surfaces.h"
#include "support/cone_rig.h"

namespace lightwell::reference {

struct ConeTwin {
    const test::DeviceVoxels& voxels;
    ConeGatherOptions options;
    std::array<double, 3> environment{0.0, 0.0, 0.0};

    struct Sample {
        double colour[3] = {0, 0, 0}, opacity = 0;
        double squares = 0;  // of the voxels' opacities, by weight
        double closed = 0;   // how much of the opacity is in closed voxels

        double variance() const { return squares - opacity * opacity; }
        double mostVariance() const { return opacity * (1 - opacity); }
    };
    struct Light {
        double colour[3] = {0, 0, 0}, through = 1, occluded = 0;
    };

    // Of the surface that cones leave: a point of the world, and the normal.
    struct Plane {
        Vec at, normal;
    };

    int size() const { return int(voxels.volume.size); }
    int cascades() const { return int(voxels.volume.cascades); }

    // Of one plane of a voxel's words; nothing where its brick has no slot.
    cl_uint word(int cascade, int level, int plane, const int* i, const int* corner) const {
        const int n = size() >> level, bricks = voxel_bricks(size(), level);
        const int brick = (corner[2] / 8 * bricks + corner[1] / 8) * bricks + corner[0] / 8;
        const int slot = voxels.table[std::size_t(cascade * voxel_table_size(size()) +
                                                  voxel_table(size(), level) + brick)];
        if (slot < 0 || i[0] >= n || i[1] >= n || i[2] >= n) return 0;
        const int slots = int(level == 0 ? voxels.volume.baseSlots : voxels.volume.mipSlots);
        const int at = (i[0] - corner[0] / 8 * 8) + 9 * (i[1] - corner[1] / 8 * 8) +
                       81 * (i[2] - corner[2] / 8 * 8);
        return (level == 0 ? voxels.base
                           : voxels.mips)[std::size_t((plane * slots + slot) * LW_VOXEL_STRIDE + at)];
    }

    void add(Sample& sum, cl_uint word, double weight) const {
        LwVoxelValue value{};
        voxel_unpack(word, voxels.unit, &value);
        sum.colour[0] += weight * double(value.red);
        sum.colour[1] += weight * double(value.green);
        sum.colour[2] += weight * double(value.blue);
        sum.opacity += weight * double(value.opacity);
        sum.squares += weight * double(value.opacity) * double(value.opacity);
    }

    // Of the voxel k of eight, bits 0, 1, 2 its steps along x, y, z from the lower corner. Tetrahedral: linear between the corners that
    // are passed as steps are taken in the order of their shares, so that a voxel's is the least share of its steps over the largest of
    // the others.
    double shareOf(int k, const double* share) const {
        double weight = 1, least = 1, largest = 0;
        for (int a = 0; a < 3; ++a) {
            const bool isUpper = (k >> a & 1) != 0;
            weight *= isUpper ? share[a] : 1 - share[a];
            if (isUpper)
                least = std::min(least, share[a]);
            else
                largest = std::max(largest, share[a]);
        }
        return options.tetrahedral ? std::max(0.0, least - largest) : weight;
    }

    // What counts of a voxel, of the level's coordinates `corner`: nothing while it touches the plane, all from a sixteenth of its side on.
    double before(const Plane& plane, int cascade, int level, Vec corner) const {
        const Vec off = corner + Vec{0.5, 0.5, 0.5} - placed(plane.at, cascade) * std::ldexp(1.0, -level), n = plane.normal;
        const double touches = 0.5 * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
        return std::clamp(16 * (dot(off, n) - touches), 0.0, 1.0);
    }

    Sample sample(int cascade, int level, Vec at, Vec d, const Plane& plane) const {
        const double scale = std::ldexp(1.0, -level), most = (size() >> level) - 1,
                     p[3] = {at.x, at.y, at.z}, way[3] = {d.x, d.y, d.z};
        int corner[3];
        double share[3];
        for (int a = 0; a < 3; ++a) {
            const double q = std::clamp(p[a] * scale - 0.5, 0.0, most);
            corner[a] = int(q);
            share[a] = q - corner[a];
        }
        Sample sum, side[3];
        double weights[8], all = 0;
        for (int k = 0; k < 8; ++k) {
            weights[k] = shareOf(k, share);
            const Vec own{double(corner[0] + (k & 1)), double(corner[1] + (k >> 1 & 1)), double(corner[2] + (k >> 2))};
            if (options.startPlane) weights[k] *= before(plane, cascade, level, own);
            all += weights[k];
        }
        for (int k = 0; k < 8; ++k) {
            int i[3];
            for (int a = 0; a < 3; ++a) i[a] = corner[a] + (k >> a & 1);
            const double weight = options.startPlane ? weights[k] / std::max(all, 1.0 / 64) : weights[k];
            if (weight <= 0) continue;
            if (level == 0 ? options.sides : options.mode == LW_VOXEL_MODE_ANISOTROPIC) {
                for (int a = 0; a < 3; ++a)
                    add(side[a], word(cascade, level, 2 * a + (way[a] > 0), i, corner), weight);
            } else if (options.mode == LW_VOXEL_MODE_SH2) {
                Sample one;
                add(one, word(cascade, level, 0, i, corner), 1);
                for (int c = 0; c < 3; ++c) {
                    const cl_uint bands = word(cascade, level, c + 1, i, corner);
                    double along = 0;
                    for (int a = 0; a < 3; ++a)
                        along -= way[a] * double(voxel_unpack_harmonic(bands, a, 1.0f));
                    sum.colour[c] +=
                        weight * one.colour[c] * (0.28209479177387814 + 0.4886025119029199 * along);
                }
                sum.opacity += weight * one.opacity;
                sum.squares += weight * one.squares;
            } else {
                add(sum, word(cascade, level, 0, i, corner), weight);
            }
        }
        // Surfaces that close a share of the voxel's side, whose layer a ray crosses in 1 / |d| steps.
        double closed = 0, taken = 0, variance = sum.variance(), highest = sum.mostVariance();
        for (int a = 0; a < 3; ++a) {
            closed = std::max(closed, side[a].opacity);
            taken += std::abs(way[a]) * side[a].opacity;
            variance += std::abs(way[a]) * side[a].variance();
            highest += std::abs(way[a]) * side[a].mostVariance();
        }
        sum.closed = std::clamp(variance / std::max(highest, 1e-6), 0.0, 1.0);
        const double grown = 1 / std::max(1 - closed + taken, 1e-6);
        // Light that stands beside an opacity of less than a step of 8 bits is not made more than what that step would send.
        const double bright = std::min(grown, std::max(1.0, 255 * taken * grown));
        for (int a = 0; a < 3; ++a) {
            const double part = std::abs(way[a]);
            for (int c = 0; c < 3; ++c) sum.colour[c] += part * bright * side[a].colour[c];
            sum.opacity += part * grown * side[a].opacity;
        }
        for (double& c : sum.colour) c = std::max(c, 0.0);
        return sum;
    }

    Vec placed(Vec world, int cascade) const {
        const LwGridPlace& place = voxels.place[std::size_t(cascade)];
        const double inverse = double(place.origin.s[3]);
        return (world -
                Vec{double(place.origin.s[0]), double(place.origin.s[1]), double(place.origin.s[2])}) *
               inverse;
    }
    bool holds(Vec at, double margin) const {
        const double n = size();
        return std::min({at.x, at.y, at.z}) >= margin && std::max({at.x, at.y, at.z}) <= n - margin;
    }

    Light march(Vec world, Vec d, int grid, const std::vector<LwConeStep>& steps, double reach, const Plane& plane) const {
        Light light;
        double before = 0;
        for (const LwConeStep& step : steps) {
            const double distance = std::ldexp(double(step.distance), grid);
            const Vec outermost = placed(world, cascades() - 1) +
                                  d * std::ldexp(double(step.begins), grid + 1 - cascades());
            if (distance > reach || !holds(outermost, 0) || light.through <= double(LW_CONE_LEAST))
                break;
            const int wanted = step.level + grid;
            int cascade = 0, level = 0;
            Vec at;
            for (;; ++cascade) {
                level = std::clamp(wanted - cascade, 0, voxel_levels(size()) - 1);
                at = placed(world, cascade) + d * std::ldexp(distance, -cascade);
                if (cascade + 1 == cascades() || holds(at, 0.5 * std::ldexp(1.0, level))) break;
            }
            const Sample s = sample(cascade, level, at, d, plane);
            const double exponent =
                double(step.exponent) * std::ldexp(1.0, std::min(0, wanted - cascade));
            const double alone = options.opacityCorrection
                                     ? 1 - std::pow(1 - std::min(1.0, s.opacity), exponent)
                                     : s.opacity;
            // Of what the sample before has left of a layer that both see.
            const double share = 1 / std::max({1 - s.closed * before, alone, 1e-6}),
                         opacity = alone * share;
            before = alone;
            // Voxels of next to no opacity may have some light.
            const double ratio = share * (s.opacity > 1e-6            ? alone / s.opacity
                                          : options.opacityCorrection ? exponent
                                                                      : 1);
            for (int c = 0; c < 3; ++c)
                light.colour[c] += light.through * double(step.light) * s.colour[c] * ratio;
            light.occluded += light.through * double(step.dimming) * opacity;
            light.through *= 1 - opacity;
        }
        return light;
    }

    // What a schedule is for these options.
    ConeSchedule schedule() const {
        ConeSchedule s;
        const double side = std::ldexp(double(size()), cascades() - 1);
        s.nudge = options.nudge;
        s.step = options.step;
        s.reach = std::min(options.distance, std::sqrt(3.0)) * side;
        s.openReach = options.occlusionDistance * side;
        s.levels = std::uint32_t(voxel_levels(size()) + cascades() - 1);
        s.apertureOffset = options.apertureOffset;
        s.near = options.near;
        s.corrected = options.opacityCorrection;
        return s;
    }

    struct Gathered {
        double irradiance[3] = {0, 0, 0}, validity = 0, open = 0;
    };
    Gathered gather(Vec p, Vec n, const std::vector<ConeDirection>& set) const {
        Gathered g;
        int grid = 0;
        while (grid + 1 < cascades() && !holds(placed(p, grid), 0)) ++grid;
        if (!holds(placed(p, cascades() - 1), 0)) return g;
        // The frame of Duff et al. 2017.
        const double sign = n.z < 0 ? -1 : 1, a = -1 / (sign + n.z), b = n.x * n.y * a;
        const Vec tangent{1 + sign * n.x * n.x * a, sign * b, -sign * n.x},
            across{b, sign + n.y * n.y * a, -n.y};
        for (const ConeDirection& cone : set) {
            const Vec d = tangent * cone.d[0] + across * cone.d[1] + n * cone.d[2];
            const std::vector<LwConeStep> steps = coneSteps(cone.halfAngle, cone.d[2], schedule());
            const double begin = std::ldexp(double(steps[0].distance), grid + 1 - cascades());
            if (!holds(placed(p, cascades() - 1) + d * begin, 0)) continue;
            const Light l = march(p, d, grid, steps, schedule().reach, {p, n});
            for (int c = 0; c < 3; ++c)
                g.irradiance[c] += 3.14159265358979323846 * cone.weight *
                                   (l.colour[c] + l.through * environment[std::size_t(c)]);
            g.open += cone.weight * (1 - l.occluded);
            g.validity += cone.weight;
        }
        return g;
    }
};

}  // namespace lightwell::reference
