// Scenes of static VPLs through the C API, and the serial double-precision twin of what lights make of
// them.
#pragma once

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "support/scoped_api.h"

namespace lightwell::test {

constexpr double kRigPi = 3.14159265358979323846;

inline glm::dvec3 vec(const float* v) {
    return {double(v[0]), double(v[1]), double(v[2])};
}
inline void put(float* to, const glm::dvec3& v) {
    for (int a = 0; a < 3; ++a) to[a] = float(v[a]);
}

inline LWStaticVpl staticVpl(const glm::dvec3& position, const glm::dvec3& normal, double weight = 1.0,
                             const glm::dvec3& rho = glm::dvec3(0.5)) {
    LWStaticVpl vpl{};
    put(vpl.position, position);
    put(vpl.normal, glm::normalize(normal));
    put(vpl.reflectance, rho);
    vpl.weight = float(weight);
    return vpl;
}

inline LWLight sunLight(const glm::dvec3& direction, const glm::dvec3& irradiance) {
    LWLight light;
    LW_INIT(light);
    light.kind = LW_LIGHT_DIRECTIONAL;
    put(light.direction, direction);
    put(light.irradiance, irradiance);
    return light;
}

inline LWLight pointLight(const glm::dvec3& position, const glm::dvec3& intensity) {
    LWLight light;
    LW_INIT(light);
    light.kind = LW_LIGHT_POINT;
    put(light.position, position);
    put(light.radiantIntensity, intensity);
    return light;
}

inline LWLight spotLight(const glm::dvec3& position, const glm::dvec3& direction,
                         const glm::dvec3& intensity, double inner, double outer) {
    LWLight light = pointLight(position, intensity);
    light.kind = LW_LIGHT_SPOT;
    put(light.direction, direction);
    light.innerConeAngle = float(inner);
    light.outerConeAngle = float(outer);
    return light;
}

struct StaticScene {
    std::vector<LWStaticVpl> vpls;
    std::vector<LWBlocker> blockers;
    std::vector<LWLight> lights;
    bool reset = false;
    const LWGeometry* geometry = nullptr;

    void block(const glm::dvec3& center, double radius) {
        LWBlocker blocker{};
        put(blocker.center, center);
        blocker.radius = float(radius);
        blockers.push_back(blocker);
    }
    LWFrame frame() const {
        LWFrame frame;
        LW_INIT(frame);
        frame.reset = reset ? 1 : 0;
        frame.staticVpls = vpls.data();
        frame.staticVplCount = std::uint32_t(vpls.size());
        frame.blockers = blockers.data();
        frame.blockerCount = std::uint32_t(blockers.size());
        frame.lights = lights.data();
        frame.lightCount = std::uint32_t(lights.size());
        frame.geometry = geometry;
        return frame;
    }
};

// Share of light along the segment from x to y, or on from x without end.
inline double twinVisibility(const StaticScene& scene, const glm::dvec3& x, const glm::dvec3& d,
                             bool endless) {
    double visible = 1.0;
    for (const LWBlocker& blocker : scene.blockers) {
        const glm::dvec3 c = vec(blocker.center) - x;
        double t = std::max(0.0, glm::dot(c, d) / glm::dot(d, d));
        if (!endless) t = std::min(t, 1.0);
        visible *= std::min(1.0, std::pow(glm::length(c - t * d) / double(blocker.radius), 2.0));
    }
    return visible;
}

// Irradiance at a place from one light, W/m^2.
inline glm::dvec3 twinIrradiance(const StaticScene& scene, const LWStaticVpl& vpl, const LWLight& light,
                                 bool blocked = true) {
    const glm::dvec3 x = vec(vpl.position), n = vec(vpl.normal);
    if (light.kind == LW_LIGHT_DIRECTIONAL) {
        const glm::dvec3 d = -glm::normalize(vec(light.direction));
        return vec(light.irradiance) *
               (std::max(0.0, glm::dot(n, d)) * (blocked ? twinVisibility(scene, x, d, true) : 1.0));
    }
    const glm::dvec3 d = vec(light.position) - x;
    const double h = glm::length(d);
    double share = std::max(0.0, glm::dot(n, d)) / (h * h * h);
    const double angle =
        glm::length(vec(light.direction)) > 0.0
            ? std::acos(
                  std::min(1.0, std::max(-1.0, -glm::dot(d, glm::normalize(vec(light.direction))) / h)))
            : 0.0;
    if (light.kind == LW_LIGHT_SPOT) {
        const double inner = std::cos(double(light.innerConeAngle)),
                     outer = std::cos(double(light.outerConeAngle));
        share *= std::pow(
            std::min(1.0, std::max(0.0, (std::cos(angle) - outer) / std::max(1e-3, inner - outer))),
            2.0);
    }
    if (light.profileCount) {
        const double at = angle / kRigPi * (light.profileCount - 1);
        const auto below = std::min(std::size_t(at), std::size_t(light.profileCount - 2));
        share *=
            double(light.profile[below]) +
            (double(light.profile[below + 1]) - double(light.profile[below])) * (at - double(below));
    }
    return vec(light.radiantIntensity) * (share * (blocked ? twinVisibility(scene, x, d, false) : 1.0));
}

class StaticRig {
public:
    StaticRig(std::uint32_t width, const LWStaticVplDesc& desc)
        : device(width), technique(device, "static_vpl", &desc) {}

