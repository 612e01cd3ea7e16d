// RSMs against the G-buffer. A surface that the light sees lies, from the camera, on what the camera
// sees or behind it; never in front, or the camera would see it. Texels far in front of the picture mean
// that the two are not of one space. So may texels that are all elsewhere; but that alone proves
// nothing, since a lamp may light another room: there the guess that lays the texels, with their
// normals, onto the picture is the proof.
#include <algorithm>
#include <cmath>

#include "inputs/input_space_score.h"

namespace lightwell {
namespace {

// Where fewer lie on what is seen, other spaces are tried.
constexpr double kOnShare = 0.2;
// Of several guesses that explain the picture, the one with the largest share of its texels inside the
// picture on what is seen, by a margin for those that come later in the list: floors and walls often fit
// a wrong one as well.
constexpr double kClearlyBetter = 1.05;

struct Box {
    glm::dvec3 lower{HUGE_VAL}, upper{-HUGE_VAL};
    void add(const glm::dvec3& p) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    double diagonal() const { return glm::length(upper - lower); }
    double gapTo(const Box& other) const {
        return glm::length(
            glm::max(glm::dvec3(0.0), glm::max(lower - other.upper, other.lower - upper)));
    }
};

Box boxOf(const Surfaces& g) {
    Box box;
    g.sample([&](std::uint32_t x, std::uint32_t y) {
        if (g.surface(x, y)) box.add(g.position.triple(x, y));
    });
    return box;
}

// The guess that lays the texels onto the picture best; null where none explains it.
const SpaceGuess* bestOf(const Surfaces& g, const std::vector<Texel>& texels, const SpaceScore& given,
                         const std::vector<SpaceGuess>& guesses, SpaceScore& bestScore) {
    const SpaceGuess* best = nullptr;
    for (const SpaceGuess& guess : guesses) {
        SpaceScore score = scoreOf(g, texels, guess);
        if (!score.explains(g, given) ||
            (best && shareOf(score.on, score.inside) <=
                         kClearlyBetter * shareOf(bestScore.on, bestScore.inside)))
            continue;
        best = &guess;
        bestScore = std::move(score);
    }
    return best;
}

std::string causeOf(const SpaceGuess* best) {
    if (!best)
        return "no usual mistake explains it. Positions of both must be the world's, of one moment and "
               "one "
               "unit";
    if (best->fault != LW_FAULT_UNITS_DIFFER) return best->text;
    const char* const name = lengthFactorName(best->factor);
    std::ostringstream text;
    text << "times " << best->factor << (name ? std::string(" (") + name + ")" : "")
         << " the RSM lies on the G-buffer's surfaces: the two are in different units of length";
    return text.str();
}

void reportSpaces(const Surfaces& g, const LightMaps& light, SpaceScore& given, const SpaceGuess* best,
                  const SpaceScore& bestScore, Findings& findings) {
    const bool units = best && best->fault == LW_FAULT_UNITS_DIFFER;
    Found& f =
        findings.add(best ? best->fault : LW_FAULT_SPACES_DIFFER, LW_SEVERITY_ERROR,
                     best ? best->argument : light.name + ".rsms",
                     {given.all - given.on, given.all,
                      units ? 1.0 / best->factor : shareOf(given.on, given.all), 1.0, best ? 0.95 : 0.7},
                     percent(given.on, given.all), " of the texels lie on what the camera sees, ",
                     percent(given.inFront, given.all), " in front of it, where nothing can be",
                     best ? ", and " + percent(bestScore.on, bestScore.all) + " would lie on it: "
                          : std::string(": "),
                     causeOf(best));
    if (g.shown) f.pixels = std::move(given.pixels);
}

void reportElsewhere(const Surfaces& g, const LightMaps& light, const std::vector<Texel>& texels,
                     Findings& findings) {
    const Box seen = boxOf(g);
    Box lit;
    for (const Texel& texel : texels) lit.add(texel.position);
    const double gap = seen.gapTo(lit), size = std::max(seen.diagonal(), lit.diagonal());
    if (gap > size)
        findings.add(LW_FAULT_RSM_ELSEWHERE, LW_SEVERITY_WARNING, light.name + ".rsms",
                     {texels.size(), texels.size(), gap, 0.0, 0.6},
                     "everything this light's RSMs show is ", gap,
                     " or more away from everything the camera sees, more than either is large (", size,
                     "): is it the right RSM, fitted to this view, in the same unit of length?");
}

}  // namespace

void checkSpaces(Surfaces& g, LightMaps& light, Findings& findings) {
    if (!g.camera || !g.trusted) return;
    const std::vector<Texel> texels = texelsOf(light);
    if (texels.size() < kFewestTexels) return;
    const Distances distances = distancesOf(g, [&](std::uint32_t x, std::uint32_t y, glm::dvec3& p) {
        p = g.position.triple(x, y);
        return withinReach(p);
    });
    SpaceScore given = scoreOf(g, texels, {LW_FAULT_SPACES_DIFFER, "", "", {}, {}, &distances});
    const bool inFront = given.facing >= kFewestTexels && given.inFrontShare() >= kInFrontShare;
    if (given.inside >= kFewestTexels && shareOf(given.on, given.inside) >= kOnShare && !inFront) return;

    std::vector<Distances> alternatives;
    std::vector<SpaceGuess> guesses;
    addDepthGuesses(g, light, distances, alternatives, guesses);
    for (SpaceGuess& guess : spaceGuesses(g, light.name, distances)) guesses.push_back(std::move(guess));
    SpaceScore bestScore;
    const SpaceGuess* const best = bestOf(g, texels, given, guesses, bestScore);
    if (best || inFront) {
        // A G-buffer whose depth is to blame is told once, not for each light.
        if (best && best->argument == g.argument("depth")) g.trusted = false;
        for (Surfaces& map : light.maps) map.trusted = false;
        reportSpaces(g, light, given, best, bestScore, findings);
    } else if (given.on == 0) {
        reportElsewhere(g, light, texels, findings);
    }
}

}  // namespace lightwell
