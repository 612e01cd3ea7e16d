// Surfels of made-up discs on paraboloid maps in tests.
#pragma once

#include <cstring>
#include <vector>

#include "inputs/surfel_set.h"
#include "passes/pull_push.h"
#include "passes/surfel_splat.h"
#include "support/paraboloid_rig.h"

namespace lightwell::test {

// A disc as a host would describe it; albedo in steps that 10 bits hold apart.
struct Disc {
    reference::Vec centre, normal;
    double area = 0.0;
    std::uint32_t albedo = 0;  // packed
};

// Squares of side near `spacing` that tile the parallelogram at `corner`, as surfels of their area.
inline void addDiscs(std::vector<Disc>& discs, reference::Vec corner, reference::Vec u, reference::Vec v, double spacing) {
    const int columns = int(std::ceil(reference::length(u) / spacing)), rows = int(std::ceil(reference::length(v) / spacing));
    const reference::Vec normal = reference::cross(u, v);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            discs.push_back({corner + u * ((i + 0.5) / columns) + v * ((j + 0.5) / rows), reference::unit(normal),
                             reference::length(normal) / (columns * rows), std::uint32_t(discs.size() * 7919u) & 0x3fffffffu});
}

class SurfelRig : public ParaboloidRig {
public:
    SurfelRig(std::uint32_t width, std::uint32_t size) : ParaboloidRig(width, size), splat(device()), holes(device()) {}

    // Planes of the discs; `scale`: of all lengths.
    SurfelSet upload(const std::vector<Disc>& discs, double scale = 1.0) {
        memory_.reset(executor(), std::uint32_t(discs.size()), LW_SURFEL_PLANES);
        memory_.noteChange();
        const std::size_t stride = memory_.planes().width;
        std::vector<float> planes(stride * LW_SURFEL_PLANES, 0.0f);
        for (std::size_t i = 0; i < discs.size(); ++i) {
            const Disc& d = discs[i];
            const double values[LW_SURFEL_ALBEDO] = {d.centre.x * scale, d.centre.y * scale, d.centre.z * scale,
                                                     d.normal.x, d.normal.y, d.normal.z,
                                                     std::sqrt(d.area / 3.14159265358979323846) * scale};
            for (std::size_t p = 0; p < LW_SURFEL_ALBEDO; ++p) planes[p * stride + i] = float(values[p]);
            std::memcpy(&planes[LW_SURFEL_ALBEDO * stride + i], &d.albedo, 4);
        }
        if (!discs.empty()) executor().writeCopy("test.write", memory_.memory(), 0, planes.size() * 4, planes.data());
        memory_.measure(executor());
        device().finish();
        return memory_.set();
    }
    // Splats the discs; holes are filled on demand.
    DrawnMaps splatted(const std::vector<Disc>& discs, std::vector<lw_cluster> clusters, bool fill, double scale = 1.0) {
        const SurfelSet set = upload(discs, scale);
        const std::uint32_t count = std::uint32_t(clusters.size());
        pass.recordPlaces(executor(), KernelRig::upload(clusters), count, *set.diagonal, set.revision);
        splat.record(executor(), set, pass.texels());
        if (fill) holes.record(executor(), pass.texels());
        pass.noteDrawn(set.revision);
        device().finish();
        return maps();
    }

    SurfelSplat splat;
    PullPush holes;

private:
    SurfelMemory memory_;
};

}  // namespace lightwell::test
