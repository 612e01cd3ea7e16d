// A technique's descriptor filled from `key=value` words, through the library's own tables
// (lwDescribeTechnique): a new technique needs nothing here.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "lightwell/lightwell.hpp"

namespace cli {

using ParameterValue =
    std::variant<std::uint64_t, double, std::string, bool>;  // uint, float, enum, bool

// The library's techniques, then the host's own.
std::vector<LWTechniqueInfo> describeTechniques();
std::vector<std::string> techniqueNames();
// All techniques' parameters with default, range and meaning, for --help.
std::string describeParameters();

class Parameters {
public:
    // The technique's defaults. UsageError listing the techniques when there is none of this name.
    explicit Parameters(const std::string& technique);

    // "vpls=4096", and "second.vpls=4096" of a technique that is a parameter. UsageError naming the key, the range or
    // the choices.
    void set(const std::string& assignment);
    const std::string& technique() const { return technique_; }
    bool needsDevice() const;  // false: the host's own technique
    bool has(const std::string& name) const { return find(name) != nullptr; }
    // Here and in the techniques that are parameters, wherever there is one of this name; false where none has it.
    bool setEverywhere(const std::string& name, const std::string& value);
    bool hasAnywhere(const std::string& name) const;
    // Of a technique of the host's own.
    const void* descriptor() const { return bytes_.data(); }
    bool takesVpls() const;  // it, or a part, is static_vpl
    // static_vpl: the file of VPLs and blockers (--set vpls_file=FILE), its own or of the first part that has one; "": none.
    std::string vplsFile() const;
    // static_vpl: how many VPLs are placed at most where there is no file (--set vpls_cap=N), found as
    // the file; 0: as many as place-vpls does by default.
    std::uint32_t vplsCap() const;
    // A technique of the library: its RSMs' versions are told (--set rsm_versions=on), as by a host that draws a still light's map once.
    // Its own key or a part's, as all parts get the same frame.
    bool tellsRsmVersions() const;
    // Every parameter as it stands, in the table's order; those of a technique that is a parameter behind it.
    std::vector<std::pair<std::string, ParameterValue>> resolved() const;
    // By the parameter's name.
    const std::map<std::string, Parameters>& parts() const { return parts_; }
    // The defaults, with the same techniques as parts.
    Parameters defaults() const;

private:
    friend class Descriptor;
    const LWParameter* find(const std::string& name) const;
    void assign(const LWParameter& parameter, const std::string& text);
    ParameterValue valueOf(const LWParameter& parameter) const;

    std::string technique_;
    LWTechniqueInfo info_{};
    std::vector<std::uint64_t> bytes_;  // of the descriptor, aligned; techniques in it are null
    std::map<std::string, Parameters> parts_;
    bool setOwn(const std::string& name,
                const std::string& value);  // false: no key of the command line's own
    std::string vplsFile_;                  // keys of the command line's own
    std::uint32_t vplsCap_ = 0;
    bool tellsRsmVersions_ = false;
};

// "ssvp", or "ssvp,warm_start=off,clusters=16". UsageError as of Parameters.
Parameters parseVariant(const std::string& text);

// For lwCreateTechnique and lwEstimateMemory: with the techniques that are parameters made on this device. What is created
// with it keeps them.
class Descriptor {
public:
    Descriptor(const lightwell::Device& device, const Parameters& parameters);
    const void* get() const { return bytes_.data(); }

private:
    std::vector<std::uint64_t> bytes_;
    std::vector<lightwell::Technique> parts_;
};

}  // namespace cli
