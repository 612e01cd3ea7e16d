// Which channels of another program's EXR hold what: by the names that Blender and Mitsuba 3 write, or by what the user says.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "exr_layers.h"

namespace cli {

enum class Role {
    Position,          // world, 3 channels
    Depth,             // as the camera file says, 1
    Normal,            // world, 3
    Albedo,            // diffuse reflectance, 3
    Direct,            // L_d, radiance of the diffuse reflection of direct light, 3
    DirectUncoloured,  // L_d over albedo, as Blender's DiffDir, 3
    Irradiance,        // of a truth, W/m^2, 3
    IndirectUncoloured // of a truth: irradiance over pi, as Blender's DiffInd, 3
};

const char* roleName(Role role);  // "position", as --channels has it
std::string describeRoles();      // for --help: each role with the names that are known for it

// What the user said: "normal=N.X,N.Y,N.Z". UsageError naming `option` where a role is unknown, comes twice or has another number of channels.
class ChannelMap {
public:
    ChannelMap() = default;
    ChannelMap(const std::string& option, const std::vector<std::string>& assignments);

    // The channels of `role` in `file`, 1 or 3; none where the file has none. UsageError where the map names one that the file lacks, or
    // where several layers of the file would do: lists them.
    std::optional<std::vector<std::string>> find(const studio::ExrLayers& file, Role role) const;
    bool names(Role role) const { return given_.count(role) != 0; }  // by the user
    // Of two roles that serve the same end: `second` where the user has named that one alone, else `first`.
    Role preferred(Role first, Role second) const { return names(second) && !names(first) ? second : first; }
    // UsageError that lists the file's channels where there is none.
    std::vector<std::string> need(const studio::ExrLayers& file, Role role) const;

private:
    std::string option_;
    std::map<Role, std::vector<std::string>> given_;
};

}  // namespace cli
