// `lightwell complete`: what may stand at a place of the command line. Commands and options are CLI11's; values are those of the tables
// that the commands themselves check against, so that nothing is listed twice.
#include "completion.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <functional>
#include <map>

#include "check_plant.h"
#include "cli.h"
#include "parameters.h"
#include "quantity.h"
#include "scene.h"

namespace cli {
namespace {

using Words = std::vector<std::string>;

bool startsWith(const std::string& word, const std::string& start) { return word.compare(0, start.size(), start) == 0; }

std::vector<Candidate> named(const Words& names) {
    std::vector<Candidate> result;
    for (const std::string& name : names) result.push_back({name, ""});
    return result;
}

// The first sentence or part of one: menus are narrow.
std::string summary(const std::string& text) {
    const std::size_t end = std::min(text.find("; "), text.find(". "));
    return text.substr(0, std::min<std::size_t>(end, 80));
}

std::vector<Candidate> techniques() {
    std::vector<Candidate> result;
    for (const LWTechniqueInfo& info : describeTechniques()) result.push_back({info.name, summary(info.summary)});
    return result;
}

std::vector<Candidate> scenes() {
    std::vector<Candidate> result;
    for (const studio::SceneEntry& scene : studio::listScenes()) result.push_back({scene.name, scene.path});
    return result;
}

std::vector<Candidate> plantNames() {
    std::vector<Candidate> result;
    for (const Plant& plant : plants()) result.push_back({plant.name, plant.summary});
    return result;
}

Words valuesOf(const LWParameter& parameter) {
    Words values;
    if (parameter.kind == LW_PARAMETER_BOOL) return {"on", "off"};
    for (const char* const* choice = parameter.choices; choice && *choice; ++choice) values.emplace_back(*choice);
    for (std::uint32_t i = 0; i < parameter.allowedCount; ++i) values.push_back(fmt::format("{}", parameter.allowed[i]));
    return values;
}

// Of `technique`, or of all where none of this name is known: "key=", or "key=value" once the key stands.
std::vector<Candidate> assignments(const std::string& technique, const std::string& typed) {
    std::vector<Candidate> result;
    std::vector<LWTechniqueInfo> infos = describeTechniques();
    const auto own = std::find_if(infos.begin(), infos.end(), [&](const LWTechniqueInfo& info) { return technique == info.name; });
    if (own != infos.end()) infos = {*own};
    const std::string key = typed.substr(0, typed.find('='));
    for (const LWTechniqueInfo& info : infos)
        for (std::uint32_t i = 0; i < info.parameterCount; ++i) {
            const LWParameter& parameter = info.parameters[i];
            const std::string name = parameter.name;
            const auto known = [&](const Candidate& candidate) { return startsWith(candidate.word, name + "="); };
            if (typed.find('=') == std::string::npos) {
                if (std::none_of(result.begin(), result.end(), known)) result.push_back({name + "=", summary(parameter.description)});
            } else if (key == name) {
                for (const std::string& value : valuesOf(parameter)) result.push_back({fmt::format("{}={}", name, value), ""});
            }
        }
    return result;
}

// "NAME", then "NAME,key=value,...": lists of variants.
std::vector<Candidate> variants(const std::string& typed) {
    const std::size_t comma = typed.rfind(',');
    if (comma == std::string::npos) return techniques();
    std::vector<Candidate> result;
    for (const Candidate& each : assignments(typed.substr(0, typed.find(',')), typed.substr(comma + 1)))
        result.push_back({typed.substr(0, comma + 1) + each.word, each.description});
    return result;
}

// What stands behind --technique.
std::string technique(const Words& words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--technique" && i + 1 < words.size()) return words[i + 1];
        if (startsWith(words[i], "--technique=")) return words[i].substr(words[i].find('=') + 1);
    }
    return "";
}

struct Place {
    std::string command;
    const Words& before;       // the words ahead of the one being typed
    const std::string& typed;  // so far
};

std::vector<Candidate> quantities(const Place& place) {
    if (place.command == "reference") return named({"irradiance", "ambient-occlusion", "specular-radiance"});
    return named(quantityNames());
}

std::vector<Candidate> techniquesAndNone() {
    std::vector<Candidate> result = techniques();
    result.push_back({"none", "direct light only"});
    return result;
}

// By an option's name, or a positional's; others take what no list has: numbers, or a path.
const std::map<std::string, std::function<std::vector<Candidate>(const Place&)>>& valueTables() {
    static const std::map<std::string, std::function<std::vector<Candidate>(const Place&)>> tables = {
        {"SCENE", [](const Place&) { return scenes(); }},
        {"--scenes", [](const Place&) { return scenes(); }},
        {"--technique", [](const Place& place) { return place.command == "render" ? techniquesAndNone() : techniques(); }},
        {"--techniques", [](const Place& place) { return variants(place.typed); }},
        {"--set", [](const Place& place) { return assignments(technique(place.before), place.typed); }},
        {"--only", [](const Place& place) { return assignments("", place.typed); }},
        {"--sweep", [](const Place& place) { return assignments(technique(place.before), place.typed); }},
        {"--plant", [](const Place&) { return plantNames(); }},
        {"--quantity", quantities},
        {"--weighting", [](const Place&) { return named({"cosine", "uniform"}); }},
        {"--bounces", [](const Place&) { return named({"1", "2", "all"}); }},
        {"--cameras", [](const Place&) { return named({"all", "first"}); }},
        {"--device", [](const Place&) { return named({"cpu", "gpu"}); }},
        {"--width", [](const Place&) { return named({"1", "4", "8", "16"}); }},
        {"--focus", [](const Place&) { return named({"eye", "none"}); }},
        {"SHELL", [](const Place&) { return named({"bash", "fish", "zsh"}); }},
    };
    return tables;
}

// Options whose values are paths.
bool takesFile(const std::string& command, const std::string& name) {
    // `gi` works from files where others have scenes.
    static const Words given = {"--gbuffer", "--camera", "--rsm", "--light", "--truth"};
    if (command == "gi" && std::find(given.begin(), given.end(), name) != given.end()) return true;
    static const Words paths = {"SCENE", "--scenes", "IMAGE", "RENDER", "REFERENCE", "--out", "--overlay", "--png", "--maps", "--vpls", "--vpls-out",
                                "--checkpoint", "--compare", "--truth-cache"};
    return std::find(paths.begin(), paths.end(), name) != paths.end();
}

const CLI::Option* optionNamed(const CLI::App& command, const std::string& word) {
    const std::string name = word.substr(0, word.find('='));
    for (const CLI::Option* option : command.get_options())
        if (!option->get_positional() && option->check_name(name)) return option;
    return nullptr;
}

bool isFlag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }
bool takesMany(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

// Whose value the word behind `before` is: an option that is waiting for one, else the next positional; null: nobody's.
const CLI::Option* owner(const CLI::App& command, const Words& before) {
    const CLI::Option* waiting = nullptr;
    std::size_t positionals = 0;
    for (const std::string& word : before) {
        if (startsWith(word, "-") && word.size() > 1) {
            const CLI::Option* option = optionNamed(command, word);
            waiting = option && !isFlag(*option) && word.find('=') == std::string::npos ? option : nullptr;
        } else if (waiting) {
            if (!takesMany(*waiting)) waiting = nullptr;
        } else {
            ++positionals;
        }
    }
    if (waiting) return waiting;
    for (const CLI::Option* option : command.get_options())
        if (option->get_positional() && positionals-- == 0) return option;
    return nullptr;
}

Completions valuesFor(const CLI::Option* option, const Place& place) {
    Completions result;
    if (!option) return result;
    const std::string name = option->get_positional() ? option->get_name(true) : "--" + option->get_lnames().at(0);
    const auto table = valueTables().find(name);
    if (table != valueTables().end()) result.words = table->second(place);
    result.files = takesFile(place.command, name);
    return result;
}

std::vector<Candidate> optionsOf(const CLI::App& command) {
    std::vector<Candidate> result;
    for (const CLI::Option* option : command.get_options())
        if (!option->get_positional() && !option->get_lnames().empty())
            result.push_back({"--" + option->get_lnames()[0], summary(option->get_description())});
    return result;
}

Completions anyOf(const CLI::App& app, const Words& words) {
    const std::string& typed = words.back();
    if (words.size() == 1) {
        if (startsWith(typed, "-")) return {optionsOf(app)};
        Completions result;
        for (const CLI::App* command : app.get_subcommands(nullptr)) result.words.push_back({command->get_name(), summary(command->get_description())});
        return result;
    }
    const auto commands = app.get_subcommands([&](const CLI::App* each) { return each->get_name() == words[0]; });
    if (commands.empty()) return {};
    const CLI::App* command = commands[0];
    const Words before(words.begin() + 1, words.end() - 1);
    if (!startsWith(typed, "-")) return valuesFor(owner(*command, before), {words[0], before, typed});
    const std::size_t equals = typed.find('=');
    if (equals == std::string::npos) return {optionsOf(*command)};
    const std::string value = typed.substr(equals + 1);
    Completions result = valuesFor(optionNamed(*command, typed), {words[0], before, value});
    for (Candidate& candidate : result.words) candidate.word = typed.substr(0, equals + 1) + candidate.word;
    return result;
}

}  // namespace

Completions complete(const CLI::App& app, const Words& words) {
    Completions result = anyOf(app, words.empty() ? Words{""} : words);
    const std::string typed = words.empty() ? "" : words.back();
    const auto other = [&](const Candidate& candidate) { return !startsWith(candidate.word, typed); };
    result.words.erase(std::remove_if(result.words.begin(), result.words.end(), other), result.words.end());
    return result;
}

void printCompletions(const CLI::App& app, const Words& words) {
    const Completions completions = complete(app, words);
    for (const Candidate& candidate : completions.words) {
        std::string description = candidate.description;
        std::replace(description.begin(), description.end(), '\n', ' ');
        fmt::print("{}{}{}\n", candidate.word, description.empty() ? "" : "\t", description);
    }
    if (completions.files) fmt::print(":files\n");
}

}  // namespace cli
