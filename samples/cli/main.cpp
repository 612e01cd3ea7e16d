// The program `lightwell`: render with the library, trace the truth, compare the two. docs/cli.md.
//
// Exit codes: 0 done; 1 the work failed (device, disk); 2 a wrong argument; 130 interrupted.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <new>
#include <string>

#include "cli.h"
#include "completion.h"
#include "interrupt.h"
#include "place_vpls.h"

namespace {

constexpr int kFailed = 1, kWrongArgument = 2;

constexpr char kFooter[] =
    "Exit codes: 0 done; 1 the work failed (device, driver, disk); 2 a wrong argument; 130 interrupted.\n\n"
    "Environment:\n"
    "  LIGHTWELL_SCENES     folders of further scenes, separated by \":\"\n"
    "  LIGHTWELL_DEVICE     gpu, cpu, PLATFORM:DEVICE indices or part of a name\n"
    "  LIGHTWELL_WIDTH      lanes per work-item: 1, 4, 8, 16\n"
    "  LIGHTWELL_CACHE_DIR  folder of compiled kernels and of truths\n";

// One line, whatever the message's own layout.
void printError(std::string message) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "lightwell: {}\n", message);
}

std::vector<std::string> commandNames(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands(nullptr)) names.push_back(command->get_name());
    return names;
}

std::vector<std::string> optionNames(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) names.push_back(option->get_name());
    return names;
}

// Named by the user, or "" when the first word is an option or missing.
std::string commandWord(int argc, char** argv) {
    return argc > 1 && argv[1][0] != '-' ? argv[1] : "";
}

int parse(CLI::App& app, int argc, char** argv) {
    const std::string command = commandWord(argc, argv);
    try {
        if (!command.empty()) cli::requireOneOf("command", command, commandNames(app));
        app.parse(argc, argv);
        return 0;
    } catch (const CLI::Success& success) {  // --help, --version
        return app.exit(success);
    } catch (const CLI::RequiredError& error) {
        if (!command.empty()) throw cli::UsageError(fmt::format("{}: {}", command, error.what()));
        throw cli::UsageError("expected a command; valid: " + cli::joinNames(commandNames(app)));
    } catch (const CLI::ExtrasError& error) {
        const CLI::App& asked = command.empty() ? app : *app.get_subcommand(command);
        throw cli::UsageError(
            fmt::format("{}; valid: {}", error.what(), cli::joinNames(optionNames(asked))));
    } catch (const CLI::ParseError& error) {
        throw cli::UsageError(fmt::format("{}{}; see lightwell {}{}--help",
                                          command.empty() ? "" : command + ": ", error.what(), command,
                                          command.empty() ? "" : " "));
    }
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{
        "Lightwell: indirect light for pictures already lit directly, and the truth to judge it by"};
    app.name("lightwell");
    app.set_version_flag("--version", LIGHTWELL_CLI_VERSION);
    app.require_subcommand(1);
    try {
        cli::addDevices(app);
        cli::addScenes(app);
        cli::addRender(app);
        cli::addReference(app);
        cli::addCompare(app);
        cli::addTriptych(app);
        cli::addChart(app);
        cli::addSplit(app);
        cli::addVisibility(app);
        cli::addProbes(app);
        cli::addStability(app);
        cli::addPlaceVpls(app);
        cli::addCheck(app);
        cli::addPlan(app);
        cli::addGi(app);
        cli::addCompletion(app);
        cli::addManual(app);
        app.footer(kFooter);  // last: commands begin with the footer that stands here
        if (commandWord(argc, argv) == "complete") {
            cli::printCompletions(app, std::vector<std::string>(argv + 2, argv + argc));
            return 0;
        }
        return parse(app, argc, argv);
    } catch (const cli::UsageError& error) {
        printError(error.what());
        return kWrongArgument;
    } catch (const cli::Interrupted& error) {
        printError(error.what());
        return cli::kInterruptedExitCode;
    } catch (const std::bad_alloc&) {
        printError("out of memory; a smaller --size needs less");
        return kFailed;
    } catch (const std::exception& error) {
        printError(error.what());
        return kFailed;
    }
}
