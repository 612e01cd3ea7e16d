// Normals and depth against each other: the normal that neighbouring positions span must be the one that
// the host gives. Depth read wrongly bends planes, and normals of another space turn away; the guess
// that makes both agree is the cause. Interpolated and mapped normals differ from the geometry's, but at
// random, so that no guess is better nearly everywhere.
#include <cmath>

#include "inputs/input_normal_guesses.h"

namespace lightwell {
namespace {

// Differences to both sides of a pixel agree within this share of their sum where the surface is smooth;
// farther apart there is an edge between. Perspective alone makes them differ on floors seen at a small
// angle.
constexpr double kSmooth = 0.25;
constexpr std::uint64_t kFewest = 64;
// A guess is better (worse) at a pixel when its cosine with the geometry is higher (lower) by this:
// 0.003 is the turn from 0 to 4.4 degrees.
constexpr double kBetterBy = 0.003;
// Of the pixels where it makes a difference, the guess must be better at this share; and it must make a
// difference at a tenth of all. True causes reach 0.99. Surfaces finer than a pixel (roof tiles in a
// coarse RSM) alias into others, whose normals a mirrored axis fitted at 0.83.
constexpr double kWinningShare = 0.93, kMovedShare = 0.1;
// And it must explain most of the picture: cosines above 0.9 at this share.
constexpr double kAgreeing = 0.9, kAgreeingShare = 0.6;
// Share of the surfaces that must be smooth when a depth is guessed: a wrong one may leave a few by
// chance.
constexpr double kSmoothShare = 0.1;
// Normals facing away on smooth ground: silhouettes and interpolation stay below a fifth of a per cent
// in every scene tried.
constexpr double kFlippedShare = 0.02;

glm::dvec3 normalBy(const Surfaces& s, const NormalGuess& guess, std::uint32_t x, std::uint32_t y,
                    const glm::dvec3& given) {
    if (guess.normal) return guess.normal(given);
    if (!guess.flipX && !guess.flipY) return given;
    const glm::dvec3 other =
        s.normal.triple(guess.flipX ? s.width - 1 - x : x, guess.flipY ? s.height - 1 - y : y);
    return finite(other) && other != glm::dvec3(0.0) ? glm::normalize(other) : glm::dvec3(0.0);
}

// The geometry's normal at a pixel, on the side of the eye; false at edges.
bool geometricNormal(const Surfaces& s, const Place& place, std::uint32_t x, std::uint32_t y,
                     glm::dvec3& normal) {
    if (x == 0 || y == 0 || x + 1 >= s.width || y + 1 >= s.height) return false;
    glm::dvec3 p, around[8];  // pairs of opposite pixels: across, down, and the diagonals
    const std::uint32_t xs[8] = {x - 1, x + 1, x, x, x - 1, x + 1, x + 1, x - 1},
                        ys[8] = {y, y, y - 1, y + 1, y - 1, y + 1, y - 1, y + 1};
    if (!s.drawn(x, y) || !place(x, y, p)) return false;
    for (int k = 0; k < 8; ++k)
        if (!s.drawn(xs[k], ys[k]) || !place(xs[k], ys[k], around[k])) return false;
    for (int k = 0; k < 8; k += 2)
        if (glm::length(around[k] + around[k + 1] - 2.0 * p) >
            kSmooth * glm::length(around[k + 1] - around[k]))
            return false;
    const glm::dvec3 across = glm::cross(around[1] - around[0], around[3] - around[2]);
    const double length = glm::length(across);
    if (!(length > 0.0)) return false;
    normal = across / length;
    const glm::dvec3 towards = s.towardsEye(p);
    if (glm::dot(normal, towards) < 0.0) normal = -normal;
    return true;
}

// A pixel as given: made once, since every guess is held against it.
struct Sample {
    std::uint32_t x, y;
    bool smooth;  // the positions as given span `geometry`
    glm::dvec3 geometry, normal, towards;
};

std::vector<Sample> samplesOf(const Surfaces& s, const Place& given) {
    std::vector<Sample> samples;
    s.sample([&](std::uint32_t x, std::uint32_t y) {
        if (!s.drawn(x, y)) return;  // read as another kind, a depth may have no place at all
        Sample sample{x, y, false, {}, s.unitNormal(x, y), s.towardsEye(s.position.triple(x, y))};
        sample.smooth = geometricNormal(s, given, x, y, sample.geometry);
        if (sample.smooth || s.depth) samples.push_back(sample);
    });
    return samples;
}

struct Contest {
    std::uint64_t smooth = 0, better = 0, worse = 0, agreeing = 0, perfect = 0, away = 0;
    std::vector<std::uint32_t> pixels, awayPixels;
    bool won() const {
        return shareOf(better, better + worse) >= kWinningShare &&
               shareOf(better, smooth) >= kMovedShare && shareOf(agreeing, smooth) >= kAgreeingShare;
    }
};

// `guess` against what was given. An orthographic camera without a known direction cannot tell sides:
// cosines then count by their size.
Contest contest(const Surfaces& s, const std::vector<Sample>& samples, const NormalGuess& guess) {
    Contest result;
    for (const Sample& sample : samples) {
        glm::dvec3 geometry = sample.geometry;
        const bool other =
            guess.place ? geometricNormal(s, guess.place, sample.x, sample.y, geometry) : sample.smooth;
        // Depth read wrongly flattens edges away: only the guess knows where ground is smooth.
        if (guess.place ? !other : !sample.smooth) continue;
        const bool sided = s.sided();
        const auto cosine = [&](const glm::dvec3& a, const glm::dvec3& b) {
            return sided ? glm::dot(a, b) : std::abs(glm::dot(a, b));
        };
        const double before = sample.smooth ? cosine(sample.normal, sample.geometry) : -2.0;
        const double after =
            other ? cosine(normalBy(s, guess, sample.x, sample.y, sample.normal), geometry) : -2.0;
        const std::uint32_t pixel = sample.y * s.width + sample.x;
        ++result.smooth;
        result.better += after > before + kBetterBy;
        result.worse += before > after + kBetterBy;
        result.agreeing += after > kAgreeing;
        result.perfect += after > 1.0 - kBetterBy;
        if (s.shown && after > before + kBetterBy) result.pixels.push_back(pixel);
        if (sample.smooth && sided && before < -0.5 && glm::dot(sample.normal, sample.towards) < -0.1) {
            ++result.away;
            if (s.shown) result.awayPixels.push_back(pixel);
        }
    }
    return result;
}

// Of several guesses that win, the one that makes most of the picture agree.
const NormalGuess* bestOf(const Surfaces& s, const std::vector<Sample>& samples,
                          const std::vector<NormalGuess>& guesses, Contest& best) {
    const NormalGuess* winner = nullptr;
    for (const NormalGuess& guess : guesses) {
        Contest result = contest(s, samples, guess);
        if (result.smooth < kFewest || double(result.smooth) < kSmoothShare * double(samples.size()) ||
            !result.won())
            continue;
        if (winner &&
            shareOf(result.agreeing, result.smooth) < shareOf(best.agreeing, best.smooth) + 0.02)
            continue;
        winner = &guess;
        best = std::move(result);
    }
    return winner;
}

void reportFlips(const Surfaces& s, Contest& asGiven, Findings& findings) {
    if (shareOf(asGiven.away, asGiven.smooth) < kFlippedShare) return;
    Found& f = findings.add(
        LW_FAULT_NORMAL_FLIPPED, LW_SEVERITY_WARNING, s.argument("normal"),
        {asGiven.away, asGiven.smooth, shareOf(asGiven.away, asGiven.smooth), 0.0, 0.9},
        percent(asGiven.away, asGiven.smooth), " of the normals on smooth ground face away from the ",
        s.isRsm ? "light" : "camera",
        ": some meshes have the wrong winding, or two-sided materials are not turned to the viewer");
    f.pixels = std::move(asGiven.awayPixels);
    f.step = s.step;
}

// Depths that have no place though there are normals: beyond the clip planes, or no depth of this kind.
bool reportNoPlaces(Surfaces& s, const std::vector<Sample>& samples, Findings& findings) {
    if (!s.depth || samples.size() < kFewest) return false;
    const float first = s.depth.at(samples[0].x, samples[0].y);
    bool varied = false;
    for (const Sample& sample : samples) {
        if (s.surface(sample.x, sample.y)) return false;
        varied = varied || s.depth.at(sample.x, sample.y) != first;
    }
    s.trusted = false;
    findings.add(LW_FAULT_NO_SURFACES, varied ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING,
                 s.argument("depth"),
                 {samples.size(), samples.size(), double(first), 0.0, varied ? 0.9 : 0.5},
                 "no pixel with a normal has a depth that leads to a place in front of the camera (the "
                 "first is ",
                 first,
                 "), which means no surface: are depthKind and the projection matrix those that the "
                 "depth was drawn with?");
    return true;
}

}  // namespace

void checkNormals(Surfaces& s, const std::vector<NamedCamera>& others, Findings& findings) {
    if (!s.camera || !s.trusted) return;
    const Place given = [&s](std::uint32_t x, std::uint32_t y, glm::dvec3& p) {
        p = s.position.triple(x, y);
        return withinReach(p);
    };
    const NormalGuess asIs{LW_FAULT_NORMAL_DISAGREES, "", {}, {}};
    const std::vector<Sample> samples = samplesOf(s, given);
    Contest now = contest(s, samples, asIs);
    if (now.smooth < kFewest && !s.depth) return;
    // Nothing can be better at a tenth of the picture when nine tenths are perfect.
    if (now.smooth >= kFewest && shareOf(now.perfect, now.smooth) > 1.0 - kMovedShare)
        return reportFlips(s, now, findings);

    Contest best, bestDepth;
    const NormalGuess* winner = nullptr;
    const std::vector<NormalGuess> normals = normalGuesses(s, others);
    const std::vector<NormalGuess> depths = s.depth ? depthGuesses(s) : std::vector<NormalGuess>();
    winner = bestOf(s, samples, normals, best);
    const NormalGuess* depthWinner = bestOf(s, samples, depths, bestDepth);
    if (depthWinner && (!winner || bestDepth.agreeing > best.agreeing)) {
        winner = depthWinner;
        best = std::move(bestDepth);
    }
    const bool disagrees = now.smooth >= kFewest && shareOf(now.agreeing, now.smooth) < 0.15;
    if (!winner && !disagrees) {
        if (!reportNoPlaces(s, samples, findings)) reportFlips(s, now, findings);
        return;
    }
    // Places from a wrong depth are wrong; places of wrong normals stand.
    s.trusted = false;
    const bool depthFault =
        winner && (winner->fault == LW_FAULT_DEPTH_REVERSED || winner->fault == LW_FAULT_DEPTH_KIND);
    const double before = shareOf(now.agreeing, now.smooth);
    const double after = winner ? shareOf(best.agreeing, best.smooth) : before;
    const std::uint64_t affected = winner ? best.better : now.smooth - now.agreeing;
    const std::uint64_t examined = winner ? best.smooth : now.smooth;
    Found& f = findings.add(
        winner ? winner->fault : LW_FAULT_NORMAL_DISAGREES,
        winner ? LW_SEVERITY_ERROR : LW_SEVERITY_WARNING, s.argument(depthFault ? "depth" : "normal"),
        {affected, examined, before, 1.0, winner ? after : 0.5}, "on smooth ground ",
        percent(now.agreeing, now.smooth), " of the normals agree with the ",
        s.depth ? "depth" : "positions", " (within 26 degrees)",
        winner
            ? ""
            : ", and no usual mistake explains it: are both of one frame, and the normals the world's?",
        winner ? ", and " + percent(best.agreeing, best.smooth) + " would if " : std::string(),
        winner ? winner->text : std::string());
    if (winner) f.pixels = std::move(best.pixels);
    f.step = s.step;
}

}  // namespace lightwell
