#include "chart_script.h"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>

extern char** environ;

namespace cli {
namespace {

namespace fs = std::filesystem;

// Exit code of the program, 127 when it could not be started.
int call(std::vector<std::string> words, bool isSilent) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    if (isSilent) {
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", 1 /* O_WRONLY */, 0);
        posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", 1, 0);
    }
    pid_t child = 0;
    const int failed = posix_spawnp(&child, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    if (failed != 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return 127;
    return WEXITSTATUS(status);
}

std::string findPython() {
    const char* chosen = std::getenv("LIGHTWELL_PYTHON");
    // Beside the first in PATH, which may be a private one, the system's, whose modules are packages.
    for (const std::string& python : {std::string(chosen == nullptr ? "" : chosen),
                                      std::string("python3"), std::string("/usr/bin/python3")})
        if (!python.empty() && call({python, "-c", "import matplotlib"}, true) == 0) return python;
    return {};
}

// An installed tree keeps the scripts in share/.
fs::path scriptPath(const std::string& script) {
    if (const char* moved = std::getenv("LIGHTWELL_CHART_SCRIPTS"); moved != nullptr && *moved != '\0')
        return fs::path(moved) / script;
    const fs::path source = fs::path(LIGHTWELL_CHART_DIR) / script;
    return fs::exists(source) ? source : fs::path(LIGHTWELL_CHART_INSTALL_DIR) / script;
}

}  // namespace

void runChartScript(const std::string& script, const std::vector<std::string>& arguments) {
    const fs::path path = scriptPath(script);
    if (!fs::exists(path))
        throw std::runtime_error(fmt::format(
            "{}: no such script; LIGHTWELL_CHART_SCRIPTS names their folder", path.string()));
    const std::string python = findPython();
    if (python.empty())
        throw std::runtime_error(
            "the report needs Python 3 with matplotlib; on Debian: apt-get install python3-matplotlib "
            "node-d3 "
            "(LIGHTWELL_PYTHON names another interpreter). The results are kept; --report-only goes on "
            "from them");
    std::vector<std::string> words{python, path.string()};
    words.insert(words.end(), arguments.begin(), arguments.end());
    if (call(words, false) != 0)
        throw std::runtime_error(
            "the report could not be made (see above); the results are kept, and "
            "--report-only goes on from them");
}

}  // namespace cli
