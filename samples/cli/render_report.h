// What `lightwell render` says about a run: JSON for scripts, text for people.
#pragma once

#include <string>

#include "cli.h"
#include "indirect_renderer.h"

namespace cli {

struct RenderReport {
    std::string scene, camera, technique;
    Size size;
    int frames = 0;
    std::vector<std::pair<std::string, ParameterValue>> parameters;
    bool hasDevice = false;  // false for "none" and for techniques of the host
    LWDeviceInfo device{};
    FrameFigures figures;
    std::uint64_t hash = 0;  // of the irradiance's bits
    double exposure = 0.0;   // of the PNG; 0: none was written
    std::vector<std::string> outputs;
};

std::string toJson(const RenderReport& report);
std::string toText(const RenderReport& report);
std::string hashText(std::uint64_t hash);

}  // namespace cli
