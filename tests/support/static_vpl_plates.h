// A floor of static VPLs in a room, and a plate between them and its ceiling: scenes of tests of
// static_vpl's shadows.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/kernel_rig.h"
#include "support/lit_room.h"
#include "support/packed_light.h"
#include "support/points_rig.h"
#include "support/static_vpl_rig.h"
#include "support/walls.h"

namespace lightwell::test::plates {

constexpr std::uint32_t kWidth = 45, kHeight = 32;
constexpr double kRounding = 1e-5;
// Of the room's walls half-way between floor and ceiling.
constexpr double kPlate[2][2] = {{-0.15, 0.3}, {0.2, 0.7}};  // x, z
constexpr double kPlateHeight = 0.5;

inline StaticScene litFloor(std::size_t count, const LWGeometry* geometry) {
    StaticScene scene;
    for (std::size_t i = 0; i < count; ++i) {
        const double u = double(i) * 0.6180339887498949, x = 0.9 * (u - std::floor(u) - 0.5),
                     z = (double(i) + 0.5) / double(count);
        scene.vpls.push_back(
            staticVpl({x, 0, z}, {0, 1, 0}, 1.0 / double(count), {0.8, 0.5 + 0.4 * x, 0.3}));
    }
    scene.lights = {pointLight({0.1, 0.45, 0.4}, {3, 2, 1}), sunLight({0.1, -1, 0}, {0.5, 1, 2})};
    scene.geometry = geometry;
    return scene;
}

inline LWStaticVplDesc descOf(LWVisibility visibility, std::uint32_t mapSize = 128) {
    LWStaticVplDesc desc = staticDesc();
    desc.visibility = visibility;
    desc.mapSize = mapSize;
    return desc;
}

inline void addPlate(Walls& walls, double left = kPlate[0][0]) {
    walls.add({left, kPlateHeight, kPlate[1][0]}, {kPlate[0][1] - kPlate[0][0], 0, 0},
              {0, 0, kPlate[1][1] - kPlate[1][0]});
}
// The floor, and walls well behind all that pixels show: where two walls meet, maps of any kind err by a
// texel.
inline Walls open() {
    Walls walls;
    walls.add({-1, 0, -0.5}, {2, 0, 0}, {0, 0, 2});
    walls.add({-1, 2, -0.5}, {2, 0, 0}, {0, 0, 2});
    for (const double x : {-1.0, 1.0}) walls.add({x, 0, -0.5}, {0, 2, 0}, {0, 0, 2});
    for (const double z : {-0.5, 1.5}) walls.add({-1, 0, z}, {2, 0, 0}, {0, 2, 0});
    return walls;
}
inline Walls withPlate(double left = kPlate[0][0]) {
    Walls walls = open();
    addPlate(walls, left);
    return walls;
}
// A room with a floor over its floor, below all that pixels show and far enough above for voxels: no light gets out.
inline Walls shut() {
    Walls walls = Walls::room();
    walls.add({-0.5, 0.11, 0}, {1, 0, 0}, {0, 0, 1});
    return walls;
}

// How far within the plate's border (negative: beyond it) the way from a floor's VPL to a place above
// crosses its plane; far beyond where it ends below.
inline double within(const glm::dvec3& vpl, const glm::dvec3& x) {
    if (x.y <= kPlateHeight) return -1.0;
    const glm::dvec3 p = vpl + (x - vpl) * ((kPlateHeight - vpl.y) / (x.y - vpl.y));
    return std::min(std::min(p.x - kPlate[0][0], kPlate[0][1] - p.x),
                    std::min(p.z - kPlate[1][0], kPlate[1][1] - p.z));
}

inline std::vector<float> render(std::uint32_t width, const LWStaticVplDesc& desc,
                                 const StaticScene& scene, const WallAndCeiling& view) {
    StaticRig rig(width, desc);
    TestView target(rig.device, view.position.width(), view.position.height());
    rig.update(scene);
    return rig.technique.render(target, view.gbuffer);
}

inline std::string choiceOf(TestTechnique& technique, const std::string& name) {
    const LWStats stats = technique.stats();
    for (std::uint32_t i = 0; i < stats.choiceCount; ++i)
        if (name == stats.choices[i].name) return stats.choices[i].reason;
    return "";
}

inline glm::dvec3 at(const PlanarPixels& pixels, std::uint32_t x, std::uint32_t y) {
    const reference::Vec v = pixels.get(x, y);
    return {v.x, v.y, v.z};
}

}  // namespace lightwell::test::plates
