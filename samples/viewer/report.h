// What the viewer writes: pictures, layers, and the figures of a run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gbuffer_pass.h"
#include "indirect.h"
#include "light_maps.h"
#include "options.h"
#include "timings.h"

namespace viewer {

// What an RSM holds, summed over its texels.
struct RsmSum {
    std::string light;
    int size = 0;
    std::uint64_t litTexels = 0;
    glm::dvec3 flux{0.0};  // W
};
RsmSum sumRsm(const std::string& light, const RsmImages& rsm);

// A framebuffer as it is shown. std::runtime_error naming the path.
void writeScreen(const std::string& file, GLuint framebuffer, int width, int height);
// As `lightwell render --out FILE.exr`.
void writeLayers(const std::string& file, const GBufferImages& images, const Texture& indirect);

struct Report {
    const Options* options = nullptr;
    const studio::Scene* scene = nullptr;
    std::string camera, context;
    int width = 0, height = 0;
    const Indirect* indirect = nullptr;
    const std::vector<IndirectFigures>* indirectFrames = nullptr;
    const Timings* timings = nullptr;
    std::uint64_t readBackBytes = 0, uploadBytes = 0;
    float exposure = 1.0f;
    const std::vector<LWInputFinding>* findings = nullptr;
    std::vector<RsmSum> rsms;
};
// Times are medians over the measured frames, in milliseconds.
std::string toJson(const Report& report);
std::string toText(const Report& report);

}  // namespace viewer
