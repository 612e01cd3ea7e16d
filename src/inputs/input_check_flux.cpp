// Flux against the light. Through a texel comes E_perp * A_texel from a sun and I(w) * Omega_texel from
// a lamp; flux over that is the albedo of the surface, which the G-buffer knows where it sees the same
// surface. A common factor between the two, or the sRGB curve, names the mistake. Without such places
// only bounds are left: no surface reflects more than it gets.
#include <algorithm>
#include <cmath>

#include "inputs/input_check_parts.h"
#include "inputs/input_light.h"

namespace lightwell {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::uint64_t kFewest = 64;
// Factors that may be there for a reason (light filtered, albedo at another texture level) and those
// that may not. The nearest named ones are 2 and 1/2.
constexpr double kLowest = 0.7, kHighest = 1.4;
// A factor is a named one within this share. Medians over textures scatter by some per cent.
constexpr double kNamed = 0.12;
// Darker albedo is mostly rounding.
constexpr double kDarkest = 0.02;
// And no material but black velvet reflects less than this.
constexpr double kBlackest = 0.01;
// sRGB is named when it explains the ratios this much better than nothing does, and well.
constexpr double kCurveResidual = 0.1, kCurveGain = 0.4, kPlainResidual = 0.15;
// More than all light: albedo of 1 and rounding.
constexpr double kWholePower = 1.02;

double srgbDecode(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double srgbEncode(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

// Flux over incident flux, and the albedo of the same place in the G-buffer.
struct Pair {
    double ratio, albedo;
};

// The G-buffer's albedo where it shows this texel's surface.
bool albedoOf(const Surfaces& g, const glm::dvec3& p, const glm::dvec3& n, double texelWidth,
              glm::dvec3& albedo) {
    glm::dvec2 pixel;
    if (!g.camera->project(p, pixel) ||
        !(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < g.width && pixel.y < g.height))
        return false;
    const auto x = std::uint32_t(pixel.x), y = std::uint32_t(pixel.y);
    if (!g.surface(x, y) || glm::dot(g.unitNormal(x, y), n) < 0.9) return false;
    const glm::dvec3 there = g.position.triple(x, y);
    const double tolerance = 2.0 * (texelWidth + g.camera->footprint(g.camera->axial(there)));
    if (glm::length(there - p) > tolerance) return false;
    albedo = g.albedo.triple(x, y);
    return finite(albedo);
}

struct FluxFigures {
    std::vector<Pair> pairs;
    std::vector<double> ratios;
    double flux = 0.0, incident = 0.0;  // W, of the examined texels with flux, channels added
    std::uint64_t lit = 0, surfaces = 0, impossible = 0, fluxTexels = 0;
    // Texels that the light reaches; those of the same place as a pixel; of these, not black ones.
    std::uint64_t reached = 0, matched = 0, bright = 0;
    double texels = 0.0;  // of one map
};

void addMap(const Surfaces* g, const LWLight& light, const Surfaces& map, FluxFigures& figures) {
    figures.texels = std::max(figures.texels, double(map.width) * map.height);
    map.sample([&](std::uint32_t x, std::uint32_t y) {
        const glm::dvec3 flux = map.flux.triple(x, y);
        if (!map.surface(x, y) || !finite(flux)) return;
        ++figures.surfaces;
        figures.fluxTexels += flux.x + flux.y + flux.z > 0.0;
        const glm::dvec3 incident = incidentFlux(light, map, x, y);
        const double in = incident.x + incident.y + incident.z, out = flux.x + flux.y + flux.z;
        // Rims of cones: rounding of the edge itself.
        if (!(in >
              1e-3 * (emitted(light).x + emitted(light).y + emitted(light).z) * map.camera->pixelArea()))
            return;
        ++figures.reached;
        const glm::dvec3 p = map.position.triple(x, y);
        glm::dvec3 albedo(0.0);
        const bool known =
            g && map.trusted &&
            albedoOf(*g, p, map.unitNormal(x, y), map.camera->footprint(map.camera->axial(p)), albedo);
        figures.matched += known;
        figures.bright += known && std::max({albedo.x, albedo.y, albedo.z}) >= kDarkest;
        if (!(out > 0.0)) return;
        ++figures.lit;
        figures.flux += out;
        figures.incident += in;
        figures.ratios.push_back(out / in);
        bool impossible = false;
        for (int c = 0; c < 3; ++c) impossible = impossible || flux[c] > kWholePower * incident[c];
        figures.impossible += impossible;
        if (!known) return;
        for (int c = 0; c < 3; ++c)
            if (albedo[c] >= kDarkest && flux[c] > 0.0 && incident[c] > 0.0)
                figures.pairs.push_back({flux[c] / incident[c], albedo[c]});
    });
}

struct NamedFactor {
    double factor;
    LWInputFault fault;
    const char* text;
};

std::vector<NamedFactor> fluxFactors(double texels) {
    return {
        {kPi, LW_FAULT_FLUX_PI, "times pi: flux is albedo * incident flux; nothing is multiplied by pi"},
        {1 / kPi, LW_FAULT_FLUX_PI,
         "1/pi: that is radiance's factor. Flux is albedo * incident flux, without 1/pi"},
        {2 * kPi, LW_FAULT_FLUX_PI, "2 pi: intensity was taken for the flux through a half-sphere"},
        {1 / (2 * kPi), LW_FAULT_FLUX_PI,
         "1/(2 pi): flux through a half-sphere was taken for intensity"},
        {4 * kPi, LW_FAULT_FLUX_PI, "4 pi: a lamp's whole power was taken for its intensity (W/sr)"},
        {1 / (4 * kPi), LW_FAULT_FLUX_PI,
         "1/(4 pi): a lamp's intensity was divided as if it were its power"},
        {texels, LW_FAULT_FLUX_TEXELS,
         "the number of texels: each texel holds the whole map's light; multiply by a texel's area or "
         "solid angle, not the map's"},
        {1 / texels, LW_FAULT_FLUX_TEXELS,
         "1 over the number of texels: the light was divided by it twice"},
        {683.0, LW_FAULT_FLUX_SCALE,
         "683, lumens to the watt: photometric and radiometric units are mixed"},
        {1 / 683.0, LW_FAULT_FLUX_SCALE,
         "1/683, lumens to the watt: photometric and radiometric units are mixed"},
        {1e4, LW_FAULT_FLUX_SCALE, "10,000: areas in square centimetres"},
        {1e-4, LW_FAULT_FLUX_SCALE, "1/10,000: areas in square centimetres"},
        {2.0, LW_FAULT_FLUX_SCALE, "2"},
        {0.5, LW_FAULT_FLUX_SCALE, "1/2"}};
}

// The named factor nearest to `factor`, else null.
const NamedFactor* nameOf(const std::vector<NamedFactor>& factors, double factor, double within) {
    const NamedFactor* best = nullptr;
    for (const NamedFactor& known : factors) {
        const double off = std::abs(std::log(factor / known.factor));
        if (off < within && (!best || off < std::abs(std::log(factor / best->factor)))) best = &known;
    }
    return best;
}

// How far the ratios are from a curve of the albedo: mean |log| between the quantiles of both.
// Quantiles, not pairs: pixel and texel see the same surface but not the same texel of its texture.
template <class Curve>
double residual(const std::vector<Pair>& pairs, const Curve& curve) {
    std::vector<double> ratios, expected;
    for (const Pair& pair : pairs) {
        ratios.push_back(std::log(pair.ratio));
        expected.push_back(std::log(curve(pair.albedo)));
    }
    std::sort(ratios.begin(), ratios.end());
    std::sort(expected.begin(), expected.end());
    double sum = 0.0;
    int count = 0;
    for (int percentile = 10; percentile <= 90; percentile += 5, ++count) {
        const std::size_t at = pairs.size() * std::size_t(percentile) / 100;
        sum += std::abs(ratios[at] - expected[at]);
    }
    return sum / count;
}

// The albedo of one side went through the sRGB curve once more than the other's.
bool reportCurve(const Surfaces& g, const LightMaps& light, const FluxFigures& figures,
                 Findings& findings) {
    const double plain = residual(figures.pairs, [](double a) { return a; });
    const double decoded = residual(figures.pairs, srgbDecode),
                 encoded = residual(figures.pairs, srgbEncode);
    const double best = std::min(decoded, encoded);
    if (!(plain >= kPlainResidual && best <= kCurveResidual && best <= kCurveGain * plain)) return false;
    std::vector<double> albedos;
    for (const Pair& pair : figures.pairs) albedos.push_back(pair.albedo);
    // A factor fits one grey as well as a curve does: the more greys there are, the surer.
    const double middle = medianOf(albedos);
    std::uint64_t other = 0;
    for (const double a : albedos) other += a < 0.8 * middle || a > 1.25 * middle;
    const double confidence = 0.6 + 0.35 * std::min(1.0, 4.0 * shareOf(other, albedos.size()));
    const bool gbuffer = decoded <= encoded;
    const char* const text = gbuffer ? "the G-buffer's albedo agrees once decoded: it is still "
                                       "sRGB-encoded (hand it over as LW_FORMAT_UNORM8X4_SRGB, or "
                                       "decode it), or the RSM's was decoded twice"
                                     : "the RSM agrees once the G-buffer's albedo is sRGB-encoded: its "
                                       "flux was made from an albedo that was not "
                                       "decoded, or the G-buffer's was decoded twice";
    Found& f = findings.add(LW_FAULT_ALBEDO_SRGB, LW_SEVERITY_ERROR,
                            gbuffer ? g.argument("albedo") : light.name + ".rsms[0].flux",
                            {figures.pairs.size(), figures.pairs.size(), plain, best, confidence},
                            "albedo and RSM flux over incident flux differ by ",
                            100.0 * (std::exp(plain) - 1.0), " % (mean over quantiles), and by ",
                            100.0 * (std::exp(best) - 1.0), " % after the sRGB curve: ", text);
    if (gbuffer && g.shown)
        g.sample([&](std::uint32_t x, std::uint32_t y) {
            if (g.surface(x, y)) f.pixels.push_back(y * g.width + x);
        });
    f.step = g.step;
    return true;
}

void reportFactor(const LightMaps& light, const FluxFigures& figures, double factor, bool fromPairs,
                  Findings& findings) {
    const std::vector<NamedFactor> factors = fluxFactors(figures.texels);
    const NamedFactor* named = nameOf(factors, factor, fromPairs ? kNamed : std::log(2.0));
    const bool exact = fromPairs && named && std::abs(std::log(factor / named->factor)) < kNamed;
    findings.add(
        named ? named->fault : LW_FAULT_FLUX_SCALE,
        exact || factor > 1.0 || !fromPairs ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING,
        light.name + ".rsms[0].flux", {figures.lit, figures.lit, factor, 1.0, exact ? 0.95 : 0.6},
        "flux is ", factor, " times what ",
        fromPairs ? "light and the G-buffer's albedo at the same places make of it"
                  : "a surface of albedo 1/2 would reflect of the light that the texels get",
        named
            ? (exact ? ", which is " : ", perhaps ")
            : ". A texel holds albedo * E_perp * its area (sun) or albedo * I * its solid angle (lamp)",
        named ? named->text : "");
}

// Without the albedo of the same places.
void reportBounds(const LightMaps& light, const FluxFigures& figures, Findings& findings) {
    if (figures.lit < kFewest) return;
    const double whole = figures.flux / figures.incident;
    if (whole > kWholePower || shareOf(figures.impossible, figures.lit) > 0.5) {
        reportFactor(light, figures, whole / 0.5, false, findings);
    } else if (figures.impossible * 100 > figures.lit) {
        findings.add(LW_FAULT_FLUX_SCALE, LW_SEVERITY_WARNING, light.name + ".rsms[0].flux",
                     {figures.impossible, figures.lit, whole, 1.0, 0.6},
                     percent(figures.impossible, figures.lit),
                     " of the lit texels reflect more than the light brings them: albedo above 1, or "
                     "flux that is not this light's alone");
    } else if (medianOf(figures.ratios) < std::min(kBlackest, 0.5 / figures.texels * 8.0)) {
        reportFactor(light, figures, whole / 0.5, false, findings);
    }
}

// No flux at all. Right where the light reaches nothing, or black things alone (metals have no diffuse
// albedo).
void reportEmpty(const LightMaps& light, const FluxFigures& figures, Findings& findings) {
    const std::string rsms = light.name + ".rsms";
    if (figures.reached == 0) {
        findings.add(
            LW_FAULT_RSM_EMPTY, LW_SEVERITY_NOTE, rsms, {0, figures.surfaces, 0.0, 1.0, 0.5},
            "the light shines, and its RSMs show no surface that it reaches: it lights nothing, "
            "or they were not drawn");
        return;
    }
    const bool proven = figures.bright >= kFewest, black = !proven && figures.matched >= kFewest;
    if (black && shareOf(figures.bright, figures.matched) < 0.01) return;
    findings.add(LW_FAULT_RSM_EMPTY, proven ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING, rsms,
                 {figures.reached, figures.reached, 0.0, 1.0, proven ? 0.95 : 0.8},
                 "the light shines and its RSMs show surfaces, but no texel has flux: was the flux "
                 "drawn, the right texture bound, and is it above 6e-8 W where it is half floats?",
                 proven ? "" : " (Right where all that it reaches is black.)");
}

}  // namespace

void checkFlux(const Surfaces* g, const LightMaps& light, Findings& findings) {
    const glm::dvec3 sent = emitted(*light.light);
    if (light.maps.empty() || !(sent.x + sent.y + sent.z > 0.0))
        return;  // intensity absent: nothing to compare with
    FluxFigures figures;
    const bool hasAlbedo = g && g->albedo && g->albedoTrusted && g->camera && g->trusted;
    for (const Surfaces& map : light.maps)
        if (map.camera && map.flux) addMap(hasAlbedo ? g : nullptr, *light.light, map, figures);
    if (figures.fluxTexels == 0) return reportEmpty(light, figures, findings);
    if (figures.pairs.size() < kFewest) return reportBounds(light, figures, findings);
    std::vector<double> logs;
    for (const Pair& pair : figures.pairs) logs.push_back(std::log(pair.ratio / pair.albedo));
    const double factor = std::exp(medianOf(std::move(logs)));
    const double asFactor = residual(figures.pairs, [&](double a) { return a * factor; });
    const double curve =
        std::min(residual(figures.pairs, srgbDecode), residual(figures.pairs, srgbEncode));
    if (curve <= std::max(asFactor, 0.02) && reportCurve(*g, light, figures, findings)) return;
    if (factor > kHighest || factor < kLowest) reportFactor(light, figures, factor, true, findings);
}

}  // namespace lightwell
