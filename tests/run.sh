#!/usr/bin/env bash
# Installs what is missing, builds everything with warnings as errors, runs every test suite and prints
# its time against its budget. Needs Debian 12 and root or sudo for the first run only.
#
#   tests/run.sh                      everything; this is what .ci/run does
#   tests/run.sh -R rsm               only suites whose name matches (any ctest option may follow)
#   LIGHTWELL_SCENES=DIR tests/run.sh also the suites that need the large scenes
#   LIGHTWELL_TEST_DEVICE=gpu tests/run.sh   another OpenCL device than the CPU's
#   LIGHTWELL_NO_INSTALL=1            never call apt-get
#   LIGHTWELL_SIMULATOR=1             Oclgrind's suites also where they would take all past the limit of 1,500 s (0: never)
#
# Exit code: 0 when every suite passed, 1 when one failed or nothing ran, 2 when it could not build.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd) || exit 2
cd "$root" || exit 2
# shellcheck source=tests/support/packages.sh
source tests/support/packages.sh

preset=ci
build=build/$preset
log=$build/log
mkdir -p "$log" || exit 2
started=$SECONDS

# --- packages ---------------------------------------------------------------------------------------
lightwell_need "build and test" "${LIGHTWELL_LIBRARY_PACKAGES[@]}" "${LIGHTWELL_SAMPLE_PACKAGES[@]}" \
    "${LIGHTWELL_TEST_PACKAGES[@]}" || exit 2
lightwell_want "extra suites" "${LIGHTWELL_TEST_TOOLS[@]}"
lightwell_want "the viewer" "${LIGHTWELL_VIEWER_PACKAGES[@]}"

# --- environment: nobody's settings but ours --------------------------------------------------------
scenes=${LIGHTWELL_SCENES:-}
device=${LIGHTWELL_TEST_DEVICE:-cpu}
wants_long=${LIGHTWELL_LONG:-0}
simulator=${LIGHTWELL_SIMULATOR:-auto}
for name in $(compgen -e); do
    case $name in
        LIGHTWELL_* | POCL_* | RUSTICL_* | CTEST_* | CMAKE_* | EMBREE_* | OPENIMAGEIO_*) unset "$name" ;;
        CFLAGS | CXXFLAGS | CPPFLAGS | LDFLAGS | NINJA_STATUS) unset "$name" ;;
    esac
done
export LC_ALL=C
export LIGHTWELL_DEVICE=$device
export LIGHTWELL_CACHE_DIR=$root/$build/cache/lightwell
export POCL_CACHE_DIR=$root/$build/cache/pocl
mkdir -p "$LIGHTWELL_CACHE_DIR" "$POCL_CACHE_DIR" || exit 2
# What another clone of the same sources compiled is the same here.
export CCACHE_BASEDIR=$root
if [ -n "$scenes" ]; then
    # Folders separated by ":", made absolute since suites run in the build folder.
    LIGHTWELL_SCENES=
    IFS=: read -r -a folders <<<"$scenes"
    for folder in "${folders[@]}"; do
        if [ ! -d "$folder" ]; then
            lightwell_complain "LIGHTWELL_SCENES: expected folders separated by ':', got '$folder'"
            exit 2
        fi
        LIGHTWELL_SCENES+=${LIGHTWELL_SCENES:+:}$(cd "$folder" && pwd)
    done
    export LIGHTWELL_SCENES
    lightwell_say "large scenes from $LIGHTWELL_SCENES"
else
    lightwell_say "LIGHTWELL_SCENES is not set: what needs the large scenes is skipped"
fi

# --- build ------------------------------------------------------------------------------------------
# Runs a step into a log; on failure prints its errors (or its end) and stops.
step() {
    local name=$1 begin=$SECONDS
    shift
    if "$@" >"$log/$name.txt" 2>&1 </dev/null; then
        seconds=$((SECONDS - begin))
        lightwell_say "$name: $seconds s"
        return 0
    fi
    lightwell_complain "$name failed after $((SECONDS - begin)) s: $*"
    grep -n -E 'error|FAILED|CMake Error' "$log/$name.txt" | head -n 40 >&2
    lightwell_complain "end of $log/$name.txt:"
    tail -n 40 "$log/$name.txt" >&2
    return 1
}
stop() {
    printf '\n0 passed, 1 failed\n'
    exit 2
}
step configure cmake --preset "$preset" || stop
step build cmake --build "$build" --parallel "$(nproc)" || stop
build_seconds=$seconds

