// What can be told pixel by pixel: numbers that are none, signs, ranges, the length of normals.
#include <algorithm>
#include <cmath>

#include "inputs/input_check_parts.h"
#include "shared/input_limits.h"
#include "shared/rsm_types.h"

namespace lightwell {
namespace {

// Deviation from unit length that counts. Normals in 8 bits per component are off by up to 0.7 %, halves
// by 0.05 %; 2 % is also what lwUpdate allows for VPLs.
constexpr double kLengthTolerance = 0.02;
// What the kernels take for a normal and bring to unit length (shared/surface.h); RSMs' are in any case.
constexpr double kShortest = 0.5, kLongest = 2.0;
// Share of pixels off from which it is no accident of a few triangles.
constexpr double kLengthShare = 0.01;
// 1 in 32-bit floats, and what halves and blending leave of it.
constexpr double kLargestAlbedo = 1.002;

bool anyChannel(const HostPlanes& planes, std::uint32_t x, std::uint32_t y, bool (*test)(float)) {
    for (std::uint32_t c = 0; c < planes.channels(); ++c)
        if (test(planes.at(x, y, c))) return true;
    return false;
}
bool notFinite(float v) {
    return !std::isfinite(v);
}
// Infinities are told as such, and not twice.
bool negative(float v) {
    return v < 0.0f && std::isfinite(v);
}
bool aboveOne(float v) {
    return v > float(kLargestAlbedo) && std::isfinite(v);
}
bool tooMuchFlux(float v) {
    return v > LW_LARGEST_FLUX && std::isfinite(v);
}

struct Tally {
    std::uint64_t count = 0;
    std::vector<std::uint32_t> pixels;
    double worst = 0.0;  // of the values that failed, by magnitude
};

// Every pixel: one NaN is enough to spoil a picture. Only where the normal is not zero: elsewhere
// anything may stand.
Tally tally(const Surfaces& s, const HostPlanes& planes, bool (*test)(float)) {
    Tally result;
    for (std::uint32_t y = 0; y < s.height; ++y)
        for (std::uint32_t x = 0; x < s.width; ++x) {
            const glm::dvec3 n = s.normal.triple(x, y);
            if (n == glm::dvec3(0.0) || !anyChannel(planes, x, y, test)) continue;
            ++result.count;
            for (std::uint32_t c = 0; c < planes.channels(); ++c) {
                const auto value = double(planes.at(x, y, c));
                if (test(planes.at(x, y, c)) && std::abs(value) > std::abs(result.worst))
                    result.worst = value;
            }
            if (s.shown) result.pixels.push_back(y * s.width + x);
        }
    return result;
}

// Positions that are numbers but no places to the kernels.
Tally tallyFar(const Surfaces& s) {
    Tally result;
    for (std::uint32_t y = 0; y < s.height; ++y)
        for (std::uint32_t x = 0; x < s.width; ++x) {
            const glm::dvec3 p = s.position.triple(x, y);
            if (s.normal.triple(x, y) == glm::dvec3(0.0) || !finite(p) || withinReach(p)) continue;
            ++result.count;
            result.worst = std::max(result.worst, glm::length(p));
            if (s.shown) result.pixels.push_back(y * s.width + x);
        }
    return result;
}

void add(Findings& findings, LWInputFault fault, LWSeverity severity, const Surfaces& s,
         const char* image, Tally&& found, double expected, const char* text) {
    const std::uint64_t all = std::uint64_t(s.width) * s.height;
    Found& f =
        findings.add(fault, severity, s.argument(image), {found.count, all, found.worst, expected, 1.0},
                     percent(found.count, all), " of the ", s.isRsm ? "texels" : "pixels", " ", text);
    f.pixels = std::move(found.pixels);
}

void checkNumbers(const Surfaces& s, Findings& findings) {
    struct Image {
        const char* name;
        const HostPlanes& planes;
        bool mayBeNegative;
    };
    static const HostPlanes kNone;
    const Image images[] = {
        {"normal", s.normal, true},  {"position", s.depth ? kNone : s.position, true},
        {"albedo", s.albedo, false}, {"directRadiance", s.direct, false},
        {"motion", s.motion, true},  {"roughness", s.roughness, true},
        {"flux", s.flux, false}};
    for (const Image& image : images) {
        if (!image.planes) continue;
        Tally bad = tally(s, image.planes, notFinite);
        if (bad.count)
            add(findings, LW_FAULT_NOT_FINITE, LW_SEVERITY_ERROR, s, image.name, std::move(bad), 0.0,
                "with a surface are NaN or infinite: look for divisions by zero, normalize(0), buffers "
                "never cleared");
        if (image.mayBeNegative) continue;
        Tally below = tally(s, image.planes, negative);
        if (below.count)
            add(findings, LW_FAULT_NEGATIVE, LW_SEVERITY_ERROR, s, image.name, std::move(below), 0.0,
                "are negative: there is no negative light; look for ringing filters, or colours outside "
                "the gamut");
    }
    if (s.depth) {
        // A depth without a place means "no surface" and is allowed, but NaN is no renderer's
        // background.
        Tally bad = tally(s, s.depth, [](float v) { return std::isnan(v); });
        if (bad.count)
            add(findings, LW_FAULT_NOT_FINITE, LW_SEVERITY_WARNING, s, "depth", std::move(bad), 0.0,
                "with a normal have a depth that is NaN; they are taken as background");
    }
    if (!s.depth) {
        Tally far = tallyFar(s);
        if (far.count)
            add(findings, LW_FAULT_NOT_FINITE, LW_SEVERITY_ERROR, s, "position", std::move(far),
                double(LW_LARGEST_DISTANCE),
                "with a surface have a position beyond 1e9 units from the origin; they are taken as no "
                "surface. Hand over a larger unit of length, or zero normals where there is background");
    }
    if (s.flux) {
        Tally huge = tally(s, s.flux, tooMuchFlux);
        if (huge.count)
            add(findings, LW_FAULT_FLUX_SCALE, LW_SEVERITY_ERROR, s, "flux", std::move(huge),
                double(LW_LARGEST_FLUX), "have a flux above 1e30 and carry nothing");
    }
}

void checkAlbedo(Surfaces& s, Findings& findings) {
    if (!s.albedo) return;
    Tally above = tally(s, s.albedo, aboveOne);
    if (!above.count) return;
    const bool bytes = above.worst > 2.0;
    s.albedoTrusted = false;
    add(findings, LW_FAULT_ALBEDO_RANGE, LW_SEVERITY_ERROR, s, "albedo", std::move(above), 1.0,
        bytes ? "have an albedo far above 1, as if it were stored as 0 .. 255 or held light: divide by "
                "255, or hand "
                "over the surface's reflectance alone"
              : "have an albedo above 1: surfaces would send more light than they get; check that it is "
                "reflectance, "
                "not base colour times light");
}

// A view of nothing but sky has no normals either; but then nothing was drawn that differs from pixel to
// pixel.
void reportNoSurfaces(const Surfaces& s, Findings& findings) {
    const HostPlanes& places = s.depth ? s.depth : s.position;
    bool varied = false;
    for (std::uint32_t c = 0; c < places.channels(); ++c)
        for (std::uint32_t y = 0; y < s.height && !varied; ++y)
            for (std::uint32_t x = 0; x < s.width && !varied; ++x)
                varied = std::isfinite(places.at(x, y, c)) && places.at(x, y, c) != places.at(0, 0, c);
    const std::uint64_t all = std::uint64_t(s.width) * s.height;
    findings.add(LW_FAULT_NO_SURFACES, varied ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING,
                 s.argument("normal"), {all, all, 0.0, 1.0, varied ? 1.0 : 0.5},
                 "every normal is zero, which means no surface: validity and irradiance will be zero "
                 "everywhere. ",
                 varied
                     ? "Was the image drawn, and the right texture bound?"
                     : "Right when the camera sees nothing but sky; else: was the G-buffer drawn, and "
                       "the right texture bound?");
}

// Shares of examined surfaces with unit normals, and with normals that are unit once decoded.
void checkLengths(Surfaces& s, Findings& findings) {
    std::uint64_t some = 0, surfaces = 0, off = 0, refused = 0, encoded = 0, grey = 0;
    std::vector<std::uint32_t> pixels;
    std::vector<double> lengths;
    for (std::uint32_t y = 0; y < s.height; ++y)
        for (std::uint32_t x = 0; x < s.width; ++x) {
            const glm::dvec3 n = s.normal.triple(x, y);
            some += n != glm::dvec3(0.0);
            if (!finite(n) || n == glm::dvec3(0.0)) continue;
            ++surfaces;
            const double length = glm::length(n);
            if (std::abs(length - 1.0) <= kLengthTolerance) continue;
            ++off;
            refused += length <= kShortest || length >= kLongest;
            lengths.push_back(length);
            const double decoded = glm::length(2.0 * n - 1.0);
            grey += decoded <= kLengthTolerance;  // what a zero normal is encoded to
            const bool inRange = glm::all(glm::greaterThanEqual(n, glm::dvec3(-1e-3)));
            encoded += inRange && std::abs(decoded - 1.0) <= kLengthTolerance;
            if (s.shown) pixels.push_back(y * s.width + x);
        }
    if (some == 0) {
        s.trusted = false;
        if (!s.isRsm) reportNoSurfaces(s, findings);
        return;
    }
    if (off == 0 || shareOf(off, surfaces) < kLengthShare) return;
    const double median = medianOf(lengths);
    const bool lost = !s.isRsm && shareOf(refused, surfaces) >= kLengthShare;
    const bool isEncoded = encoded > 0 && shareOf(encoded, off - grey) > 0.5;
    if (isEncoded) s.trusted = false;
    Found& f =
        isEncoded
            ? findings.add(
                  LW_FAULT_NORMAL_ENCODED, LW_SEVERITY_ERROR, s.argument("normal"),
                  {encoded, surfaces, median, 1.0, shareOf(encoded, off - grey)},
                  percent(encoded, surfaces),
                  " of the normals are unit only as 2 n - 1: they are still stored as n/2 + 1/2. Decode "
                  "them, or hand them over as LW_FORMAT_UNORM8X4, which is decoded here")
            : findings.add(
                  LW_FAULT_NORMAL_LENGTH, lost ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING,
                  s.argument("normal"), {off, surfaces, median, 1.0, 0.9}, percent(off, surfaces),
                  " of the normals are not unit (median length of these ", median, "): ",
                  lost ? percent(refused, surfaces) +
                             " are shorter than 1/2 or longer than 2 and no surface to Lightwell"
                       : std::string("they are brought to unit length, so that only rounding suffers"),
                  ". Normalise after interpolation and after scaling by the model's matrix");
    f.pixels = std::move(pixels);
}

}  // namespace

void checkValues(Surfaces& s, Findings& findings) {
    checkNumbers(s, findings);
    checkAlbedo(s, findings);
    checkLengths(s, findings);
}

}  // namespace lightwell
