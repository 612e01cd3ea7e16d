// See host_channels.h.
//
// A channel's name is a base and a component: "ViewLayer.Position.X" is component X of the base "ViewLayer.Position", whose last word,
// whatever its case, is looked up. Blender names bases by view layer and pass, Mitsuba's `aov` integrator by whatever the user called them.
#include "host_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "cli.h"

namespace cli {
namespace {

struct RoleEntry {
    Role role;
    const char* name;
    std::size_t channels;
    std::vector<std::string> words;  // last words of bases, in lower case
};

const std::vector<RoleEntry>& roleEntries() {
    static const std::vector<RoleEntry> entries = {
        {Role::Position, "position", 3, {"position", "pos", "p", "worldposition", "world_position"}},
        {Role::Depth, "depth", 1, {"depth", "z"}},
        {Role::Normal, "normal", 3, {"normal", "sh_normal", "n", "nn", "worldnormal", "world_normal"}},
        {Role::Albedo, "albedo", 3, {"diffcol", "albedo", "diffuse_albedo"}},
        {Role::Direct, "direct", 3, {"direct", "direct_diffuse"}},
        {Role::DirectUncoloured, "direct-uncoloured", 3, {"diffdir"}},
        {Role::Irradiance, "irradiance", 3, {"irradiance", ""}},  // "": channels R, G, B of no layer
        {Role::IndirectUncoloured, "indirect-uncoloured", 3, {"diffind"}},
    };
    return entries;
}

const RoleEntry& entryOf(Role role) {
    return *std::find_if(roleEntries().begin(), roleEntries().end(), [&](const RoleEntry& entry) { return entry.role == role; });
}

std::string lowered(std::string text) {
    for (char& letter : text) letter = char(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

std::string baseOf(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    return dot == std::string::npos ? "" : name.substr(0, dot);
}

std::string lastWord(const std::string& base) {
    const std::size_t dot = base.rfind('.');
    return lowered(dot == std::string::npos ? base : base.substr(dot + 1));
}

bool isKnown(const RoleEntry& entry, const std::string& word) {
    return std::find(entry.words.begin(), entry.words.end(), word) != entry.words.end();
}

// Components of a base, in order: X, Y, Z or R, G, B in either case; empty where the file has not all three.
std::vector<std::string> threeOf(const studio::ExrLayers& file, const std::string& base) {
    for (const std::array<const char*, 3>& letters :
         {std::array<const char*, 3>{"X", "Y", "Z"}, {"R", "G", "B"}, {"x", "y", "z"}, {"r", "g", "b"}}) {
        std::vector<std::string> names;
        for (const char* letter : letters) names.push_back(base.empty() ? letter : base + "." + letter);
        if (std::all_of(names.begin(), names.end(), [&](const std::string& name) { return file.has(name); })) return names;
    }
    return {};
}

// "ViewLayer.Depth.Z" and "depth.T" have a component of their own; "Z" and "depth" have none.
std::vector<std::vector<std::string>> candidates(const studio::ExrLayers& file, const RoleEntry& entry) {
    std::vector<std::vector<std::string>> found;
    for (const std::string& name : file.names()) {
        const std::string base = baseOf(name);
        if (entry.channels == 1) {
            if ((!base.empty() && isKnown(entry, lastWord(base))) || (base.empty() && isKnown(entry, lowered(name)))) found.push_back({name});
        } else if (isKnown(entry, lastWord(base))) {
            const std::vector<std::string> three = threeOf(file, base);
            if (!three.empty() && three[0] == name) found.push_back(three);
        }
    }
    return found;
}

}  // namespace

const char* roleName(Role role) {
    return entryOf(role).name;
}

std::string describeRoles() {
    std::string text = "Channels, by the last word of a layer's name in any case, or by --channels ROLE=CHANNEL,CHANNEL,CHANNEL:\n";
    for (const RoleEntry& entry : roleEntries()) {
        std::vector<std::string> words;
        for (const std::string& word : entry.words) words.push_back(word.empty() ? "R, G, B of no layer" : word);
        text += fmt::format("  {:<20} {}\n", entry.name, joinNames(words));
    }
    return text;
}

ChannelMap::ChannelMap(const std::string& option, const std::vector<std::string>& assignments) : option_(option) {
    std::vector<std::string> names;
    for (const RoleEntry& entry : roleEntries()) names.emplace_back(entry.name);
    for (const std::string& assignment : assignments) {
        const auto [name, list] = splitAssignment(option, assignment);
        requireOneOf(option + " role", name, names);
        const RoleEntry& entry = roleEntries()[std::size_t(std::find(names.begin(), names.end(), name) - names.begin())];
        std::vector<std::string> channels;
        for (std::size_t from = 0; from <= list.size();) {
            const std::size_t to = std::min(list.find(',', from), list.size());
            channels.push_back(list.substr(from, to - from));
            from = to + 1;
        }
        if (channels.size() != entry.channels)
            throw UsageError(fmt::format("{} '{}': expected {} channel{} with commas between, got {}", option, assignment, entry.channels,
                                         entry.channels == 1 ? "" : "s", channels.size()));
        if (!given_.emplace(entry.role, channels).second) throw UsageError(fmt::format("{} '{}': {} comes twice", option, assignment, name));
    }
}

std::optional<std::vector<std::string>> ChannelMap::find(const studio::ExrLayers& file, Role role) const {
    if (const auto given = given_.find(role); given != given_.end()) {
        for (const std::string& name : given->second)
            if (!file.has(name))
                throw UsageError(fmt::format("{} {}: {} has no channel '{}'; it has: {}", option_, roleName(role), file.path(), name,
                                             joinNames(file.names())));
        return given->second;
    }
    const auto found = candidates(file, entryOf(role));
    if (found.empty()) return std::nullopt;
    if (found.size() > 1) {
        std::vector<std::string> choices;
        for (const auto& each : found) choices.push_back(fmt::format("{}={}", roleName(role), fmt::join(each, ",")));
        throw UsageError(fmt::format("{}: several layers could be the {}; pick one by {}: {}", file.path(), roleName(role),
                                     option_.empty() ? "--channels" : option_, joinNames(choices)));
    }
    return found[0];
}

std::vector<std::string> ChannelMap::need(const studio::ExrLayers& file, Role role) const {
    if (auto found = find(file, role)) return *found;
    throw UsageError(fmt::format("{}: expected a layer with the {} (or {} {}=...), got the channels {}", file.path(), roleName(role),
                                 option_.empty() ? "--channels" : option_, roleName(role), joinNames(file.names())));
}

}  // namespace cli
