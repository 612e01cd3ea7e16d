# shellcheck shell=bash
# What Lightwell needs from the system, and how it gets there. Sourced by tests/run.sh and
# samples/quickstart.sh; sets no shell options and runs nothing by itself.
#
#   lightwell_need TITLE PACKAGE...   installs what is missing; returns 1, with a clear message, when a
#                                     package cannot be had. Touches neither network nor package lists
#                                     when everything is there.
#   lightwell_want TITLE PACKAGE...   the same for packages that only some tests use: says what will be
#                                     skipped and returns 0.

# The library and everything that builds it, with one OpenCL driver that needs no GPU.
# shellcheck disable=SC2034
LIGHTWELL_LIBRARY_PACKAGES=(build-essential cmake ninja-build pkg-config ocl-icd-opencl-dev
    opencl-c-headers pocl-opencl-icd libglm-dev)
# The studio and the command line. OpenImageIO's CMake files also look for its tools and for Imath;
# Assimp's name zlib's development file, which its package does not ask for.
# shellcheck disable=SC2034
LIGHTWELL_SAMPLE_PACKAGES=(libembree-dev libopenimageio-dev openimageio-tools libimath-dev
    libassimp-dev zlib1g-dev libcli11-dev nlohmann-json3-dev libfmt-dev)
# shellcheck disable=SC2034
LIGHTWELL_TEST_PACKAGES=(catch2 libbenchmark-dev)
# Tools that single suites are about; a suite without its tool is skipped.
# matplotlib and D3: the report of `lightwell chart`. cffi (NumPy comes with matplotlib): the Python package.
# shellcheck disable=SC2034
LIGHTWELL_TEST_TOOLS=(oclgrind doxygen mesa-opencl-icd python3 python3-matplotlib python3-cffi
    node-d3)

# The viewer (samples/viewer): without them it is not built, and its suite is left out.
# shellcheck disable=SC2034
LIGHTWELL_VIEWER_PACKAGES=(libglfw3-dev libepoxy-dev libimgui-dev libegl1 libgl1-mesa-dri)

lightwell_say() { printf 'lightwell: %s\n' "$*"; }
lightwell_complain() { printf 'lightwell: %s\n' "$*" >&2; }

# Prints those of the named packages that are not installed, one a line.
lightwell_missing() {
    local package status
    for package in "$@"; do
        status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) || status=
        # dpkg-query prints one status per architecture, without separator.
        case $status in installed*) ;; *) printf '%s\n' "$package" ;; esac
    done
}

# Runs a command as root: directly, or through sudo.
lightwell_as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null 2>&1; then
        sudo -- "$@"
    else
        return 126
    fi
}

lightwell_apt() {
    lightwell_as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -y \
        -o Dpkg::Use-Pty=0 -o Acquire::Retries=2 "$@" </dev/null
}

# What to do without apt-get, or when it fails.
lightwell_package_help() {
    lightwell_complain "what to do:"
    lightwell_complain "  - on Debian 12, with network: apt-get update && apt-get install --no-install-recommends $*"
    lightwell_complain "  - no root and no sudo here: ask for those packages, then run this again; it installs nothing then"
    lightwell_complain "  - another system: install the same libraries there (Embree 3.13 or 4, OpenImageIO 2.4 or later,"
    lightwell_complain "    Assimp 5, CLI11 2, nlohmann-json 3, fmt 9, Catch2 2.13, Google Benchmark, GLM, an OpenCL ICD"
    lightwell_complain "    loader with headers, and a driver such as PoCL), then set LIGHTWELL_NO_INSTALL=1"
    lightwell_complain "  - the library alone needs only: ${LIGHTWELL_LIBRARY_PACKAGES[*]}  (cmake --preset library)"
}

# Installs the packages; leaves in lightwell_refused those that could not be had.
lightwell_install() {
    local package
    lightwell_refused=()
    if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null 2>&1; then
        lightwell_complain "installing needs root or sudo; missing: $*"
        lightwell_refused=("$@")
        return 1
    fi
    # Package lists may be old or absent: refresh them once, and only since something is missing.
    if [ -z "${lightwell_lists_fresh:-}" ]; then
        lightwell_say "apt-get update"
        lightwell_apt update >"$lightwell_apt_log" 2>&1 || {
            lightwell_complain "apt-get update failed; going on with the lists at hand. Its last lines:"
            tail -n 5 "$lightwell_apt_log" >&2
        }
        lightwell_lists_fresh=1
    fi
    lightwell_say "apt-get install $*"
    if lightwell_apt install --no-install-recommends "$@" >>"$lightwell_apt_log" 2>&1; then return 0; fi
    tail -n 5 "$lightwell_apt_log" >&2
    # One bad name must not hide the others: try each alone, and name the ones that fail.
    for package in "$@"; do
        lightwell_apt install --no-install-recommends "$package" >>"$lightwell_apt_log" 2>&1 ||
            lightwell_refused+=("$package")
    done
    [ ${#lightwell_refused[@]} -eq 0 ]
}

# Shared body: fills lightwell_refused; returns 1 when something is missing in the end.
lightwell_ensure() {
    local title=$1 missing
    shift
    lightwell_refused=()
    if [ -n "${LIGHTWELL_NO_INSTALL:-}" ]; then return 0; fi
    if ! command -v dpkg-query >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then
        lightwell_complain "$title: this is no Debian system (no dpkg-query or apt-get); not checking packages"
        return 0
    fi
    mapfile -t missing < <(lightwell_missing "$@")
    if [ ${#missing[@]} -eq 0 ]; then return 0; fi
    lightwell_apt_log=$(mktemp "${TMPDIR:-/tmp}/lightwell-apt.XXXXXX") || return 1
    lightwell_install "${missing[@]}"
    local status=$?
    if [ $status -eq 0 ]; then rm -f "$lightwell_apt_log"; else lightwell_complain "whole log: $lightwell_apt_log"; fi
    return $status
}

lightwell_need() {
    lightwell_ensure "$@" && return 0
    lightwell_complain "$1: these packages could not be installed: ${lightwell_refused[*]}"
    lightwell_package_help "${lightwell_refused[@]}"
    return 1
}

lightwell_want() {
    lightwell_ensure "$@" && return 0
    lightwell_complain "$1: going on without ${lightwell_refused[*]}; the suites that use them are skipped"
    return 0
}
