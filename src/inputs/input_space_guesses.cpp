#include <cmath>

#include "inputs/input_space_score.h"

namespace lightwell {
namespace {

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

}  // namespace

std::vector<SpaceGuess> spaceGuesses(const Surfaces& g, const std::string& lightName,
                                     const Distances& distances) {
    std::vector<SpaceGuess> guesses;
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

void addDepthGuesses(const Surfaces& g, const LightMaps& light, const Distances& distances,
                     std::vector<Distances>& alternatives, std::vector<SpaceGuess>& guesses) {
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

}  // namespace lightwell
