#include "inputs/input_normal_guesses.h"

#include <cmath>

namespace lightwell {
namespace {

glm::dvec3 unit(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 ? v / length : v;
}

}  // namespace

std::vector<NormalGuess> normalGuesses(const Surfaces& s, const std::vector<NamedCamera>& others) {
    std::vector<NormalGuess> guesses;
    const Camera* own = &*s.camera;
    guesses.push_back({LW_FAULT_NORMAL_FLIPPED,
                       std::string("they face away from the ") + (s.isRsm ? "light" : "camera") +
                           ": turn their sign, or the winding that they come from" +
                           (s.lightDirection != glm::dvec3(0.0)
                                ? ". Or the light's direction is turned: it is the way the light travels"
                                : ""),
                       {},
                       [](const glm::dvec3& n) { return -n; }});
    guesses.push_back(
        {LW_FAULT_NORMAL_SPACE,
         "they are in view space of the buffer's own camera: multiply by the transposed view rotation",
         {},
         [own](const glm::dvec3& n) { return unit(own->directionFromView(n)); }});
    guesses.push_back(
        {LW_FAULT_NORMAL_SPACE,
         "they are in view space with z turned (a left-handed view): bring them to the world",
         {},
         [own](const glm::dvec3& n) {
             return unit(own->directionFromView({n.x, n.y, -n.z}));
         }});
    guesses.push_back({LW_FAULT_NORMAL_ENCODED,
                       "they are still stored as n/2 + 1/2 and were then normalised: decode first",
                       {},
                       [](const glm::dvec3& n) {
                           // |2 s n - 1| = 1 for the length s that was lost; the larger root, which lies
                           // on the side of all normals but those near (-1, -1, -1).
                           const double sum = n.x + n.y + n.z, root = sum * sum - 2.0;
                           return root < 0.0 ? n : unit((sum + std::sqrt(root)) * n - 1.0);
                       }});
    guesses.push_back({LW_FAULT_IMAGE_FLIPPED,
                       "their rows were read the other way round: bottom-up beside positions that are "
                       "top-down, or the reverse",
                       {},
                       {},
                       false,
                       true});
    guesses.push_back({LW_FAULT_IMAGE_FLIPPED, "their columns were mirrored", {}, {}, true, false});
    for (const NamedCamera& other : others) {
        const Camera* camera = other.camera;
        guesses.push_back(
            {LW_FAULT_NORMAL_SPACE,
             "they are in the view space of " + other.name + ": bring them to the world",
             {},
             [camera](const glm::dvec3& n) { return unit(camera->directionFromView(n)); }});
    }
    for (const AxesChange& change : axesChanges()) {
        const glm::dmat3 matrix = change.matrix;
        guesses.push_back({LW_FAULT_NORMAL_SPACE,
                           std::string("normals and positions have different axes: ") + change.what,
                           {},
                           [matrix](const glm::dvec3& n) { return matrix * n; }});
    }
    return guesses;
}

std::vector<NormalGuess> depthGuesses(const Surfaces& s) {
    static constexpr struct {
        LWDepthKind kind;
        const char* name;
    } kKinds[] = {{LW_DEPTH_ZERO_TO_ONE, "LW_DEPTH_ZERO_TO_ONE"},
                  {LW_DEPTH_GL, "LW_DEPTH_GL"},
                  {LW_DEPTH_AXIAL, "LW_DEPTH_AXIAL"},
                  {LW_DEPTH_RADIAL, "LW_DEPTH_RADIAL"}};
    std::vector<NormalGuess> guesses;
    const auto placeBy = [&s](const LwUnprojection& u, bool reversed) -> Place {
        return [&s, u, reversed](std::uint32_t x, std::uint32_t y, glm::dvec3& p) {
            const double depth = double(s.depth.at(x, y));
            return unprojectDepth(u, x + 0.5, y + 0.5, reversed ? 1.0 - depth : depth, p);
        };
    };
    for (const auto& kind : kKinds) {
        LwUnprojection u{};
        try {
            u = s.camera->unprojection(kind.kind);
        } catch (const std::exception&) {
            continue;  // a distance with an orthographic camera that has no front
        }
        if (kind.kind == s.depthKind) {
            if (kind.kind == LW_DEPTH_ZERO_TO_ONE || kind.kind == LW_DEPTH_GL)
                guesses.push_back({LW_FAULT_DEPTH_REVERSED,
                                   "1 - depth fits: the depth is reversed and the projection matrix is "
                                   "not, or the other way "
                                   "round. Give the matrix that the depth was drawn with",
                                   placeBy(u, true),
                                   {}});
        } else {
            guesses.push_back({LW_FAULT_DEPTH_KIND,
                               std::string("depthKind ") + kind.name + " fits",
                               placeBy(u, false),
                               {}});
        }
    }
    return guesses;
}

}  // namespace lightwell
