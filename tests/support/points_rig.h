// Lists of points through the C API: what a host hands over, what comes back, and what light in two bands gives a surface.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "support/scoped_api.h"

namespace lightwell::test {

// Y0 and Y1 of the header's L(d) = Y0 c0 + Y1 (c1 . d).
inline const double kY0 = 0.5 / std::sqrt(3.14159265358979323846), kY1 = std::sqrt(3.0 / (4.0 * 3.14159265358979323846));

struct PointList {
    std::vector<float> positions, normals;  // x, y, z of each

    std::uint32_t count() const { return std::uint32_t(positions.size() / 3); }
    void add(reference::Vec p, reference::Vec n) {
        for (const double x : {p.x, p.y, p.z}) positions.push_back(float(x));
        for (const double x : {n.x, n.y, n.z}) normals.push_back(float(x));
    }
    // The pixels of a G-buffer, row by row.
    template <class Scene>
    static PointList ofScene(const Scene& scene) {
        PointList list;
        for (std::uint32_t y = 0; y < scene.position.height(); ++y)
            for (std::uint32_t x = 0; x < scene.position.width(); ++x) list.add(scene.position.get(x, y), scene.normal.get(x, y));
        return list;
    }
    // Points `first` to `first + number` alone.
    PointList part(std::size_t first, std::size_t number) const {
        const auto cut = [&](const std::vector<float>& v) {
            return std::vector<float>(v.begin() + std::ptrdiff_t(3 * first), v.begin() + std::ptrdiff_t(3 * (first + number)));
        };
        return {cut(positions), cut(normals)};
    }
};

struct PointLights {
    std::vector<float> irradiance, harmonics, validity;  // r, g, b of each point; of each band's points; of each point

    double e(std::size_t i, std::size_t colour = 0) const { return double(irradiance[3 * i + colour]); }
    double band(std::size_t b, std::size_t i, std::size_t colour = 0) const {
        return double(harmonics[3 * (b * validity.size() + i) + colour]);
    }
    reference::Vec c1(std::size_t i, std::size_t colour = 0) const { return {band(1, i, colour), band(2, i, colour), band(3, i, colour)}; }
    // Irradiance of a normal by the header's formula.
    double fromBands(std::size_t i, reference::Vec n, std::size_t colour = 0) const {
        const double pi = 3.14159265358979323846;
        return std::max(0.0, pi * kY0 * band(0, i, colour) + 2.0 * pi / 3.0 * kY1 * dot(c1(i, colour), n));
    }
};

inline LWImage listImage(const std::vector<float>& values, std::uint32_t count, std::uint32_t rows, LWFormat format) {
    LWImage image{};
    image.host = const_cast<float*>(values.data());
    image.format = format;
    image.width = count;
    image.height = rows;
    return image;
}

enum PointWants : unsigned { kPointIrradiance = 1, kPointHarmonics = 2, kPointValidity = 4, kPointAll = 7 };

// Waits. With `withNormals` false the list's normals are not handed over.
inline PointLights renderPoints(LWDevice device, LWTechnique technique, const PointList& list, unsigned wants = kPointAll,
                                bool withNormals = true) {
    const std::uint32_t n = list.count();
    PointLights result;
    result.irradiance.assign(3 * n, -1.0f);
    result.harmonics.assign(12 * n, -1.0f);
    result.validity.assign(n, -1.0f);
    LWPointOutput output{};
    output.structSize = sizeof output;
    if (wants & kPointIrradiance) output.irradiance = listImage(result.irradiance, n, 1, LW_FORMAT_FLOAT3);
    if (wants & kPointHarmonics) output.harmonics = listImage(result.harmonics, n, 4, LW_FORMAT_FLOAT3);
    if (wants & kPointValidity) output.validity = listImage(result.validity, n, 1, LW_FORMAT_FLOAT1);
    const LWImage positions = listImage(list.positions, n, 1, LW_FORMAT_FLOAT3), normals = listImage(list.normals, n, 1, LW_FORMAT_FLOAT3);
    const LWStatus status = lwRenderPoints(technique, &positions, withNormals ? &normals : nullptr, n, &output);
    INFO(lastError(device));
    REQUIRE(status == LW_SUCCESS);
    REQUIRE(lwFinish(device) == LW_SUCCESS);
    return result;
}

}  // namespace lightwell::test
