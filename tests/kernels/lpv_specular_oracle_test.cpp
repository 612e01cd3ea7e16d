// Specular rays against closed forms: lit walls at every angle and distance, closed boxes, what stands between, what is outside.
#include <catch2/catch.hpp>
#include <cmath>
#include <memory>

#include "support/lit_room.h"
#include "support/lpv_rig.h"
#include "support/specular_rig.h"

using namespace lightwell;
using namespace lightwell::test;
using reference::Vec;

namespace {

constexpr std::uint32_t kSize = 32;  // of cells of side 1

struct Wall {
    Vec corner, u, v;  // the normal is u x v
    double exitance;
};

// Walls as lights and discs, in the cells of a sweep or of propagation.
struct SpecularScene {
    virtual ~SpecularScene() = default;
    virtual SpecularLight march(const std::vector<SpecularPoint>& points, const LwSpecularView& view) = 0;
};

struct SweepScene final : SpecularScene {
    SweepRig rig;
    LpvSpecular pass;
    static LpvSweepOptions options() {
        LpvSweepOptions o;
        o.size = kSize;
        o.directions = 24;
        return o;
    }
    SweepScene(const std::vector<Wall>& walls, bool blocks) : rig(16, options()), pass(rig.device(), kSize) {
        std::vector<lw_vpl> lights;
        std::vector<Disc> discs;
        for (const Wall& w : walls) {
            if (blocks) addDiscs(discs, w.corner, w.u, w.v, 0.25);
            std::vector<Disc> parts;
            addDiscs(parts, w.corner, w.u, w.v, 0.25);
            for (const Disc& d : parts)
                if (w.exitance > 0.0) lights.push_back(sweepLight(d.centre, d.normal, Vec{1, 1, 1} * (d.area * w.exitance)));
        }
        rig.specular = &pass;
        rig.sweep(lights, discs);
    }
    SpecularLight march(const std::vector<SpecularPoint>& points, const LwSpecularView& view) override {
        return marchSpecular(rig, pass, points, view, rig.pass.shownPlace());
    }
};

// By hand what lpv_grid and lpv_blocking do.
struct StepScene final : SpecularScene {
    KernelRig rig{16};
    LpvSpecular pass;
    Guarded place;
    StepScene(const std::vector<Wall>& walls, bool blocks)
        : pass(rig.device(), kSize), place(rig.upload(std::vector<LwLpvPlace>{placeOf(1.0)})) {
        LpvCells light{int(kSize)};
        const int n = int(kSize) + 1;
        std::vector<float> corners(std::size_t(4 * n * n * n));
        for (const Wall& w : walls) {
            std::vector<Disc> discs;
            addDiscs(discs, w.corner, w.u, w.v, 0.25);
            for (const Disc& d : discs) {
                const Vec p = d.centre + d.normal * 0.5, unit = d.normal;
                const int x = int(p.x), y = int(p.y), z = int(p.z);
                const bool isInside = p.x >= 0 && p.y >= 0 && p.z >= 0 && x < int(kSize) && y < int(kSize) && z < int(kSize);
                for (int c = 0; c < 3 && isInside; ++c) {
                    const double flux = d.area * w.exitance / M_PI;
                    light.at(4 * c, x, y, z) += float(flux * LW_LPV_LOBE0);
                    light.at(4 * c + 1, x, y, z) += float(flux * LW_LPV_LOBE1 * unit.x);
                    light.at(4 * c + 2, x, y, z) += float(flux * LW_LPV_LOBE1 * unit.y);
                    light.at(4 * c + 3, x, y, z) += float(flux * LW_LPV_LOBE1 * unit.z);
                }
                const double side = unit.x + 1.8 * unit.y + 3.4 * unit.z < 0 ? -1.0 : 1.0;
                const int cx = int(std::floor(d.centre.x + 0.5)), cy = int(std::floor(d.centre.y + 0.5)), cz = int(std::floor(d.centre.z + 0.5));
                if (cx < 0 || cy < 0 || cz < 0 || cx >= n || cy >= n || cz >= n) continue;
                float* corner = &corners[std::size_t(4 * ((cz * n + cy) * n + cx))];
                corner[1] += float(side * unit.x * d.area * LW_LPV_LOBE1);
                corner[2] += float(side * unit.y * d.area * LW_LPV_LOBE1);
                corner[3] += float(side * unit.z * d.area * LW_LPV_LOBE1);
            }
        }
        const Guarded grid = rig.upload(light.laidOut()), blockers = rig.upload(corners);
        pass.recordPackSteps(rig.executor(), grid, place, blocks ? &blockers : nullptr);
        pass.show(rig.executor());
        rig.device().finish();
    }
    SpecularLight march(const std::vector<SpecularPoint>& points, const LwSpecularView& view) override {
        return marchSpecular(rig, pass, points, view, place);
    }
};

std::unique_ptr<SpecularScene> makeScene(bool sweeps, const std::vector<Wall>& walls, bool blocks) {
    if (sweeps) return std::make_unique<SweepScene>(walls, blocks);
    return std::make_unique<StepScene>(walls, blocks);
}

// A mirror at p whose ray goes along `ray`, for an eye at `eye`.
SpecularPoint mirror(Vec p, Vec ray, Vec eye) { return {p, reference::unit(reference::unit(eye - p) + reference::unit(ray)), 0.0}; }

}  // namespace

TEST_CASE("explore walls", "[lpv_specular]") {
    const bool sweeps = GENERATE(false, true), blocks = GENERATE(false, true);
    for (const double offset : {4.0, 4.25, 4.5, 4.75}) {
        auto scene = makeScene(sweeps, {{{0, 0, offset}, {32, 0, 0}, {0, 32, 0}, M_PI}}, blocks);
        for (const double degrees : {0.0, 20.0, 40.0, 44.0, 50.0, 60.0, 70.0, 80.0}) {
            double sum = 0, least = 1e9, most = 0;
            int count = 0;
            std::vector<SpecularPoint> points;
            const double angle = degrees * M_PI / 180;
            const Vec eye{16, 16, 31};
            for (int i = 0; i < 64; ++i) {
                const double h = 2.0 + i * 0.1, across = h * std::tan(angle);
                const double turn = 0.3 + i * 0.37;
                Vec ray{std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), -std::cos(angle)};
                Vec p{16 - 0.5 * across * std::cos(turn), 16 - 0.5 * across * std::sin(turn), offset + h};
                if (across > 26) continue;
                points.push_back(mirror(p, ray, eye));
            }
            if (points.empty()) continue;
            const auto light = scene->march(points, viewFrom(eye));
            for (std::size_t i = 0; i < points.size(); ++i) {
                sum += light.red(i);
                least = std::min(least, light.red(i));
                most = std::max(most, light.red(i));
                ++count;
            }
            std::printf("sweep %d blocks %d offset %.2f angle %g: mean %.3f min %.3f max %.3f (%d)\n", sweeps, blocks, offset, degrees, sum / count, least, most, count);
        }
    }
}
