// An infinite plane's light in a light propagation volume, in double: what irradiance read there is calibrated by.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "shared/lpv_types.h"

namespace lightwell {

// An infinite plane is the same in all of a layer's cells: the step becomes one of layers, c0 and c1 along the plane's normal,
// with four of six neighbours in the layer itself. Layers 0 and last are the empty borders.
struct LpvPlaneLayers {
    static constexpr double kPi = 3.14159265358979323846;
    explicit LpvPlaneLayers(std::size_t count) : c0(count + 2), c1(count + 2) {}
    std::vector<double> c0, c1;

    // isBlocked: the lowest layer lies on a surface that fills its cells. Between its cells are two corners of that surface and two
    // of none: max(B(d), B(-d)) is 1/8 + 1/4 |d.n|, of the 1/4 + 1/sqrt(5) that let nothing through.
    LpvPlaneLayers stepped(bool isBlocked) const {
        const double front = LW_LPV_FRONT_ANGLE / kPi, side = LW_LPV_SIDE_ANGLE / kPi, root5 = std::sqrt(5.0);
        const double full = 0.25 + 1.0 / root5;
        const double a = 1.0 / 6.0, b = LW_LPV_LOBE0 * LW_LPV_Y1 * (front + 8.0 / root5 * side);
        const double p = LW_LPV_LOBE1 * LW_LPV_Y0 * front, q = 0.5 * front;
        LpvPlaneLayers next(c0.size() - 2);
        for (std::size_t j = 1; j + 1 < c0.size(); ++j) {
            const bool passes = !isBlocked || j > 1;
            const double along = passes ? 1.0 : 1.0 - 0.125 / full;
            const double oblique = passes ? 1.0 : 1.0 - (0.125 + 0.25 / root5) / full;
            // Of each neighbour beside: straight on and to two sides along the layer, to two sides out of it.
            const double kept0 = LW_LPV_LOBE0 * LW_LPV_Y0 * (along * (front + 2.0 * side) + oblique * 2.0 * side);
            const double kept1 = LW_LPV_LOBE1 * LW_LPV_Y1 * oblique * side * 2.0 / root5;
            next.c0[j] = 4.0 * kept0 * c0[j] + a * (c0[j - 1] + c0[j + 1]) + b * (c1[j - 1] - c1[j + 1]);
            next.c1[j] = 4.0 * kept1 * c1[j] + p * (c0[j - 1] - c0[j + 1]) + q * (c1[j - 1] + c1[j + 1]);
        }
        return next;
    }
    void add(const LpvPlaneLayers& other) {
        for (std::size_t j = 0; j < c0.size(); ++j) {
            c0[j] += other.c0[j];
            c1[j] += other.c1[j];
        }
    }

    // Of exitance 1 over cells of side 1 in the lowest of `count` layers.
    static LpvPlaneLayers plane(std::size_t count) {
        LpvPlaneLayers layers(count);
        layers.c0[1] = LW_LPV_LOBE0 / kPi;
        layers.c1[1] = LW_LPV_LOBE1 / kPi;
        return layers;
    }
    // What makes the mean irradiance over the four cells above the plane 1.
    double calibration() const {
        constexpr std::size_t kLayers = 4;
        double sum = 0.0;
        for (std::size_t j = 2; j < 2 + kLayers; ++j) sum += LW_LPV_LOBE0 * c0[j] + LW_LPV_LOBE1 * c1[j];
        return sum > 0.0 ? double(kLayers) / sum : 0.0;
    }
};

}  // namespace lightwell
