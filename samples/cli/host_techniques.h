// Techniques that are not of the library but of the host: path tracing (studio/rival.h) and instant radiosity
// (studio/instant_radiosity.h), to compare with. Their parameters in the library's form, their frames behind
// the common interface.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "indirect_renderer.h"

namespace cli {

struct HostTechnique {
    const LWTechniqueInfo* info;
    std::unique_ptr<IndirectRenderer> (*make)(const Parameters& parameters, const RenderInputs& inputs);
};
const std::vector<HostTechnique>& hostTechniques();
// Null: the technique is the library's.
const HostTechnique* findHostTechnique(const std::string& name);

}  // namespace cli
