// Inputs spoilt on purpose, one mistake at a time: what `lightwell check --plant` shows and tests run.
#pragma once

#include <vector>

#include "planted_inputs.h"

namespace cli {

struct Plant {
    const char* name;
    const char* fault;  // the finding's name that must come first
    const char* summary;
    bool needsRsm, needsSun, needsLamp;  // lamp: spot or point light with RSMs
    void (*apply)(PlantedInputs& inputs);
};
const std::vector<Plant>& plants();

// A camera that stood elsewhere and looked elsewhere a moment ago, so that motion can be judged.
studio::Camera cameraBefore(const studio::Camera& camera);

}  // namespace cli
