// What a shell offers for a command line that is being typed, told from the program's own declarations.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace cli {

struct Candidate {
    std::string word, description;  // a word that ends in "=" wants a value behind it
};
struct Completions {
    std::vector<Candidate> words;
    bool files = false;  // a path may stand here as well
};

// `words`: all behind the program's name, the last one, which may be "", being typed.
Completions complete(const CLI::App& app, const std::vector<std::string>& words);

// `lightwell complete WORD...`, which the shells' scripts call: a candidate a line, with a tab before its description; a last line ":files"
// where paths may stand. No command of the application, so that words that begin with "-" are left alone.
void printCompletions(const CLI::App& app, const std::vector<std::string>& words);

void addCompletion(CLI::App& app);  // `lightwell completion bash|zsh|fish`
void addManual(CLI::App& app);      // `lightwell manual`

}  // namespace cli
