// What tests of static_vpl's passes share: a frame's input on the device, memory as values.
#pragma once

#include <catch2/catch.hpp>
#include <cstddef>
#include <vector>

#include "inputs/static_vpl_input.h"
#include "shared/vpl_types.h"
#include "support/kernel_rig.h"
#include "support/static_vpl_rig.h"

namespace lightwell::test {

template <class T>
std::vector<T> contents(KernelRig& rig, const Buffer& buffer, std::size_t count) {
    rig.device().finish();
    std::vector<T> values(count);
    buffer.download(0, count * sizeof(T), values.data());
    return values;
}

inline double fluxOf(const lw_vpl& vpl) {
    return double(vpl.flux.s[0]) + double(vpl.flux.s[1]) + double(vpl.flux.s[2]);
}
inline glm::dvec3 vec(const cl_float4& v) {
    return {double(v.s[0]), double(v.s[1]), double(v.s[2])};
}

// Three lights, of which the sun is not for receivers with baked light, in a room of `count` places.
struct PassScene : StaticScene {
    float profile[4] = {1.0f, 0.5f, 0.7f, 0.0f};
    explicit PassScene(std::size_t count) {
        vpls = roomOfPlaces(count, 5);
        lights = {pointLight({2, 1.5, 2.5}, {10, 12, 14}),
                  spotLight({2, 2, 2}, {0, -1, 0}, {20, 20, 20}, 0.2, 0.4),
                  sunLight({0.1, -1, 0.2}, {1, 1, 1})};
        lights[0].profile = profile;
        lights[0].profileCount = 4;
        put(lights[0].direction, {0, -1, 0});
        lights[2].receivers = LW_RECEIVERS_UNBAKED;
        block({1, 1, 1}, 0.8);
    }
    PassScene(const PassScene&) = delete;
};

inline void import(KernelRig& rig, StaticVplInput& input, const StaticScene& scene,
                   const std::vector<lw_phantom>& phantoms = {}) {
    input.import(rig.executor(), scene.frame(), 1.0f, false, phantoms);
}

}  // namespace lightwell::test
