// directRadiance against albedo and lights, without shadows: lit pixels share the factor that is wrong.
#include <algorithm>
#include <cmath>

#include "inputs/input_check_parts.h"
#include "inputs/input_light.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kFewest = 64;
// Share of pixels with one and the same factor that makes it the factor of the picture, and the share
// that may at most have none: the fully lit ones, in no scene tried below a tenth of the lit.
constexpr double kPeakShare = 0.2, kNoPeakShare = 0.03, kPeakWidth = 0.04;

}  // namespace

void checkDirect(const Surfaces& g, const LWLight* lights, std::uint32_t count, Findings& findings) {
    if (!g.direct || !g.albedo || !g.albedoTrusted || !g.trusted || count == 0) return;
    static constexpr struct {
        double factor;
        const char* text;
    } kFactors[] = {
        {1.0, ""},
        {kPi, "it is pi times what albedo / pi * E makes: the 1/pi of a diffuse surface is missing"},
        {1 / kPi, "it is 1/pi of what albedo / pi * E makes: divided by pi twice"},
        {2.0, "it is twice what albedo / pi * E makes"},
        {0.5, "it is half of what albedo / pi * E makes"}};
    std::uint64_t peaks[std::size(kFactors)] = {}, examined = 0;
    std::vector<std::uint32_t> pixels;
    for (std::uint32_t k = 0; k < count; ++k) {
        const glm::dvec3 sent = emitted(lights[k]);
        if (!(sent.x + sent.y + sent.z > 0.0)) return;
    }
    g.sample([&](std::uint32_t x, std::uint32_t y) {
        if (!g.surface(x, y)) return;
        const glm::dvec3 p = g.position.triple(x, y), n = g.unitNormal(x, y),
                         albedo = g.albedo.triple(x, y), direct = g.direct.triple(x, y);
        glm::dvec3 irradiance(0.0);
        for (std::uint32_t k = 0; k < count; ++k) {
            const LWLight& l = lights[k];
            glm::dvec3 way(l.direction[0], l.direction[1], l.direction[2]);
            if (l.kind == LW_LIGHT_DIRECTIONAL) {
                const double length = glm::length(way);
                if (length > 0.0) irradiance += emitted(l) * std::max(0.0, glm::dot(n, -way / length));
                continue;
            }
            way = p - glm::dvec3(l.position[0], l.position[1], l.position[2]);
            const double distance = glm::length(way);
            irradiance +=
                emitted(l) * (coneFalloff(l, way / distance) *
                              std::max(0.0, glm::dot(n, -way / distance)) / (distance * distance));
        }
        const double wanted =
            (albedo.x * irradiance.x + albedo.y * irradiance.y + albedo.z * irradiance.z) / kPi;
        const double given = direct.x + direct.y + direct.z;
        if (!(wanted > 0.0) || !std::isfinite(wanted) || !(given > 0.0) || !std::isfinite(given)) return;
        ++examined;
        pixels.push_back(y * g.width + x);
        for (std::size_t k = 0; k < std::size(kFactors); ++k)
            peaks[k] += std::abs(std::log(given / wanted / kFactors[k].factor)) < kPeakWidth;
    });
    if (examined < kFewest || shareOf(peaks[0], examined) > kNoPeakShare) return;
    for (std::size_t k = 1; k < std::size(kFactors); ++k) {
        if (shareOf(peaks[k], examined) < kPeakShare) continue;
        Found& f = findings.add(LW_FAULT_DIRECT_SCALE, LW_SEVERITY_ERROR, g.argument("directRadiance"),
                                {peaks[k], examined, kFactors[k].factor, 1.0, 0.9}, "for ",
                                percent(peaks[k], examined), " of the lit pixels ", kFactors[k].text,
                                "; nearly none have the right value");
        if (g.shown) f.pixels = std::move(pixels);
        f.step = g.step;
        return;
    }
}

}  // namespace lightwell
