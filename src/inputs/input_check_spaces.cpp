// RSMs against the G-buffer. A surface that the light sees lies, from the camera, on what the camera
// sees or behind it; never in front, or the camera would see it. Texels far in front of the picture mean
// that the two are not of one space. So may texels that are all elsewhere; but that alone proves
// nothing, since a lamp may light another room: there the guess that lays the texels, with their
// normals, onto the picture is the proof. (Longer than other files: the guesses stand beside the score
// that they are judged by.)
#include <algorithm>
#include <cmath>
#include <functional>

#include "inputs/input_check_parts.h"

namespace lightwell {
namespace {

// Pixels and texels, and share of the distance, by which a texel may lie beside the surfaces around its
// pixel.
constexpr double kTolerancePixels = 2.0, kToleranceRelative = 0.004;
// In front only from three tolerances on.
constexpr double kInFrontTolerances = 3.0;
constexpr std::uint64_t kFewest = 64;
constexpr std::uint64_t kTexels = 20000;  // examined of a light
// Texels in front, of those in the picture. At most one in a thousand in every scene tried; leaves,
// levels of detail and moving things of other hosts may bring more.
constexpr double kInFrontShare = 0.15;
// Where fewer lie on what is seen, other spaces are tried.
constexpr double kOnShare = 0.2;
// A guess must put this share of all texels, and this one of those in the picture, onto what is seen,
// spread over this part of its width and height, with normals that agree, hardly any in front, and four
// times as many as without it (less where texels are in front without it, which cannot be).
constexpr double kGuessShare = 0.01, kGuessInside = 0.3, kSpread = 0.2, kNormalShare = 0.7,
                 kGuessInFront = 0.1, kNothingInFront = 0.005;
constexpr double kCloserThanGiven = 4.0, kCloserThanBad = 1.5;
// Of several guesses that explain the picture, the one with the largest share of its texels inside the
// picture on what is seen, by a margin for those that come later in the list: floors and walls often fit
// a wrong one as well.
constexpr double kClearlyBetter = 1.05;
// An RSM's camera off its light by this share of the distance to what it lights.
constexpr double kLightOffset = 0.02;

struct Texel {
    glm::dvec3 position, normal;
    double width;  // of the texel there
    const Surfaces* map;
    std::uint32_t x, y;
};

std::vector<Texel> texelsOf(const LightMaps& light) {
    std::uint64_t all = 0;
    for (const Surfaces& map : light.maps) all += std::uint64_t(map.width) * map.height;
    const auto stride = std::max(1u, std::uint32_t(std::sqrt(double(all) / kTexels)));
    std::vector<Texel> texels;
    for (const Surfaces& map : light.maps) {
        if (!map.trusted || !map.camera) continue;
        for (std::uint32_t y = stride / 2; y < map.height; y += stride)
            for (std::uint32_t x = stride / 2; x < map.width; x += stride) {
                if (!map.surface(x, y)) continue;
                const glm::dvec3 p = map.position.triple(x, y);
                texels.push_back(
                    {p, map.unitNormal(x, y), map.camera->footprint(map.camera->axial(p)), &map, x, y});
            }
    }
    return texels;
}

// Distances along the camera's axis; NaN without a surface.
using Distances = std::vector<double>;

template <class Place>
Distances distancesOf(const Surfaces& g, const Place& place) {
    Distances distances(std::size_t(g.width) * g.height, std::nan(""));
    for (std::uint32_t y = 0; y < g.height; ++y)
        for (std::uint32_t x = 0; x < g.width; ++x) {
            glm::dvec3 p;
            if (g.surface(x, y) && place(x, y, p))
                distances[std::size_t(y) * g.width + x] = g.camera->axial(p);
        }
    return distances;
}

struct Score {
    std::uint64_t all = 0, inside = 0, on = 0, inFront = 0, normals = 0;
    std::uint32_t lowX = ~0u, highX = 0, lowY = ~0u, highY = 0;
    std::vector<std::uint32_t> pixels;  // that texels lie in front of
    double spreadX(const Surfaces& g) const { return on ? double(highX - lowX + 1) / g.width : 0.0; }
    double spreadY(const Surfaces& g) const { return on ? double(highY - lowY + 1) / g.height : 0.0; }
    double inFrontShare() const { return shareOf(inFront, inside); }
    // Normals prove a guess, or that it brings behind the picture what cannot be in front: outer walls
    // are lit whose inner sides the camera sees.
    bool explains(const Surfaces& g, const Score& given) const {
        const bool proven = shareOf(normals, on) >= kNormalShare ||
                            (given.inFrontShare() >= kInFrontShare &&
                             inFrontShare() <= kNothingInFront && normals >= kFewest);
        const double least = given.inFrontShare() >= kInFrontShare ? kCloserThanBad : kCloserThanGiven;
        return proven && on >= kFewest && shareOf(on, all) >= kGuessShare &&
               shareOf(on, inside) >= kGuessInside && spreadX(g) >= kSpread && spreadY(g) >= kSpread &&
               inFrontShare() <= kGuessInFront && double(on) >= least * double(given.on);
    }
};

struct Guess {
    LWInputFault fault;
    std::string argument, text;
    std::function<bool(const Texel&, glm::dvec3&)> place;
    std::function<glm::dvec3(const glm::dvec3&)> turn;  // of normals
    const Distances* distances;
    double factor = 1.0;  // of lengths
};

void classify(const Surfaces& g, const Distances& distances, const Texel& texel, const glm::dvec3& p,
              const glm::dvec3& normal, double factor, Score& score) {
    glm::dvec2 pixel;
    if (!g.camera->project(p, pixel)) return;
    if (!(pixel.x >= 1.0 && pixel.y >= 1.0 && pixel.x < g.width - 1.0 && pixel.y < g.height - 1.0))
        return;
    ++score.inside;
    const auto px = std::uint32_t(pixel.x), py = std::uint32_t(pixel.y);
    const double t = g.camera->axial(p);
    double nearest = HUGE_VAL, farthest = -HUGE_VAL, closest = HUGE_VAL;
    glm::dvec3 closestNormal(0.0);
    for (std::uint32_t y = py - 1; y <= py + 1; ++y)
        for (std::uint32_t x = px - 1; x <= px + 1; ++x) {
            const double there = distances[std::size_t(y) * g.width + x];
            if (std::isnan(there)) continue;
            nearest = std::min(nearest, there);
            farthest = std::max(farthest, there);
            if (std::abs(there - t) < closest) {
                closest = std::abs(there - t);
                closestNormal = g.unitNormal(x, y);
            }
        }
    if (closest == HUGE_VAL) return;  // background: the host may have left things out
    const double tolerance =
        kTolerancePixels * (g.camera->footprint(t) + texel.width * std::abs(factor)) +
        kToleranceRelative * std::abs(t);
    if (t >= nearest - tolerance && t <= farthest + tolerance) {
        ++score.on;
        score.normals += glm::dot(normal, closestNormal) > 0.8;
        score.lowX = std::min(score.lowX, px);
        score.highX = std::max(score.highX, px);
        score.lowY = std::min(score.lowY, py);
        score.highY = std::max(score.highY, py);
    } else if (t < nearest - kInFrontTolerances * tolerance) {
        ++score.inFront;
        score.pixels.push_back(py * g.width + px);
    }
}

Score scoreOf(const Surfaces& g, const std::vector<Texel>& texels, const Guess& guess) {
    Score score;
    for (const Texel& texel : texels) {
        ++score.all;
        glm::dvec3 p = texel.position;
        if (guess.place && !guess.place(texel, p)) continue;
        classify(g, *guess.distances, texel, p, guess.turn ? guess.turn(texel.normal) : texel.normal,
                 guess.factor, score);
    }
    return score;
}

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

std::vector<Guess> spaceGuesses(const Surfaces& g, const std::string& lightName,
                                const Distances& distances) {
    std::vector<Guess> guesses;
    const std::string rsms = lightName + ".rsms";
    static constexpr double kFactors[] = {100.0, 0.01,     1000.0, 0.001,      10.0,   0.1,
                                          2.54,  1 / 2.54, 0.0254, 1 / 0.0254, 0.3048, 1 / 0.3048};
    for (const double factor : kFactors)
        guesses.push_back({LW_FAULT_UNITS_DIFFER,
                           rsms,
                           "",
                           [factor](const Texel& t, glm::dvec3& p) {
                               p = t.position * factor;
                               return true;
                           },
                           {},
                           &distances,
                           factor});
    const Camera* camera = &*g.camera;
    guesses.push_back(
        {LW_FAULT_SPACES_DIFFER, rsms,
         "the RSM's positions and camera are in the view space of " + g.name +
             ".camera: hand over the world's",
         [camera](const Texel& t, glm::dvec3& p) {
             p = camera->positionFromView(t.position);
             return true;
         },
         [camera](const glm::dvec3& n) { return glm::normalize(camera->directionFromView(n)); },
         &distances});
    for (const double sign : {1.0, -1.0})
        guesses.push_back(
            {LW_FAULT_SPACES_DIFFER,
             rsms,
             sign > 0.0
                 ? "the RSM is relative to the camera's eye and the G-buffer is not"
                 : "the G-buffer is relative to another origin than the RSM, by its own camera's eye",
             [camera, sign](const Texel& t, glm::dvec3& p) {
                 p = t.position + sign * camera->eye();
                 return true;
             },
             {},
             &distances});
    for (const AxesChange& change : axesChanges()) {
        const glm::dmat3 matrix = change.matrix;
        guesses.push_back({LW_FAULT_SPACES_DIFFER, rsms,
                           std::string("RSM and G-buffer have different axes: ") + change.what,
                           [matrix](const Texel& t, glm::dvec3& p) {
                               p = matrix * t.position;
                               return true;
                           },
                           [matrix](const glm::dvec3& n) { return matrix * n; }, &distances});
    }
    return guesses;
}

// Depth read as another kind keeps planes planes, so that normals may still fit; distances are then
// wrong.
struct DepthAlternative {
    LWDepthKind kind;
    bool reversed;
    const char* text;
};
constexpr DepthAlternative kDepths[] = {
    {LW_DEPTH_ZERO_TO_ONE, false, "depthKind LW_DEPTH_ZERO_TO_ONE fits"},
    {LW_DEPTH_GL, false, "depthKind LW_DEPTH_GL fits"},
    {LW_DEPTH_AXIAL, false, "depthKind LW_DEPTH_AXIAL fits"},
    {LW_DEPTH_RADIAL, false, "depthKind LW_DEPTH_RADIAL fits"},
    {LW_DEPTH_ZERO_TO_ONE, true,
     "1 - depth fits: it is reversed and the matrix is not, or the other way round"},
    {LW_DEPTH_GL, true, "1 - depth fits: it is reversed and the matrix is not, or the other way round"}};

std::optional<LwUnprojection> unprojectionOf(const Camera& camera, LWDepthKind kind) {
    try {
        return camera.unprojection(kind);
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

// `alternatives` keeps the distances that guesses point to.
void addDepthGuesses(const Surfaces& g, const LightMaps& light, const Distances& distances,
                     std::vector<Distances>& alternatives, std::vector<Guess>& guesses) {
    alternatives.reserve(std::size(kDepths));
    for (const DepthAlternative& depth : kDepths) {
        const LWInputFault fault = depth.reversed ? LW_FAULT_DEPTH_REVERSED : LW_FAULT_DEPTH_KIND;
        const auto skip = [&](const Surfaces& s) {
            return !s.depth || !s.camera ||
                   (depth.reversed ? depth.kind != s.depthKind : depth.kind == s.depthKind);
        };
        if (!skip(g)) {
            if (const auto u = unprojectionOf(*g.camera, depth.kind)) {
                alternatives.push_back(
                    distancesOf(g, [&](std::uint32_t x, std::uint32_t y, glm::dvec3& p) {
                        const double d = double(g.depth.at(x, y));
                        return unprojectDepth(*u, x + 0.5, y + 0.5, depth.reversed ? 1.0 - d : d, p);
                    }));
                guesses.push_back(
                    {fault, g.argument("depth"), depth.text, {}, {}, &alternatives.back()});
            }
        }
        if (!light.maps.empty() && !skip(light.maps[0]))
            guesses.push_back({fault,
                               light.name + ".rsms[0].depth",
                               depth.text,
                               [depth](const Texel& t, glm::dvec3& p) {
                                   const auto u = unprojectionOf(*t.map->camera, depth.kind);
                                   const double d = double(t.map->depth.at(t.x, t.y));
                                   return u && unprojectDepth(*u, t.x + 0.5, t.y + 0.5,
                                                              depth.reversed ? 1.0 - d : d, p);
                               },
                               {},
                               &distances});
    }
}

void checkLightCamera(const LightMaps& light, Findings& findings) {
    const LWLight& l = *light.light;
    const glm::dvec3 place(l.position[0], l.position[1], l.position[2]);
    if (l.kind == LW_LIGHT_DIRECTIONAL || place == glm::dvec3(0.0))
        return;  // zero: analytic data may be absent
    for (const Surfaces& map : light.maps) {
        if (!map.camera || !map.camera->perspective() || !map.trusted) continue;
        const glm::dvec3 eye = map.camera->eye();
        std::vector<double> distances;
        map.sample([&](std::uint32_t x, std::uint32_t y) {
            if (map.surface(x, y)) distances.push_back(glm::length(map.position.triple(x, y) - eye));
        });
        const double typical = medianOf(std::move(distances)), offset = glm::length(eye - place);
        if (!(typical > 0.0) || offset <= kLightOffset * typical) continue;
        const double ratio = glm::length(place) > 0.0 ? glm::length(eye) / glm::length(place) : 0.0;
        const bool along = glm::length(eye) > 0.0 &&
                           glm::dot(eye, place) > 0.999 * glm::length(eye) * glm::length(place);
        const char* const units = along ? lengthFactorName(1.0 / ratio) : nullptr;
        findings.add(
            LW_FAULT_LIGHT_CAMERA, LW_SEVERITY_WARNING, light.name + ".position",
            {1, 1, offset, 0.0, units ? 0.95 : 0.8}, "the camera of ", map.name, " is ", offset,
            " away from the light's position, which is ", typical, " from what it lights. ",
            units ? std::string("The RSM's camera is at ") + std::to_string(ratio) +
                        " times the light's position: other units of length (" + units + ")"
                  : std::string("The RSM must be drawn from where the light is, in the same space"));
        return;
    }
}

}  // namespace

void checkSpaces(const Surfaces& g, LightMaps& light, Findings& findings) {
    checkLightCamera(light, findings);
    if (!g.camera || !g.trusted) return;
    const std::vector<Texel> texels = texelsOf(light);
    if (texels.size() < kFewest) return;
    const Distances distances = distancesOf(g, [&](std::uint32_t x, std::uint32_t y, glm::dvec3& p) {
        p = g.position.triple(x, y);
        return true;
    });
    Score given = scoreOf(g, texels, {LW_FAULT_SPACES_DIFFER, "", "", {}, {}, &distances});
    const bool inFront = given.inside >= kFewest && given.inFrontShare() >= kInFrontShare;
    if (given.inside >= kFewest && shareOf(given.on, given.inside) >= kOnShare && !inFront) return;

    std::vector<Distances> alternatives;
    std::vector<Guess> guesses;
    addDepthGuesses(g, light, distances, alternatives, guesses);
    for (Guess& guess : spaceGuesses(g, light.name, distances)) guesses.push_back(std::move(guess));
    const Guess* best = nullptr;
    Score bestScore;
    for (const Guess& guess : guesses) {
        Score score = scoreOf(g, texels, guess);
        if (!score.explains(g, given) ||
            (best && shareOf(score.on, score.inside) <=
                         kClearlyBetter * shareOf(bestScore.on, bestScore.inside)))
            continue;
        best = &guess;
        bestScore = std::move(score);
    }
    if (best || inFront) {
        for (Surfaces& map : light.maps) map.trusted = false;
        std::string cause =
            "no usual mistake explains it. Positions of both must be the world's, of one moment and one "
            "unit";
        if (best) cause = best->text;
        if (best && best->fault == LW_FAULT_UNITS_DIFFER) {
            const char* const name = lengthFactorName(best->factor);
            std::ostringstream text;
            text << "times " << best->factor << (name ? std::string(" (") + name + ")" : "")
                 << " the RSM lies on the G-buffer's surfaces: the two are in different units of length";
            cause = text.str();
        }
        const bool units = best && best->fault == LW_FAULT_UNITS_DIFFER;
        Found& f = findings.add(
            best ? best->fault : LW_FAULT_SPACES_DIFFER, LW_SEVERITY_ERROR,
            best ? best->argument : light.name + ".rsms",
            {given.all - given.on, given.all, units ? 1.0 / best->factor : shareOf(given.on, given.all),
             1.0, best ? 0.95 : 0.7},
            percent(given.on, given.all), " of the texels lie on what the camera sees, ",
            percent(given.inFront, given.all), " in front of it, where nothing can be",
            best ? ", and " + percent(bestScore.on, bestScore.all) + " would lie on it: "
                 : std::string(": "),
            cause);
        f.pixels = std::move(given.pixels);
        return;
    }
    const Box seen = boxOf(g);
    Box lit;
    for (const Texel& texel : texels) lit.add(texel.position);
    const double gap = seen.gapTo(lit), size = std::max(seen.diagonal(), lit.diagonal());
    if (given.on == 0 && gap > size)
        findings.add(LW_FAULT_RSM_ELSEWHERE, LW_SEVERITY_WARNING, light.name + ".rsms",
                     {texels.size(), texels.size(), gap, 0.0, 0.6},
                     "everything this light's RSMs show is ", gap,
                     " or more away from everything the camera sees, more than either is large (", size,
                     "): is it the right RSM, fitted to this view, in the same unit of length?");
}

}  // namespace lightwell
