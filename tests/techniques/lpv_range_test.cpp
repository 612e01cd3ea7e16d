// How far light gets in a grid, by each of technique lpv's transports: the figures of docs/techniques/lpv_range.md, which
// docs/figures/lpv.py has this print. Not run otherwise: lpv_test "[.range]", "[.range_plane]".
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <string>

#include "passes/lpv_plane_layers.h"
#include "passes/lpv_pyramid.h"
#include "support/lpv_rig.h"
#include "support/scoped_api.h"
#include "support/sweep_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr double kBox = 64.0, kWall = 32.0, kPi = 3.14159265358979323846;
constexpr int kPlane = 64;  // cells a side of the plane's grid

// What surfaces read at cell centres of a column, of a plane in the lowest layer: facing it, and away. kappa 1.
struct Column {
    double facing[3], away[3];
};
constexpr int kCells[3] = {8, 16, 32};

void print(const std::string& method, const Column& column) {
    std::printf("range {\"table\": \"plane\", \"method\": \"%s\", \"facing\": [%.9g, %.9g, %.9g], \"away\": [%.9g, %.9g, %.9g]}\n",
                method.c_str(), column.facing[0], column.facing[1], column.facing[2], column.away[0], column.away[1], column.away[2]);
}

template <typename Bands>
Column columnOf(Bands bands) {
    Column column{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double even = std::sqrt(kPi) / 2.0 * bands(kCells[i], 0), odd = std::sqrt(kPi / 3.0) * bands(kCells[i], 3);
        column.facing[i] = std::max(0.0, even + odd);
        column.away[i] = std::max(0.0, even - odd);
    }
    return column;
}

Column endless(int steps) {
    const LpvPlaneLayers given = LpvPlaneLayers::plane(kPlane);
    LpvPlaneLayers light = given;
    for (int i = 0; i < steps; ++i) {
        light = light.stepped(false);
        light.add(given);
    }
    return columnOf([&](int cell, int band) { return (band ? light.c1 : light.c0)[std::size_t(cell) + 1]; });
}

// By the kernels, in a grid that is as wide as it is high. steps: 0: on a pyramid.
Column spread(std::uint32_t steps) {
    const double root = std::sqrt(kPi);
    LpvCells cells(kPlane);
    for (int y = 0; y < kPlane; ++y)
        for (int x = 0; x < kPlane; ++x) {
            cells.at(0, x, y, 0) = float(0.5 / root);
            cells.at(3, x, y, 0) = float(1.0 / (root * std::sqrt(3.0)));
        }
    KernelRig rig(16);
    LpvPropagation propagation(rig.device(), kPlane);
    LpvPyramid pyramid(rig.device(), kPlane, 0);
    const Guarded injected = rig.upload(cells.laidOut()), place = rig.upload(std::vector<LwLpvPlace>(1));
    const Buffer& light =
        steps ? propagation.record(rig.executor(), injected, steps)
              : pyramid.record(rig.executor(), injected, place, [](std::uint32_t, const Buffer&) { return nullptr; });
    rig.device().finish();
    const LpvCells result = LpvCells::of(light, kPlane);
    return columnOf([&](int cell, int band) { return double(result.at(band, kPlane / 2, kPlane / 2, cell)); });
}

Column swept(std::uint32_t directions) {
    LpvSweepOptions options;
    options.size = kPlane;
    options.directions = directions;
    SweepRig rig(16, options);
    std::vector<lw_vpl> lights;
    addEmitter(lights, {0, 0, 0}, {kPlane, 0, 0}, {0, kPlane, 0}, 0.5);
    rig.sweep(lights, {});
    Column column{};
    for (std::size_t i = 0; i < 3; ++i) {
        column.facing[i] = rig.read({{32.3, 32.3, kCells[i] + 1.0}}, {0, 0, -1})[0];
        column.away[i] = rig.read({{32.3, 32.3, double(kCells[i])}}, {0, 0, 1})[0];
    }
    return column;
}