    void update(const StaticScene& scene) { technique.update(scene.frame()); }
    LWStatus tryUpdate(const StaticScene& scene) {
        const LWFrame frame = scene.frame();
        return lwUpdate(technique, &frame);
    }

    // Planes of a debug view.
    std::vector<std::vector<double>> planes(const char* name) {
        std::uint32_t count = 0;
        REQUIRE(lwCountDebugViews(technique, nullptr, &count) == LW_SUCCESS);
        for (std::uint32_t i = 0; i < count; ++i) {
            LWDebugView view;
            LW_INIT(view);
            REQUIRE(lwDescribeDebugView(technique, nullptr, i, &view) == LW_SUCCESS);
            if (std::string(view.name) != name) continue;
            std::vector<float> values(std::size_t(view.width) * view.height * view.channels + 1);
            REQUIRE(lwReadDebugView(technique, nullptr, name, values.data(), values.size()) ==
                    LW_SUCCESS);
            std::vector<std::vector<double>> planes(view.channels);
            const std::size_t size = std::size_t(view.width) * view.height;
            for (std::size_t c = 0; c < planes.size(); ++c)
                planes[c].assign(values.begin() + std::ptrdiff_t(c * size),
                                 values.begin() + std::ptrdiff_t((c + 1) * size));
            return planes;
        }
        FAIL("no debug view of this name: " << name);
        return {};
    }
    // Before culling, of each static VPL.
    std::vector<glm::dvec3> flux(bool baked = false) {
        const auto all = planes("static_vpls");
        const std::size_t first = baked ? 3 : 0;
        std::vector<glm::dvec3> flux;
        for (std::size_t i = 0; i < all[0].size(); ++i)
            flux.emplace_back(all[first][i], all[first + 1][i], all[first + 2][i]);
        return flux;
    }
    std::vector<double> areas() { return planes("static_vpls")[6]; }

    struct Vpl {
        glm::dvec3 position, normal, flux;
        double area;
    };
    // Of the list that is gathered, those with flux (interleave 1: in their order).
    std::vector<Vpl> vpls() {
        const auto p = planes("vpls");
        std::vector<Vpl> vpls;
        for (std::size_t i = 0; i < p[0].size(); ++i)
            if (p[6][i] + p[7][i] + p[8][i] > 0.0)
                vpls.push_back({{p[0][i], p[1][i], p[2][i]},
                                {p[3][i], p[4][i], p[5][i]},
                                {p[6][i], p[7][i], p[8][i]},
                                p[9][i]});
        return vpls;
    }

    std::vector<LWListedLight> lights() {
        std::vector<LWListedLight> lights(64);
        std::uint32_t count = 0;
        const LWStatus status = lwReadLightList(technique, lights.data(), 64, &count);
        INFO(lastError(device));
        REQUIRE(status == LW_SUCCESS);
        lights.resize(count);
        return lights;
    }

    TestDevice device;
    TestTechnique technique;
};

inline LWStaticVplDesc staticDesc() {
    LWStaticVplDesc desc;
    lwDefaultStaticVpl(&desc);
    return desc;
}

// Nothing is culled.
inline LWStaticVplDesc keepAll() {
    LWStaticVplDesc desc = staticDesc();
    desc.cullRelative = 0.0f;
    return desc;
}

// A bounded VPL's irradiance at a surface (conventions.md), double precision.
inline double twinLight(const StaticRig::Vpl& vpl, const glm::dvec3& x, const glm::dvec3& n,
                        int channel = 0) {
    const glm::dvec3 d = vpl.position - x;
    const double d2 = glm::dot(d, d), h = std::sqrt(d2);
    const double c = std::max(0.0, glm::dot(n, d) / h), cp = std::max(0.0, -glm::dot(vpl.normal, d) / h);
    return vpl.flux[channel] / kRigPi * c * cp / (d2 + (1.0 + 3.0 * cp * cp) / 4.0 * vpl.area / kRigPi);
}

// Places on the six walls of a room of these sides, facing inwards.
inline std::vector<LWStaticVpl> roomOfPlaces(std::size_t count, std::uint32_t seed,
                                             const glm::dvec3& size = glm::dvec3(4, 3, 5),
                                             double weight = 1.0) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<LWStaticVpl> vpls;
    for (std::size_t i = 0; i < count; ++i) {
        const int axis = int(i % 3);
        const bool far = i / 3 % 2 != 0;
        glm::dvec3 p(unit(random), unit(random), unit(random)), n(0.0);
        p[axis] = far ? 1.0 : 0.0;
        n[axis] = far ? -1.0 : 1.0;
        vpls.push_back(
            staticVpl(p * size, n, weight,
                      {0.2 + 0.7 * unit(random), 0.2 + 0.7 * unit(random), 0.2 + 0.7 * unit(random)}));
    }
    return vpls;
}

}  // namespace lightwell::test
