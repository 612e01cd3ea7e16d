// A technique's descriptor filled from `key=value` words, through the library's own tables
// (lwDescribeTechnique): a new technique needs nothing here.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "lightwell/lightwell.h"

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

    // "vpls=4096". UsageError naming the key, the range or the choices.
    void set(const std::string& assignment);
    const std::string& technique() const { return technique_; }
    bool needsDevice() const;  // false: the host's own technique
    bool has(const std::string& name) const { return find(name) != nullptr; }
    // For lwCreateTechnique and lwEstimateMemory.
    const void* descriptor() const { return bytes_.data(); }
    // Every parameter as it stands, in the table's order.
    std::vector<std::pair<std::string, ParameterValue>> resolved() const;

private:
    const LWParameter* find(const std::string& name) const;
    void assign(const LWParameter& parameter, const std::string& text);

    std::string technique_;
    LWTechniqueInfo info_{};
    std::vector<std::uint64_t> bytes_;  // of the descriptor, aligned
};

}  // namespace cli
