// Sources of programs: embedded, or flattened from LIGHTWELL_KERNEL_DIR by the rules of
// kernels/embed.cmake (a test compares the two).
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "compute/error.h"
#include "compute/program.h"

namespace lightwell {
namespace {

namespace fs = std::filesystem;

std::string readText(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) fail(LW_ERROR_INVALID_ARGUMENT, "LIGHTWELL_KERNEL_DIR: cannot read ", path.string());
    return text.str();
}

// The name in `#include "name"`, or empty for any other line.
std::string includedName(const std::string& line) {
    const char* blank = " \t";
    std::size_t at = line.find_first_not_of(blank);
    if (at == std::string::npos || line[at] != '#') return {};
    at = line.find_first_not_of(blank, at + 1);
    if (at == std::string::npos || line.compare(at, 7, "include") != 0) return {};
    const std::size_t open = line.find_first_not_of(blank, at + 7);
    if (open == std::string::npos || open == at + 7 || line[open] != '"') return {};
    const std::size_t close = line.find('"', open + 1);
    return close == std::string::npos ? std::string{} : line.substr(open + 1, close - open - 1);
}

class Flattener {
public:
    explicit Flattener(fs::path root) : root_(std::move(root)) {}

    void add(const fs::path& file) {
        const fs::path path = file.lexically_normal();
        if (!seen_.insert(path).second) return;
        const std::string shown = path.lexically_relative(root_.lexically_normal()).generic_string();
        std::istringstream lines(readText(path));
        text += "#line 1 \"" + shown + "\"\n";
        std::string line;
        for (unsigned number = 1; std::getline(lines, line); ++number) {
            const std::string name = includedName(line);
            if (name.empty()) {
                text += line + '\n';
                continue;
            }
            add(find(path, name));
            text += "#line " + std::to_string(number + 1) + " \"" + shown + "\"\n";
        }
    }

    std::string text;

private:
    fs::path find(const fs::path& from, const std::string& name) const {
        for (const fs::path& candidate : {from.parent_path() / name, root_ / name})
            if (fs::exists(candidate)) return candidate;
        fail(LW_ERROR_INVALID_ARGUMENT, "LIGHTWELL_KERNEL_DIR: ", from.string(), ": included file \"",
             name, "\" found neither beside it nor in ", root_.string());
    }

    fs::path root_;
    std::set<fs::path> seen_;
};

}  // namespace

std::string flattenProgram(const std::string& directory, const std::string& name) {
    const fs::path root(directory);
    std::error_code ignored;
    if (!fs::is_directory(root, ignored))
        fail(LW_ERROR_INVALID_ARGUMENT, "LIGHTWELL_KERNEL_DIR: expected a directory of kernels, got \"",
             directory, "\"");
    Flattener flattener(root);
    flattener.add(root / (name + ".cl"));
    return flattener.text;
}

std::string programSource(const std::string& name) {
    for (std::size_t i = 0; i < kEmbeddedProgramsCount; ++i) {
        const EmbeddedProgram& program = kEmbeddedPrograms[i];
        if (name != program.name) continue;
        if (const char* directory = std::getenv("LIGHTWELL_KERNEL_DIR"); directory && *directory)
            return flattenProgram(directory, name);
        return std::string(reinterpret_cast<const char*>(program.bytes), program.size);
    }
    fail(LW_ERROR_INTERNAL, "no program named \"", name, "\" is embedded");
}

}  // namespace lightwell
