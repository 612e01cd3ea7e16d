// Sets of cones over the hemisphere or the sphere, and where along a cone its samples lie.
// docs/techniques/cone_gather.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/cone_types.h"

namespace lightwell {

struct ConeDirection {
    std::array<double, 3> d;  // unit; of a hemisphere about +z
    double weight;            // share of the irradiance, or of the sphere; all together 1
    double halfAngle;
};

// Over the hemisphere: 6 or 9 cones of 60 degrees; 16, 64 or 256 of the same weight, the cells of a
// square on the disc.
std::vector<ConeDirection> coneHemisphere(std::uint32_t count);
// Over the sphere, each of the same part of it, as narrow as `count` are over the hemisphere: for light
// in two bands of harmonics.
std::vector<ConeDirection> coneSphere(std::uint32_t count);

// Columns and rows of the window of pixels that share out a set when it is interleaved, and cones of
// each pixel.
struct ConeWindow {
    std::uint32_t columns = 1, rows = 1, perPixel = 1;
};
ConeWindow coneWindow(std::uint32_t count);

// Of all a set's cones.
struct ConeSchedule {
    double nudge = 1.0;  // where cones begin: voxels along the normal
    double step = 1.0;   // in cells
    double reach = 1.0;  // in voxels
    double openReach =
        0.0;  // within which ambient occlusion counts what it meets, in voxels; 0: nothing
    std::uint32_t levels = 1;
    bool apertureOffset =
        false;              // all of the first sphere is off the surface by `nudge`, not only its centre
    bool near = false;      // light is dimmed by what stands nearer than where cones begin
    bool corrected = true;  // exponents are those of the steps' lengths; else 1
};

// cosine: of the cone's direction and the normal; 1 without a normal.
std::vector<LwConeStep> coneSteps(double halfAngle, double cosine, const ConeSchedule& schedule);

struct ConeTable {
    std::vector<LwCone> cones;
    std::vector<LwConeStep> steps;
    // Adds a cone; steps of the same angles are kept once.
    void add(const ConeDirection& direction, double cosine, const ConeSchedule& schedule);

private:
    struct Known {
        double halfAngle, cosine;
        lw_int first, count;
    };
    std::vector<Known> known_;
};

}  // namespace lightwell
