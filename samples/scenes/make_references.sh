#!/usr/bin/env bash
# Traces the references of the shipped scenes: one indirect bounce at 320x180, half-float, with their own
# noise as metadata. Minutes on two cores.
#
#   samples/scenes/make_references.sh [LIGHTWELL]   default: build/release/bin/lightwell

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd) || exit 1
lightwell=${1:-$here/../../build/release/bin/lightwell}
if [ ! -x "$lightwell" ]; then
    printf '%s: not found; build the samples first, or give the path of lightwell\n' "$lightwell" >&2
    exit 1
fi
mkdir -p "$here/references" || exit 1
for scene in basic cornell furnace rooms sphere_room; do
    "$lightwell" reference "$scene" --bounces 1 --size 320x180 --until relMSE=0.001 --half --compact \
        --out "$here/references/$scene.exr" || exit 1
done
