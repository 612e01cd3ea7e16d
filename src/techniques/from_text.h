// A technique's parameters as text: "vpls=256 interleave=4", and of a technique that joins others
// "first=horizon second=ssvp second.vpls=256", as LWSetting, LWPlan and the command line's --set have them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "techniques/technique.h"

namespace lightwell {

// A technique that is yet to be made.
struct TechniqueText {
    const TechniqueEntry* entry = nullptr;
    std::vector<std::uint64_t> descriptor;  // whole words, aligned for any field; techniques in it are null
    std::vector<TechniqueText> parts;       // in the order of the parameters that are techniques
};

// What `settings` does not name has its default, of a part the one that a tool begins with. A part is named before its
// parameters. Throws INVALID_ARGUMENT with the name, the key or the value, what is valid and what came.
TechniqueText parseTechnique(const std::string& name, const std::string& settings);

// Makes it, and its parts.
std::unique_ptr<Technique> makeTechnique(Device& device, const TechniqueText& text);
std::unique_ptr<Technique> makeTechnique(Device& device, const std::string& name, const std::string& settings);

}  // namespace lightwell
