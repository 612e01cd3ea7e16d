#!/usr/bin/env python3
"""Technique auto over a sequence in which camera, door and lamp move and the machine is loaded for a third of the time: what each frame
took, which technique it was, and how many frames stayed within the budget. Writes docs/images/auto_budget.png and the table between the
marks of docs/techniques/auto.md.

    docs/figures/auto.py [--budgets 8,16,33] [--frames 120] [--size 1280x720]
"""
import json
import multiprocessing
import os
import subprocess
import threading
import time

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt

import program

PAGE = program.ROOT / "docs/techniques/auto.md"
PICTURE = program.ROOT / "docs/images/auto_budget.png"
BEGIN, END = "<!-- figures: auto.py -->", "<!-- end of figures -->"
STEP = 1.0 / 30.0


def moving_scene(work):
    """`rooms` with a lamp that sweeps across its room while the camera walks and the door shuts."""
    scene = json.loads((program.ROOT / "samples/scenes/rooms.json").read_text(encoding="utf-8"))
    lamp = scene["lights"][0]
    lamp["keys"] = [{"time": 0.0}, {"time": 2.0, "target": [-0.5, 0.0, -1.5]}, {"time": 4.0, "target": [-2.0, 0.0, 1.0]}]
    path = work / "auto_rooms.json"
    path.write_text(json.dumps(scene), encoding="utf-8")
    return path


def spin():
    while True:
        pass


class Load:
    """Processes that keep `count` cores busy."""
    def __init__(self, count):
        self.count, self.busy = count, []

    def start(self):
        self.busy = [multiprocessing.Process(target=spin, daemon=True) for _ in range(self.count)]
        for process in self.busy:
            process.start()

    def stop(self):
        for process in self.busy:
            process.terminate()
            process.join()
        self.busy = []


def run(options, scene, budget, seconds=None, load=None):
    """The JSON of a render; with `load`, under it in the middle third of `seconds`."""
    frames = int(options.frames or 120)
    command = [options.lightwell, "render", str(scene), "--camera", "walk", "--size", options.size, "--technique", "auto", "--set",
               f"budget_ms={budget}", "--time", "4", "--step", str(STEP), "--frames", str(frames), "--warmup", "0", "--json"]
    begin = time.monotonic()
    timers = []
    if load:
        timers = [threading.Timer(seconds / 3, load.start), threading.Timer(2 * seconds / 3, load.stop)]
        for timer in timers:
            timer.start()
    result = subprocess.run(command, capture_output=True, text=True)
    for timer in timers:
        timer.cancel()
    if load:
        load.stop()
    if result.returncode:
        raise SystemExit(result.stderr.strip() or "lightwell render failed")
    return json.loads(result.stdout), time.monotonic() - begin


def figures_of(report, budget):
    """Shares within the budget: of all frames but the first two, which make what later ones have; and switches."""
    times, techniques = report["frame_ms"][2:], report["frame_techniques"][2:]
    within = sum(ms <= budget for ms in times) / len(times)
    switches = sum(a != b for a, b in zip(techniques, techniques[1:]))
    return within, switches, sorted(times)[len(times) // 2], max(times)


def draw(runs):
    figure, axes = plt.subplots(len(runs), 1, figsize=(9, 2.6 * len(runs)), sharex=True, squeeze=False)
    for axis, (budget, report) in zip(axes[:, 0], runs):
        times, techniques = report["frame_ms"], report["frame_techniques"]
        names = list(dict.fromkeys(techniques))
        for name in names:
            points = [(i, ms) for i, (ms, technique) in enumerate(zip(times, techniques)) if technique == name]
            axis.plot(*zip(*points), ".", markersize=5, label=name)
        axis.axhline(budget, color="black", linewidth=0.8)
        axis.set_ylim(0, max(2.2 * budget, 1.0))
        axis.set_ylabel("ms")
        axis.set_title(f"budget {budget:g} ms", fontsize=9, loc="left")
        axis.legend(fontsize=7, ncol=2, loc="upper left")
    axes[-1, 0].set_xlabel("frame; the machine is loaded in the middle third")
    figure.tight_layout()
    figure.savefig(PICTURE, dpi=90)
    print(PICTURE)


def main():
    options = program.read_options(__doc__, [], 0, more=("budgets", "frames", "busy"))
    budgets = [float(budget) for budget in (options.budgets or "8,16,33").split(",")]
    load = Load(int(options.busy or multiprocessing.cpu_count()))
    scene = moving_scene(options.work)
    lines = ["| budget | load | within | switches | median | most |", "| ---: | --- | ---: | ---: | ---: | ---: |"]
    runs, loads = [], [os.getloadavg()[0]]
    for budget in budgets:
        quiet, seconds = run(options, scene, budget)
        loaded, _ = run(options, scene, budget, seconds, load)
        for name, report in (("none", quiet), ("a third of the time", loaded)):
            within, switches, median, most = figures_of(report, budget)
            lines.append(f"| {budget:g} ms | {name} | {100 * within:.0f} % | {switches} | {median:.1f} ms | {most:.1f} ms |")
        runs.append((budget, loaded))
        loads.append(os.getloadavg()[0])
    draw(runs)
    lines += ["", f"Measured on {runs[0][1]['device']}, {runs[0][1]['compute_units']} cores, at a load average of {min(loads):.1f} to {max(loads):.1f}, "
                  f"{len(runs[0][1]['frame_ms'])} frames at {options.size}; the first two, which make what later ones have, are not counted."]
    program.write_between(PAGE, BEGIN, END, lines)


if __name__ == "__main__":
    main()
