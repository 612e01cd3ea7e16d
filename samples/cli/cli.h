// What all commands of the program `lightwell` share: how arguments are read and refused.
//
// A wrong argument (path, key, size, name) is a UsageError: one line on stderr naming it and the valid
// choices, exit code 2. Any other exception (device, disk) is one line and exit code 1. Everything
// that is not a result goes to stderr; with --json stdout holds one JSON document and nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI
namespace studio {
struct Camera;
struct Image;
struct Scene;
}  // namespace studio

namespace cli {

struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Runs `load`; whatever it refuses is the argument's fault.
template <class F>
auto asUsage(F&& load) {
    try {
        return load();
    } catch (const UsageError&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw UsageError(error.what());
    }
}

struct Size {
    int width = 0, height = 0;
};
constexpr int kMaxSize = 16384;  // pixels along a side, as lightwell.h's views

// "1280x720". The other readers name `option` in their error; whole text, no trailing letters.
Size parseSize(std::string_view text);
double parseNumber(std::string_view option, std::string_view text);
float parsePositive(std::string_view option, std::string_view text);  // that a float can hold
float parseRoughness(std::string_view text);                          // 0 .. 1
std::uint64_t parseUnsigned(std::string_view option, std::string_view text);

// "key=value" in two; a value may hold further "=".
std::pair<std::string, std::string> splitAssignment(std::string_view option, const std::string& text);

std::string joinNames(const std::vector<std::string>& names);
// `name` must be one of `valid`: "unknown camera 'x'; valid: a, b".
void requireOneOf(std::string_view what, const std::string& name, const std::vector<std::string>& valid);

// Ends with one of `extensions` (".exr") and can be opened for writing: found out before an hour of
// rendering, not after it.
void requireOutputPath(std::string_view option, const std::string& path,
                       const std::vector<std::string>& extensions);
// Output files of one command must differ: pairs of option and path, "" where none is written.
void requireDistinct(const std::vector<std::pair<std::string, std::string>>& outputs);
// Refuses what would need more bytes than this machine has, instead of dying half-way.
void requireMemory(std::string_view option, std::string_view text, double bytes);
bool hasExtension(const std::string& path, std::string_view extension);

// Which view of which scene a command looks at; declared alike by every command that renders.
struct ViewOptions {
    std::string scene, camera, size = "1280x720";
    double time = 0.0;                        // s, of keyframed scenes
    CLI::Option* declare(CLI::App& command);  // returns SCENE, which is required
};
std::shared_ptr<studio::Scene> loadScene(const ViewOptions& options);
studio::Camera findCamera(const studio::Scene& scene, const ViewOptions& options);

// Each declares one command: its options, and what runs when it is named.
void addDevices(CLI::App& app);
void addScenes(CLI::App& app);
void addRender(CLI::App& app);
void addReference(CLI::App& app);
void addCompare(CLI::App& app);
void addTriptych(CLI::App& app);
void addChart(CLI::App& app);
void addSplit(CLI::App& app);
void addVisibility(CLI::App& app);
void addProbes(CLI::App& app);
void addStability(CLI::App& app);
void addCheck(CLI::App& app);
void addPlan(CLI::App& app);
void addGi(CLI::App& app);

}  // namespace cli
