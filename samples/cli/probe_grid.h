// A box of light probes over a scene, lit by lwRenderPoints.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "image.h"
#include "lightwell/lightwell.hpp"
#include "parameters.h"
#include "render_inputs.h"

namespace cli {

// Light that arrives at a place, in two bands of spherical harmonics (LWPointOutput::harmonics).
struct Probe {
    glm::vec3 position{0.0f};
    std::array<glm::vec3, 4> bands{};  // c0, c1.x, c1.y, c1.z of three colours
    float validity = 0.0f;
};

// Irradiance of a unit normal, W/m^2.
glm::vec3 irradianceOf(const Probe& probe, const glm::vec3& normal);

struct ProbeGrid {
    glm::vec3 low{0.0f}, high{0.0f};
    glm::ivec3 counts{0};
    std::vector<Probe> probes;  // x fastest, in the middles of the box's parts
    // Half the way to the nearest neighbour.
    float spacing() const;
};
ProbeGrid makeProbes(const studio::Scene& scene, const glm::ivec3& counts);

struct ProbeTimes {
    double pointsMilliseconds = 0.0, updateMilliseconds = 0.0;  // medians, on the host's clock
    std::vector<std::pair<std::string, std::uint64_t>> counts;  // of the last frame
    std::uint64_t deviceBytes = 0;
};

// Updates the technique and lights the probes, `frames` times; and the view's irradiance where
// `irradiance` is given. `withNormals`: irradiance at the points as well, of normals that all point up:
// for times alone.
ProbeTimes lightProbes(const lightwell::Device& device, const Parameters& parameters,
                       const RenderInputs& inputs, int frames, bool withNormals, ProbeGrid& grid,
                       studio::PlanarBuffer* irradiance);

// The picture `background` (radiance, display's exposure not yet applied) with each probe as a small
// white sphere in its light.
void drawProbes(const ProbeGrid& grid, const studio::GBuffer& gbuffer, float radius,
                studio::Image& background);

}  // namespace cli
