// Sweeps through a unit of cells in tests: lights and discs as lists, what arrives as numbers.
#pragma once

#include <cmath>
#include <vector>

#include "passes/lpv_sweep.h"
#include "passes/sweep_directions.h"
#include "shared/lpv_sweep_types.h"
#include "support/kernel_rig.h"
#include "support/surfel_rig.h"

namespace lightwell::test {

inline lw_vpl sweepLight(reference::Vec position, reference::Vec normal, reference::Vec flux) {
    return reference::makeVpl(position, normal, flux, 1.0);
}

// A rectangle of exitance 1 as lights, `spacing` apart.
inline void addEmitter(std::vector<lw_vpl>& lights, reference::Vec corner, reference::Vec u, reference::Vec v, double spacing) {
    std::vector<Disc> discs;
    addDiscs(discs, corner, u, v, spacing);
    for (const Disc& d : discs) lights.push_back(sweepLight(d.centre, d.normal, {d.area, d.area, d.area}));
}

// A grid of cells of side `cell` from the origin on.
class SweepRig : public KernelRig {
public:
    SweepRig(std::uint32_t width, const LpvSweepOptions& options, double cell = 1.0)
        : KernelRig(width), options_(options), pass(device(), options), cell_(cell) {}

    void sweep(const std::vector<lw_vpl>& lights, const std::vector<Disc>& discs, bool restart = true) {
        LwLpvPlace place{};
        place.origin.s[3] = float(1.0 / cell_);
        place.cell.s[0] = float(cell_);
        double largest = 0.0;
        for (const lw_vpl& light : lights)
            for (int c = 0; c < 3; ++c) largest = std::max(largest, double(light.flux.s[c]));
        // Room for 2^22 lights.
        const int shift = largest > 0.0 ? 40 - std::ilogb(largest) : 0;
        place.cell.s[1] = std::ldexp(1.0f, shift / 2);
        place.cell.s[2] = std::ldexp(1.0f, shift - shift / 2);
        const Guarded placed = upload(std::vector<LwLpvPlace>{place});
        const Guarded authored = upload(lights.empty() ? std::vector<lw_vpl>(1) : lights);
        pass.record(executor(), {rsms_, authored, std::uint32_t(lights.size()), placed, surfelsOf(discs), 1.0f, restart, specular});
        device().finish();
    }

    // What a group brings to a cell: for each axis and colour the sum of w L |d.axis|.
    struct Parts {
        std::uint32_t size;
        std::vector<float> values;
        double at(int group, int axis, int colour, int x, int y, int z) const {
            const int n = int(size), cell = group < 8 ? (z * n + x) * n + y : (z * n + y) * n + x;
            return double(values[std::size_t((group * LW_SWEEP_PARTS + 3 * axis + colour) * n * n * n + cell)]);
        }
        // Of the light that travels up (1) or down (0) the axis.
        double arriving(int axis, int up, int colour, int x, int y, int z) const {
            double sum = 0.0;
            for (int group = 0; group < LW_SWEEP_GROUPS; ++group)
                if ((group >> axis & 1) == up) sum += at(group, axis, colour, x, y, z);
            return sum;
        }
    };
    Parts parts() {
        Parts result{options_.size, std::vector<float>(pass.parts().bytes() / sizeof(float))};
        pass.parts().download(0, pass.parts().bytes(), result.values.data());
        return result;
    }

    // Irradiance of points, all of one normal; of red.
    std::vector<double> read(const std::vector<reference::Vec>& points, reference::Vec normal) {
        const auto count = std::uint32_t(points.size());
        const std::uint32_t stride = paddedWidth(count);
        std::vector<float> positions(3 * stride), normals(3 * stride);
        for (std::uint32_t i = 0; i < count; ++i) {
            const double p[3] = {points[i].x, points[i].y, points[i].z}, n[3] = {normal.x, normal.y, normal.z};
            for (std::uint32_t a = 0; a < 3; ++a) {
                positions[a * stride + i] = float(p[a]);
                normals[a * stride + i] = float(n[a]);
            }
        }
        const Guarded at = upload(positions), facing = upload(normals), light = make<float>(3 * stride),
                      counts = upload(std::vector<cl_int>(3));
        const auto planes = [&](const Guarded& buffer) {
            Planes result;
            result.memory = buffer.get();
            result.rowStride = result.planeStride = stride;
            result.width = count;
            result.height = 1;
            result.count = 3;
            return result;
        };
        pass.recordGather(executor(), planes(at), planes(facing), planes(light), Planes{}, counts);
        device().finish();
        const std::vector<float> found = download<float>(light);
        return std::vector<double>(found.begin(), found.begin() + count);
    }

private:
    SurfelSet surfelsOf(const std::vector<Disc>& discs) {
        if (discs.empty()) return {};
        surfels_.reset(executor(), std::uint32_t(discs.size()), LW_SURFEL_PLANES);
        surfels_.noteChange();
        const std::size_t stride = surfels_.planes().width;
        std::vector<float> planes(stride * LW_SURFEL_PLANES, 0.0f);
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const Disc& d = discs[i];
            const double values[LW_SURFEL_ALBEDO] = {d.centre.x, d.centre.y, d.centre.z, d.normal.x, d.normal.y, d.normal.z,
                                                     std::sqrt(d.area / 3.14159265358979323846)};
            for (std::size_t p = 0; p < LW_SURFEL_ALBEDO; ++p) planes[p * stride + i] = float(values[p]);
            std::memcpy(&planes[LW_SURFEL_ALBEDO * stride + i], &d.albedo, 4);
        }
        executor().writeCopy("test.write", surfels_.memory(), 0, planes.size() * 4, planes.data());
        return surfels_.set();
    }

    LpvSweepOptions options_;

public:
    LpvSweep pass;
    LpvSpecular* specular = nullptr;  // gets the light too

private:
    double cell_;
    RsmInput rsms_;
    SurfelMemory surfels_;
};

}  // namespace lightwell::test
