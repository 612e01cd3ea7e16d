#include "host_techniques.h"

#include "instant_radiosity_renderer.h"
#include "rival_renderer.h"

namespace cli {

const std::vector<HostTechnique>& hostTechniques() {
    static const std::vector<HostTechnique> techniques = {
        {&rivalInfo(), makeRival}, {&instantRadiosityInfo(), makeInstantRadiosity}};
    return techniques;
}

const HostTechnique* findHostTechnique(const std::string& name) {
    for (const HostTechnique& technique : hostTechniques())
        if (name == technique.info->name) return &technique;
    return nullptr;
}

}  // namespace cli
