// Readers of arguments shared by the commands; see cli.h.
#include "cli.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "scene.h"

namespace cli {
namespace {

template <class T>
bool parseWhole(std::string_view text, T& value) {
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

}  // namespace

Size parseSize(std::string_view text) {
    Size size;
    const std::size_t cross = text.find('x');
    const bool isValid = cross != std::string_view::npos &&
                         parseWhole(text.substr(0, cross), size.width) &&
                         parseWhole(text.substr(cross + 1), size.height) && size.width >= 1 &&
                         size.height >= 1 && size.width <= kMaxSize && size.height <= kMaxSize;
    if (!isValid)
        throw UsageError(
            fmt::format("--size '{}': expected WIDTHxHEIGHT in pixels, each 1 to {}, e.g. 1280x720",
                        text, kMaxSize));
    return size;
}

double parseNumber(std::string_view option, std::string_view text) {
    double value = 0.0;
    if (!parseWhole(text, value) || !std::isfinite(value))
        throw UsageError(fmt::format("{} '{}': expected a number", option, text));
    return value;
}

float parsePositive(std::string_view option, std::string_view text) {
    double value = 0.0;
    const bool isNumber = parseWhole(text, value);
    const float narrow = float(value);
    if (!isNumber || !std::isfinite(narrow) || !(narrow > 0.0f))
        throw UsageError(fmt::format("{} '{}': expected a number above 0", option, text));
    return narrow;
}

float parseRoughness(std::string_view text) {
    const double value = parseNumber("--roughness", text);
    if (!(value >= 0.0 && value <= 1.0))
        throw UsageError(fmt::format("--roughness '{}': expected 0 to 1", text));
    return float(value);
}

std::uint64_t parseUnsigned(std::string_view option, std::string_view text) {
    std::uint64_t value = 0;
    if (!parseWhole(text, value))
        throw UsageError(fmt::format("{} '{}': expected a whole number, 0 or more", option, text));
    return value;
}

std::pair<std::string, std::string> splitAssignment(std::string_view option, const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw UsageError(fmt::format("{} '{}': expected {}", option, text,
                                     option == "--debug-view" ? "NAME=FILE" : "key=value"));
    return {text.substr(0, equals), text.substr(equals + 1)};
}

std::string joinNames(const std::vector<std::string>& names) {
    return fmt::format("{}", fmt::join(names, ", "));
}

void requireOneOf(std::string_view what, const std::string& name,
                  const std::vector<std::string>& valid) {
    if (std::find(valid.begin(), valid.end(), name) == valid.end())
        throw UsageError(fmt::format("unknown {} '{}'; valid: {}", what, name, joinNames(valid)));
}

bool hasExtension(const std::string& path, std::string_view extension) {
    return std::filesystem::path(path).extension() == extension;
}

void requireOutputPath(std::string_view option, const std::string& path,
                       const std::vector<std::string>& extensions) {
    const auto matches = [&](const std::string& extension) { return hasExtension(path, extension); };
    if (!extensions.empty() && std::none_of(extensions.begin(), extensions.end(), matches))
        throw UsageError(fmt::format("{} '{}': expected a file name ending in {}", option, path,
                                     joinNames(extensions)));
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw UsageError(fmt::format("{} '{}': expected a file, this is a directory", option, path));
    const std::filesystem::path parent = std::filesystem::absolute(path).parent_path();
    if (!std::filesystem::is_directory(parent, ignored))
        throw UsageError(fmt::format("{} '{}': no directory {}", option, path, parent.string()));
    // Rights, read-only file systems, names too long: only opening it tells. What it holds stays.
    const bool isNew = access(path.c_str(), F_OK) != 0;
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
    if (file < 0)
        throw UsageError(
            fmt::format("{} '{}': cannot be written: {}", option, path, std::strerror(errno)));
    close(file);
    if (isNew) unlink(path.c_str());
}

void requireDistinct(const std::vector<std::pair<std::string, std::string>>& outputs) {
    std::map<std::filesystem::path, std::string> writers;
    for (const auto& [option, path] : outputs) {
        if (path.empty()) continue;
        const auto [writer, isFirst] = writers.emplace(std::filesystem::weakly_canonical(path), option);
        if (!isFirst)
            throw UsageError(
                fmt::format("{} '{}': expected another file than {}'s", option, path, writer->second));
    }
}

namespace {

// Of the machine, or of the control group that this process is in.
double memoryBytes() {
    const double machine = double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGE_SIZE));
    std::ifstream file("/sys/fs/cgroup/memory.max");
    double limit = 0.0;
    return file >> limit && limit > 0.0 ? std::min(machine, limit) : machine;  // "max": no limit
}

}  // namespace

void requireMemory(std::string_view option, std::string_view text, double bytes) {
    const double present = memoryBytes();
    if (bytes > present)
        throw UsageError(fmt::format(
            "{} '{}': expected what fits in this machine's {:.1f} GB of memory, got about {:.1f} GB",
            option, text, present * 1e-9, bytes * 1e-9));
}

CLI::Option* ViewOptions::declare(CLI::App& command) {
    command.add_option("--camera", camera, "Camera by name; default: the scene's first");
    command.add_option("--size", size, "Picture size in pixels, WIDTHxHEIGHT")->capture_default_str();
    command.add_option("--time", time, "Time in seconds at which keyframes are taken")
        ->capture_default_str();
    return command
        .add_option(
            "SCENE", scene,
            "Scene name (`lightwell scenes` lists them) or path to a scene JSON, glTF, GLB or OBJ")
        ->required();
}

std::shared_ptr<studio::Scene> loadScene(const ViewOptions& options) {
    if (!std::isfinite(float(options.time)))
        throw UsageError(
            fmt::format("--time '{}': expected seconds that a float can hold", options.time));
    return asUsage([&] { return std::make_shared<studio::Scene>(studio::loadScene(options.scene)); });
}

studio::Camera findCamera(const studio::Scene& scene, const ViewOptions& options) {
    return asUsage(
        [&] { return scene.cameraAt(scene.findCamera(options.camera), float(options.time)); });
}

}  // namespace cli
