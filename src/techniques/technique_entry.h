// How a technique enters the registry: its description, from its descriptor's type and its own functions.
#pragma once

#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "techniques/technique.h"

namespace lightwell {

// T(Device&, const Desc&): the technique; setDefaults: of the C API. `parameters` and `settings` must live as long as the entry.
template <class T, class Desc, void (*setDefaults)(Desc*)>
TechniqueEntry techniqueEntry(const char* name, const char* summary, std::uint32_t bounces,
                              const std::vector<LWParameter>& parameters, const std::vector<LWSetting>& settings,
                              std::uint64_t (*estimateBytes)(const void*, const LWViewDesc&, const FrameShape&)) {
    TechniqueEntry entry{};
    entry.info.structSize = sizeof(LWTechniqueInfo);
    entry.info.descSize = sizeof(Desc);
    entry.info.name = name;
    entry.info.summary = summary;
    entry.info.parameters = parameters.data();
    entry.info.parameterCount = std::uint32_t(parameters.size());
    entry.info.setDefaults = [](void* desc) { setDefaults(static_cast<Desc*>(desc)); };
    entry.info.bounces = bounces;
    entry.info.settings = settings.data();
    entry.info.settingCount = std::uint32_t(settings.size());
    // What inherits renderPoints has none.
    entry.info.points = std::is_same_v<decltype(&T::renderPoints), decltype(&Technique::renderPoints)> ? 0 : 1;
    entry.info.lightList = std::is_same_v<decltype(&T::readLightList), decltype(&Technique::readLightList)> ? 0 : 1;
    entry.create = [](Device& device, const void* desc) -> std::unique_ptr<Technique> {
        return std::make_unique<T>(device, *static_cast<const Desc*>(desc));
    };
    entry.estimateBytes = estimateBytes;
    return entry;
}

}  // namespace lightwell
