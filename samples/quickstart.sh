#!/usr/bin/env bash
# From a fresh Debian machine to a picture: installs what is missing, builds, renders the shipped Cornell
# box, and leaves build/quickstart.png: direct only | with Lightwell | path-traced truth.
#
#   samples/quickstart.sh [SCENE] [--size WxH]     SCENE: a shipped scene's name, default cornell
#   LIGHTWELL_DEVICE=gpu samples/quickstart.sh     on another OpenCL device
#   LIGHTWELL_NO_INSTALL=1                         never call apt-get
#
# Exit code: 0 when the picture is there, 2 when it is not, after a message that says why.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd) || exit 2
cd "$root" || exit 2
# shellcheck source=tests/support/packages.sh
source tests/support/packages.sh

scene=cornell
size=400x400 # the Cornell box is square
while [ $# -gt 0 ]; do
    case $1 in
        --size)
            size=${2:-}
            shift
            ;;
        -h | --help)
            sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
            exit 0
            ;;
        -*)
            lightwell_complain "unknown option '$1'; expected [SCENE] [--size WxH]"
            exit 2
            ;;
        *) scene=$1 ;;
    esac
    shift
done
if ! [[ $size =~ ^[1-9][0-9]*x[1-9][0-9]*$ ]]; then
    lightwell_complain "--size: expected WIDTHxHEIGHT, for example 400x400, got '$size'"
    exit 2
fi

lightwell_need "quickstart" "${LIGHTWELL_LIBRARY_PACKAGES[@]}" "${LIGHTWELL_SAMPLE_PACKAGES[@]}" || exit 2

build=build/quickstart
mkdir -p "$build/cache" "$build/work" || exit 2
export LIGHTWELL_CACHE_DIR=${LIGHTWELL_CACHE_DIR:-$root/$build/cache}

# Runs a step into a log; on failure prints the log's end and stops.
step() {
    local name=$1 begin=$SECONDS log=$build/$1.txt
    shift
    if "$@" >"$log" 2>&1 </dev/null; then
        lightwell_say "$name: $((SECONDS - begin)) s"
        return 0
    fi
    lightwell_complain "$name failed: $*"
    lightwell_complain "end of $log:"
    tail -n 25 "$log" >&2
    exit 2
}

# Only what the picture needs: the library, the studio and the command line.
step configure cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=Release \
    -DLIGHTWELL_BUILD_TESTS=OFF -DLIGHTWELL_BUILD_BENCH=OFF
step build cmake --build "$build" --parallel "$(nproc)" --target lightwell_cli
lightwell=$build/bin/lightwell
if [ ! -x "$lightwell" ]; then
    lightwell_complain "the build left no program $lightwell"
    exit 2
fi
if ! "$lightwell" devices >"$build/devices.txt" 2>&1; then
    lightwell_complain "no OpenCL device: install a driver (GPU: its vendor's; CPU: apt-get install pocl-opencl-icd)"
    cat "$build/devices.txt" >&2
    exit 2
fi

# The truth is kept: it depends on scene and size only. The scene may be a path.
truth=$build/work/${scene//\//_}-$size-truth.exr
rendered=$build/work/${scene//\//_}-$size-rsm.exr
if [ ! -s "$truth" ]; then
    lightwell_say "path-tracing the truth (once)"
    "$lightwell" reference "$scene" --bounces all --spp 128 --size "$size" --out "$truth" || exit 2
fi
"$lightwell" render "$scene" --technique rsm --frames 9 --size "$size" --out "$rendered" || exit 2
echo
# The truth holds every bounce and every shadow; rsm one bounce without shadows of the bounced light.
"$lightwell" compare "$rendered" "$truth" || exit 2
"$lightwell" triptych "$rendered" "$truth" --out build/quickstart.png || exit 2
lightwell_say "build/quickstart.png: direct only | with Lightwell | path-traced truth ($SECONDS s in all)"
