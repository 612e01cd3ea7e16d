#include "stability_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "chart_view.h"
#include "cli.h"
#include "scene.h"

namespace cli {
namespace {

std::vector<std::string> namesOf(const std::vector<studio::SequenceEntry>& entries, bool quickOnly) {
    std::vector<std::string> names;
    for (const studio::SequenceEntry& entry : entries)
        if (entry.quick || !quickOnly) names.push_back(entry.name);
    return names;
}

bool isAmong(const std::string& name, const std::vector<std::string>& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

// One name of --sequences where there is no --scenes.
SequenceChoice choiceOf(const std::string& sequence) {
    const std::vector<std::string> catalogue = namesOf(studio::sequenceCatalogue(), false);
    const std::vector<std::string> movements = namesOf(studio::sceneMovements(), false);
    if (isAmong(sequence, catalogue)) return {"", sequence, ""};
    const std::size_t dot = sequence.rfind('.');
    const std::string scene = sequence.substr(0, dot);
    if (dot != std::string::npos && isAmong(sequence.substr(dot + 1), movements) &&
        isAmong(scene, sceneNames()))
        return {scene, sequence.substr(dot + 1), fmt::format("--sequences '{}'", sequence)};
    throw UsageError(
        fmt::format("unknown sequence '{}'; valid: {}; or SCENE.MOVEMENT, a scene of {} "
                    "and one of {}",
                    sequence, joinNames(catalogue), joinNames(sceneNames()), joinNames(movements)));
}

}  // namespace

std::vector<SequenceChoice> chooseSequences(const std::vector<std::string>& scenes,
                                            const std::vector<std::string>& sequences, bool quick) {
    std::vector<SequenceChoice> choices;
    if (scenes.empty()) {
        if (sequences.empty())
            for (const std::string& name : namesOf(studio::sequenceCatalogue(), quick))
                choices.push_back({"", name, ""});
        for (const std::string& sequence : sequences) choices.push_back(choiceOf(sequence));
        return choices;
    }
    requireScenes(scenes);
    const std::vector<std::string> movements = namesOf(studio::sceneMovements(), false);
    for (const std::string& sequence : sequences)
        if (!isAmong(sequence, movements))
            throw UsageError(fmt::format("--sequences '{}': expected, with --scenes, one of: {}",
                                         sequence, joinNames(movements)));
    for (const std::string& scene : scenes)
        for (const std::string& movement : sequences.empty() ? movements : sequences)
            choices.push_back({scene, movement, fmt::format("--scenes '{}'", scene)});
    return choices;
}

std::vector<studio::FailureSequence> makeSequences(const std::vector<SequenceChoice>& choices,
                                                   const studio::SequenceSize& size) {
    std::vector<studio::FailureSequence> made;
    std::string loaded;
    studio::Scene scene;
    for (const SequenceChoice& choice : choices) {
        if (choice.scene.empty()) {
            made.push_back(asUsage([&] { return studio::makeSequence(choice.name, size); }));
            continue;
        }
        try {
            if (choice.scene != loaded) scene = studio::loadScene(choice.scene);
            loaded = choice.scene;
            made.push_back(studio::makeMovement(scene, choice.name, size));
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception& error) {
            throw UsageError(fmt::format("{}: {}", choice.argument, error.what()));
        }
    }
    return made;
}

}  // namespace cli