# --- test -------------------------------------------------------------------------------------------
lightwell_say "device: $LIGHTWELL_DEVICE; testing"
results=$log/ctest.txt
# Two suites at once, of which one at most measures times, and one at most runs in the simulator (tests/budgets.cmake).
# What compiles many programs takes minutes, and is left out unless asked for.
left_out=
[ "$wants_long" = 1 ] || left_out=long
# A machine that takes this long (s) to build would take past the limit in all; the simulator's suites, kernels once more, are a quarter of
# what is tested (measured: 660 s of building and 1,100 of testing). Who asks for suites by options of ctest gets them.
slow_build=550 left_count=0
case $simulator in
    0 | 1) ;;
    auto) { [ $# -eq 0 ] && [ "$build_seconds" -gt $slow_build ] && simulator=0; } || simulator=1 ;;
    *) lightwell_complain "LIGHTWELL_SIMULATOR: expected 0, 1 or auto, got '$simulator'"; exit 2 ;;
esac
if [ "$simulator" = 0 ]; then
    left_count=$(cd "$build" && ctest -N -L '^oclgrind$' | sed -n 's/^Total Tests: //p')
    lightwell_say "Oclgrind's $left_count suites are left out: building took $build_seconds s; LIGHTWELL_SIMULATOR=1 runs them all the same"
    left_out+=${left_out:+|}oclgrind
fi
excluded=()
[ -n "$left_out" ] && excluded=(-LE "^($left_out)\$")
(cd "$build" && ctest --parallel 2 --output-on-failure --no-label-summary --no-tests=error "${excluded[@]}" "$@" </dev/null 2>&1) | tee "$results"
ctest_status=${PIPESTATUS[0]}

# --- table ------------------------------------------------------------------------------------------
# Budgets (seconds on two cores) stand in tests/budgets.txt; a suite that is late is marked, and one
# that takes its time limit (CMake: three times the budget) has failed.
awk -v budgets=tests/budgets.txt -v total=$((SECONDS - started)) -v status="$ctest_status" -v left="$left_count" '
    BEGIN {
        while ((getline line < budgets) > 0) {
            split(line, field, " ")
            if (field[1] != "" && field[1] !~ /^#/) budget[field[1]] = field[2]
        }
        passed = failed = skipped = late = 0
        printf "\n%-28s %-8s %8s %8s\n", "suite", "result", "seconds", "budget"
    }
    # "  3/12 Test  #3: api_test ........   Passed    1.25 sec"
    /^ *[0-9]+\/[0-9]+ Test +#[0-9]+: / {
        name = $0
        sub(/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: /, "", name)
        sub(/[ .].*$/, "", name)
        seconds = $0
        sub(/ sec *$/, "", seconds)
        sub(/^.* /, "", seconds)
        if ($0 ~ /\*\*\*Skipped/ || $0 ~ /\*\*\*Not Run \(Disabled\)/) { result = "skipped"; ++skipped }
        else if ($0 ~ / Passed +[0-9.]+ sec/) { result = "passed"; ++passed }
        else { result = "FAILED"; ++failed }
        mark = ""
        if (!(name in budget)) budget[name] = 60
        if (seconds + 0 > budget[name]) { mark = "  over budget"; ++late }
        printf "%-28s %-8s %8.1f %8s%s\n", name, result, seconds, budget[name], mark
        sum += seconds
    }
    END {
        printf "%-28s %-8s %8.1f\n", "all suites", "", sum
        printf "%-28s %-8s %8.0f %8d\n\n", "with install and build", "", total, 1500
        if (late) printf "%d over budget\n", late
        # A ctest that ended badly without a failed line (none ran, or it crashed) is a failure too.
        if (status != 0 && failed == 0) failed = 1
        if (passed == 0 && failed == 0) failed = 1
        if (left) printf "%d suites of the simulator left out (LIGHTWELL_SIMULATOR=1 runs them)\n", left
        if (skipped) printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped
        else printf "%d passed, %d failed\n", passed, failed
        exit failed ? 1 : 0
    }' "$results"
