// Readers of arguments shared by the commands; see cli.h.
#include "cli.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

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
                                     option == "--set" ? "key=value" : "NAME=FILE"));
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
    if (std::filesystem::is_directory(path))
        throw UsageError(fmt::format("{} '{}': expected a file, this is a directory", option, path));
    const std::filesystem::path parent = std::filesystem::absolute(path).parent_path();
    if (!std::filesystem::is_directory(parent))
        throw UsageError(fmt::format("{} '{}': no directory {}", option, path, parent.string()));
    if (access(parent.c_str(), W_OK) != 0)
        throw UsageError(
            fmt::format("{} '{}': directory {} is not writable", option, path, parent.string()));
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
    if (!std::isfinite(options.time)) throw UsageError("--time: expected a finite number of seconds");
    return asUsage([&] { return std::make_shared<studio::Scene>(studio::loadScene(options.scene)); });
}

studio::Camera findCamera(const studio::Scene& scene, const ViewOptions& options) {
    return asUsage(
        [&] { return scene.cameraAt(scene.findCamera(options.camera), float(options.time)); });
}

}  // namespace cli
