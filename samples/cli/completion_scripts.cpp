// `lightwell completion SHELL`: the scripts that ask `lightwell complete` for what may stand where the user types.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "cli.h"
#include "completion.h"

namespace cli {
namespace {

// The line is split here anew: bash takes "key=value" for three words, and replaces only what stands behind the "=". Backslashes are
// read as the line has them, so that names with spaces are whole.
constexpr char kBash[] = R"sh(# bash completion for lightwell: written by `lightwell completion bash`
_lightwell() {
    local line=${COMP_LINE:0:COMP_POINT} words current reply candidate
    read -a words <<<"$line"
    case $line in *\\[[:space:]]) ;; *[[:space:]]) words+=("") ;; esac
    current=${words[${#words[@]}-1]}
    COMPREPLY=()
    while IFS= read -r reply; do
        if [ "$reply" = ":files" ]; then
            compopt -o filenames 2>/dev/null
            while IFS= read -r candidate; do COMPREPLY+=("$candidate"); done < <(compgen -f -- "${current#--*=}")
        else
            candidate=${reply%%$'\t'*}
            case $candidate in *=) compopt -o nospace 2>/dev/null ;; esac
            case $current in *=*) candidate=${candidate#"${current%=*}="} ;; esac
            COMPREPLY+=("$candidate")
        fi
    done < <("${1/#\~/$HOME}" complete "${words[@]:1}" 2>/dev/null)
}
complete -F _lightwell lightwell
)sh";

constexpr char kZsh[] = R"sh(#compdef lightwell
# zsh completion for lightwell: written by `lightwell completion zsh`
_lightwell() {
    local -a whole open
    local reply files=
    for reply in ${(f)"$(${(Q)~words[1]} complete "${(@Q)words[2,CURRENT]}" 2>/dev/null)"}; do
        if [[ $reply == :files ]]; then
            files=1
        elif [[ ${reply%%$'\t'*} == *= ]]; then
            open+=("${${reply%%$'\t'*}//:/\\:}:${reply#*$'\t'}")
        elif [[ $reply == *$'\t'* ]]; then
            whole+=("${${reply%%$'\t'*}//:/\\:}:${reply#*$'\t'}")
        else
            whole+=("${reply//:/\\:}")
        fi
    done
    (( $#whole )) && _describe 'lightwell' whole
    (( $#open )) && _describe 'lightwell' open -S ''
    [[ -n $files ]] && _files
}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then _lightwell "$@"; else compdef _lightwell lightwell; fi
)sh";

constexpr char kFish[] = R"sh(# fish completion for lightwell: written by `lightwell completion fish`
function __lightwell_complete
    set -l words (commandline -opc)
    $words[1] complete $words[2..-1] (commandline -ct | string collect --allow-empty) 2>/dev/null
end
function __lightwell_takes_files
    __lightwell_complete | string match -q ':files'
end
complete -c lightwell -f -a '(__lightwell_complete | string match -v ":files")'
complete -c lightwell -n __lightwell_takes_files -F
)sh";

}  // namespace

void addCompletion(CLI::App& app) {
    CLI::App* command = app.add_subcommand("completion", "Print a script that has a shell complete commands, options, scenes, techniques and settings");
    auto shell = std::make_shared<std::string>();
    command->add_option("SHELL", *shell, "bash, fish or zsh")->required();
    command->callback([shell] {
        requireOneOf("SHELL", *shell, {"bash", "fish", "zsh"});
        fmt::print("{}", *shell == "bash" ? kBash : *shell == "zsh" ? kZsh : kFish);
    });
}

}  // namespace cli
