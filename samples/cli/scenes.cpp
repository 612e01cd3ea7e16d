// `lightwell scenes`: the names that SCENE may be.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli.h"
#include "scene.h"

namespace cli {
namespace {

void printScenes(bool asJson) {
    const std::vector<studio::SceneEntry> scenes = asUsage([] { return studio::listScenes(); });
    if (asJson) {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const auto& scene : scenes)
            list.push_back({{"name", scene.name}, {"path", scene.path}, {"shipped", scene.shipped}});
        fmt::print("{}\n", list.dump(2));
        return;
    }
    for (const auto& scene : scenes)
        fmt::print("{:<24} {:<8} {}\n", scene.name, scene.shipped ? "shipped" : "found", scene.path);
    if (scenes.empty())
        fmt::print(stderr, "no scenes: none shipped with this build, none in LIGHTWELL_SCENES\n");
}

}  // namespace

void addScenes(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("scenes", "List the scenes shipped and those found in LIGHTWELL_SCENES");
    auto asJson = std::make_shared<bool>(false);
    command->add_flag("--json", *asJson, "A JSON array of {name, path, shipped} on stdout");
    command->callback([asJson] { printScenes(*asJson); });
}

}  // namespace cli
