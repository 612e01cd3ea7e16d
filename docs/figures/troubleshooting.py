#!/usr/bin/env python3
"""What each planted fault does to light, for docs/troubleshooting.md: writes docs/troubleshooting_figures.md.

    docs/figures/troubleshooting.py [BINARY]
"""
import json
import re
import subprocess
import sys

from program import ROOT

SCENE, SIZE = "cornell", "320x180"
TECHNIQUES = ["rsm", "horizon", "lpv"]


def check(binary, plant, technique):
    run = subprocess.run([binary, "check", SCENE, "--size", SIZE, "--plant", plant, "--light", technique, "--json"],
                         capture_output=True, text=True)
    if run.returncode not in (0, 1):
        sys.exit(run.stderr)
    return json.loads(run.stdout)


def cell(light):
    if "refusal" in light:
        return "refused"
    if light["mean"] is None:
        return "no number"
    return f"{light['mean']:.3g}, {100 * light['black']:.0f} %, {100 * light['off']:.0f} %"


def main():
    binary = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "build/release/bin/lightwell")
    text = subprocess.run([binary, "check", "--help"], capture_output=True, text=True, check=True).stdout
    plants = re.findall(r"^  ([a-z-]+) +.*; found as ([a-z-]+)$", text, re.M)
    lines = ["<!-- Made by docs/figures/troubleshooting.py; do not edit. -->", "",
             "# What faults do to light", "",
             f"Each fault of [checking inputs](checking-inputs.md), planted in the inputs of {SCENE} at {SIZE}, and the light that techniques make of "
             "them: mean, as a factor on that of sound inputs; share of the lit pixels that have none any more; share that is off by more than "
             "a tenth. *Found as*: what `lwCheckInputs` names first. Plants that need what the scene has not got are left out.", "",
             "| plant | found as | " + " | ".join(f"`{t}`" for t in TECHNIQUES) + " |", "| --- | --- |" + " --- |" * len(TECHNIQUES)]
    for plant, _ in plants:
        try:
            found = [check(binary, plant, technique) for technique in TECHNIQUES]
        except SystemExit as refused:
            print(f"{plant}: {refused}", file=sys.stderr)
            continue
        first = found[0]["findings"][0]["fault"] if found[0]["findings"] else "nothing"
        lines.append(f"| `{plant}` | `{first}` | " + " | ".join(cell(f["light"]) for f in found) + " |")
    (ROOT / "docs/troubleshooting_figures.md").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
