// `lightwell manual`: the manual page lightwell(1), made of what --help says, so that neither can lack what the other has.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <sstream>

#include "cli.h"
#include "completion.h"

namespace cli {
namespace {

// Text for roff: no escapes, no requests at a line's start, and what it would turn into typographic signs as characters that can be
// searched for and copied.
std::string roff(const std::string& text) {
    static const std::map<char, const char*> escapes = {{'\\', "\\e"},   {'-', "\\-"},    {'\'', "\\(aq"}, {'`', "\\(ga"},
                                                        {'^', "\\(ha"}, {'~', "\\(ti"}, {'"', "\\(dq"}};
    std::string result;
    for (const char c : text) {
        const auto escape = escapes.find(c);
        if (escape == escapes.end())
            result += c;
        else
            result += escape->second;
    }
    if (!result.empty() && result[0] == '.') result.insert(0, "\\&");
    return result;
}

std::string upper(std::string text) {
    for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

std::string optionNames(const CLI::Option& option) {
    if (option.get_positional()) return option.get_name(true);
    std::string names;
    for (const std::string& name : option.get_snames()) names += fmt::format("{}-{}", names.empty() ? "" : ", ", name);
    for (const std::string& name : option.get_lnames()) names += fmt::format("{}--{}", names.empty() ? "" : ", ", name);
    return names;
}

void printOption(const CLI::Option& option) {
    std::string facts;
    const std::string type = option.get_positional() || option.get_items_expected_max() == 0 ? "" : option.get_type_name();
    if (!type.empty()) facts += " " + type;
    if (!option.get_default_str().empty()) facts += "=" + option.get_default_str();
    if (option.get_items_expected_max() > 1) facts += " ...";
    if (option.get_required()) facts += " (required)";
    fmt::print(".TP\n.B {}\n{}\n", roff(optionNames(option)) + roff(facts), roff(option.get_description()));
}

void printOptions(const CLI::App& app) {
    for (const bool positional : {true, false})
        for (const CLI::Option* option : app.get_options())
            if (option->get_positional() == positional) printOption(*option);
}

// Lists behind the options, as they stand there: line by line.
void printFooter(const CLI::App& app) {
    std::istringstream lines(app.get_footer());
    std::string text;
    for (std::string line; std::getline(lines, line);) text += roff(line) + "\n";
    while (!text.empty() && text.back() == '\n') text.pop_back();
    if (!text.empty()) fmt::print(".PP\n.nf\n{}\n.fi\n", text);
}

std::string usage(const CLI::App& command) {
    std::string words = roff("lightwell " + command.get_name());
    for (const CLI::Option* option : command.get_options()) {
        if (!option->get_required()) continue;
        words += " " + roff(optionNames(*option)) + (option->get_positional() ? "" : " " + roff(option->get_type_name()));
    }
    return words + " [options]";
}

void printManual(const CLI::App& app) {
    // No date: the same sources make the same page.
    fmt::print(".TH LIGHTWELL 1 \"\" \"lightwell {0}\" \"User Commands\"\n.SH NAME\nlightwell \\- {1}\n", LIGHTWELL_CLI_VERSION,
               roff("indirect light for pictures already lit directly, and the truth to judge it by"));
    fmt::print(".SH SYNOPSIS\n.B lightwell\n.I command\n[options]\n.SH DESCRIPTION\n{}.\n", roff(app.get_description()));
    printFooter(app);
    fmt::print(".SH OPTIONS\n");
    printOptions(app);
    fmt::print(".SH COMMANDS\n");
    for (const CLI::App* command : app.get_subcommands(nullptr)) {
        fmt::print(".SS {}\n{}.\n.PP\n.B {}\n", roff(upper(command->get_name())), roff(command->get_description()), usage(*command));
        printOptions(*command);
        printFooter(*command);
    }
}

}  // namespace

void addManual(CLI::App& app) {
    CLI::App* command = app.add_subcommand("manual", "Print the manual page lightwell(1), for `man -l`");
    command->callback([&app] { printManual(app); });
}

}  // namespace cli