struct Box {
    const char* name;
    double x0, x1, y0, y1;  // of the light on the floor
    double wallHeight;      // of a wall across the box at x = kWall, or 0
};
constexpr Box kBoxes[] = {{"floor", 0, 64, 0, 64, 0}, {"patch", 28, 36, 28, 36, 0}, {"wall", 8, 24, 24, 40, 16}};

double litFrom(const Box& box, Vec p, double x0, double x1) {
    if (x0 >= x1) return 0.0;
    return polygonIrradiance({{x0, box.y0, 0}, {x1, box.y0, 0}, {x1, box.y1, 0}, {x0, box.y1, 0}}, p, {0, 0, -1}, 1.0);
}

// Of the ceiling; what the wall leaves in sight (see lpv_sweep_box_test.cpp).
double truthAt(const Box& box, Vec p) {
    if (box.wallHeight <= 0.0) return litFrom(box, p, box.x0, box.x1);
    const double edge = p.x - (p.x - kWall) * p.z / (p.z - box.wallHeight), left = std::min(edge, kWall), right = std::max(edge, kWall);
    return litFrom(box, p, box.x0, std::min(box.x1, left)) + litFrom(box, p, std::max(box.x0, right), box.x1);
}

// The ceiling, 64 x 64 pixels, and beside it as many of the side at x = 64, below height 32, where the wall leaves nothing of its light.
struct BoxView {
    PlanarPixels position{128, 64, 3}, normal{128, 64, 3};
    LWGBuffer gbuffer{};
    BoxView() {
        for (std::uint32_t j = 0; j < 64; ++j)
            for (std::uint32_t i = 0; i < 64; ++i) {
                position.set(i, j, {i + 0.5, j + 0.5, kBox});
                normal.set(i, j, {0, 0, -1});
                position.set(64 + i, j, {kBox, i + 0.5, (j + 0.5) / 2.0});
                normal.set(64 + i, j, {-1, 0, 0});
            }
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.position = position.image();
        gbuffer.normal = normal.image();
    }
};

struct WallSurfels {
    std::vector<Disc> discs;
    PlanarPixels position, normal, area;
    LWGeometry geometry{};
    explicit WallSurfels(double height)
        : discs(discsOf(height)), position(count(), 1, 3), normal(count(), 1, 3), area(count(), 1, 1) {
        for (std::uint32_t i = 0; i < count(); ++i) {
            position.set(i, 0, discs[i].centre);
            normal.set(i, 0, discs[i].normal);
            area.at(i, 0, 0) = float(discs[i].area);
        }
        geometry.structSize = sizeof geometry;
        geometry.surfelCount = count();
        geometry.surfelPosition = position.image();
        geometry.surfelNormal = normal.image();
        geometry.surfelArea = area.image();
    }
    std::uint32_t count() const { return std::uint32_t(discs.size()); }
    static std::vector<Disc> discsOf(double height) {
        std::vector<Disc> discs;
        addDiscs(discs, {kWall, 0, 0}, {0, 0, height}, {0, kBox, 0}, 0.5);
        return discs;
    }
};

// Light through the grid, neither put in nor read.
bool carries(const std::string& pass) {
    for (const char* other : {"upload", "clear", "scan", "fit", "inject", "cover", "gather", "begin"})
        if (pass.find(other) != std::string::npos) return false;
    return true;
}

double carryTime(TestTechnique& technique) {
    const LWStats stats = technique.stats();
    double sum = 0.0;
    for (std::uint32_t i = 0; i < stats.passCount; ++i)
        if (carries(stats.passes[i].name)) sum += stats.passes[i].milliseconds;
    return sum;
}

void measure(LWDevice device, LWLpvDesc desc, const char* method, const Box& box) {
    const WallSurfels wall(16.0);
    const BoxView scene;
    std::vector<Disc> discs;
    addDiscs(discs, {box.x0, box.y0, 0}, {box.x1 - box.x0, 0, 0}, {0, box.y1 - box.y0, 0}, 0.5);
    std::vector<LWVpl> vpls(discs.size());
    for (std::size_t i = 0; i < discs.size(); ++i) {
        const Vec c = discs[i].centre;
        vpls[i] = LWVpl{{float(c.x), float(c.y), float(c.z)}, 0, {0, 0, 1}, 0, {0, 0, 0}, 0};
        for (float& flux : vpls[i].flux) flux = float(discs[i].area);
    }
    const bool hasWall = box.wallHeight > 0.0;
    desc.geometryVolume = hasWall ? LW_GEOMETRY_VOLUME_SURFELS : LW_GEOMETRY_VOLUME_OFF;
    desc.extent = float(kBox);
    for (float& c : desc.center) c = float(kBox / 2.0);
    LWFrame frame{};
    frame.structSize = sizeof frame;
    frame.vpls = vpls.data();
    frame.vplCount = std::uint32_t(vpls.size());
    if (hasWall) frame.geometry = &wall.geometry;
    TestTechnique technique(device, "lpv", &desc);
    TestView view(device, 128, 64);
    std::vector<double> times;
    std::vector<float> light;
    for (int run = 0; run < 4; ++run) {
        technique.update(frame);
        light = technique.render(view, scene.gbuffer);
        if (run > 0) times.push_back(carryTime(technique));
    }
    std::sort(times.begin(), times.end());
    double ff = 0.0, ft = 0.0, tt = 0.0, shadow = 0.0, mean = 0.0;
    for (std::uint32_t j = 0; j < 64; ++j)
        for (std::uint32_t i = 0; i < 64; ++i) {
            const double found = double(light[j * 128 + i]), truth = truthAt(box, scene.position.get(i, j));
            ff += found * found;
            ft += found * truth;
            tt += truth * truth;
            mean += truth / 4096.0;
            shadow += double(light[j * 128 + 64 + i]) / 4096.0;
        }
    std::printf("range {\"table\": \"box\", \"method\": \"%s\", \"box\": \"%s\", \"size\": %u, \"ff\": %.9g, \"ft\": %.9g, \"tt\": %.9g, "
                "\"shadow\": %.9g, \"mean\": %.9g, \"ms\": %.4g}\n",
                method, box.name, desc.size, ff, ft, tt, hasWall ? shadow : -1.0, mean, times[times.size() / 2]);
}

}  // namespace

TEST_CASE("range of a plane's light", "[.range_plane]") {
    for (const int steps : {16, 256, 8192}) {
        print("endless " + std::to_string(steps), endless(steps));
        print("propagate " + std::to_string(steps), spread(std::uint32_t(steps)));
    }
    print("coarse_to_fine", spread(0));
    for (const std::uint32_t directions : {384u, 1536u}) print("sweep " + std::to_string(directions), swept(directions));
    Column truth{};
    for (std::size_t i = 0; i < 3; ++i)
        truth.facing[i] = polygonIrradiance({{0, 0, 0}, {64, 0, 0}, {64, 64, 0}, {0, 64, 0}}, {32.3, 32.3, kCells[i] + 1.0}, {0, 0, -1}, 1.0);
    print("truth", truth);
    std::printf("range {\"table\": \"kappa\", \"coarse_to_fine\": %.9g}\n", LpvPyramid::calibration(kPlane, 0, false));
}

TEST_CASE("range of light in three boxes", "[.range]") {
    TestDevice device(0);
    LWLpvDesc desc;
    for (const std::uint32_t size : {16u, 32u, 64u})
        for (const Box& box : kBoxes) {
            lwDefaultLpv(&desc);
            desc.size = size;
            measure(device, desc, "propagate", box);
            desc.steps = 128;
            measure(device, desc, "propagate 128", box);
            desc.steps = 0;
            desc.transport = LW_LPV_TRANSPORT_COARSE_TO_FINE;
            measure(device, desc, "coarse_to_fine", box);
            desc.transport = LW_LPV_TRANSPORT_SWEEP;
            for (const std::uint32_t directions : {24u, 48u, 96u, 384u}) {
                desc.directions = directions;
                measure(device, desc, ("sweep " + std::to_string(directions)).c_str(), box);
            }
        }
}
