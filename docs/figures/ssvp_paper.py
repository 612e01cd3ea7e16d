#!/usr/bin/env python3
"""Writes docs/techniques/ssvp_paper.md and its plot: what Aranha et al. 2020 measured, measured here.

    docs/figures/ssvp_paper.py [--lightwell build/release/bin/lightwell] [--work build/figures] [--size 1280x720]
                               [--scenes cornell sibenik sponza_dabrovic sponza_crytek living_room level_zdm2]

Times at --size and at 1920x1080, of frames at rest with nothing else running; drawing every map is read from first frames. Differences
need no quiet machine. Scenes other than the shipped ones are looked for in LIGHTWELL_SCENES.
"""
import json
import os
import statistics

from program import ROOT, caller, read_options

CLUSTERS = [4, 8, 16, 32]
LARGE = "1920x1080"
# Column: the passes that begin with one of these. The paper's Table I: miscellaneous, paraboloid, shading.
GROUPS = {"RSM, VPLs, clusters": ("rsm_input", "vpl_sampling", "kmeans", "second_bounce", "clustered_gather.sort", "clustered_gather.order"),
          "shading": ("interleaved_gather", "clustered_gather.gather", "joint_bilateral", "gbuffer_input", "output")}
MAPS = ("paraboloid_map",)
SECOND_VPLS = [8, 16, 32, 64, 128]
BEGIN, END = "<!-- begin: figures -->", "<!-- end: figures -->"


def main():
    options = read_options(__doc__, ["cornell", "sibenik", "sponza_dabrovic", "sponza_crytek", "living_room", "level_zdm2"], 0)
    call = caller(options.lightwell)

    def render(scene, settings, size=options.size, frames=1, warmup=0, name="paper"):
        # The paper shadows the first bounce alone.
        sets = [part for setting in ["shadowed_bounces=1", *settings] for part in ("--set", setting)]
        return json.loads(call("render", scene, "--technique", "ssvp", *sets, "--size", size, "--frames", frames, "--warmup", warmup,
                               "--out", options.work / f"{name}.exr", "--json"))

    rendered = set()

    def difference(scene, settings, reference):
        name = "_".join(["paper", scene, *reference]).replace("=", "")
        if name not in rendered:
            render(scene, reference, name=name)
        rendered.add(name)
        render(scene, settings)
        return json.loads(call("compare", options.work / "paper.exr", options.work / f"{name}.exr", "--json"))

    totals = {}
    lines = [f"Load average {os.getloadavg()[0]:.1f} at the start.", ""] + time_table(options, render, totals) + [""]
    plot(totals, ROOT / "docs/images/ssvp_paper.svg")
    lines += ["![Milliseconds against clusters](../images/ssvp_paper.svg)", ""]
    lines += cluster_table(options.scenes, difference) + [""] + second_table(options.scenes, difference) + [""]
    lines += direction_table(options.scenes, difference)
    page = ROOT / "docs/techniques/ssvp_paper.md"
    before, rest = page.read_text(encoding="utf-8").split(BEGIN)
    page.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + rest.split(END)[1], encoding="utf-8")
    print(page)


def spent(report, names):
    return sum(p["ms"] for p in report["passes"] if p["name"].startswith(names))


def time_table(options, render, totals):
    lines = ["Milliseconds. *maps*: drawing all of them once, in a first frame; 0 at rest.", "",
             "| scene | clusters | maps | " + " | ".join(GROUPS) + f" | frame {options.size} | shading, {LARGE} | frame {LARGE} |",
             "| --- | ---: | ---: | " + " | ".join(["---:"] * len(GROUPS)) + " | ---: | ---: | ---: |"]
    for scene in options.scenes:
        for clusters in CLUSTERS:
            settings = [f"clusters={clusters}", f"second_vpls={256 // clusters}"]
            maps = statistics.median(spent(render(scene, settings), MAPS) for _ in range(3))
            rest = render(scene, settings, frames=21, warmup=4)
            large = render(scene, settings, size=LARGE, frames=11, warmup=4)
            totals.setdefault(scene, []).append((clusters, rest["total_ms"], maps))
            cells = [f"{spent(rest, names):.1f}" for names in GROUPS.values()]
            lines.append(f"| {scene} | {clusters} | {maps:.1f} | " + " | ".join(cells) +
                         f" | **{rest['total_ms']:.1f}** | {spent(large, GROUPS['shading']):.1f} | **{large['total_ms']:.1f}** |")
    return lines


def plot(totals, path):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (still, moving) = plt.subplots(1, 2, figsize=(9, 3.6), sharex=True)
    for scene, rows in totals.items():
        clusters = [row[0] for row in rows]
        still.plot(clusters, [row[1] for row in rows], marker="o", label=scene)
        moving.plot(clusters, [row[1] + row[2] for row in rows], marker="o", label=scene)
    for axes, title in ((still, "frames at rest"), (moving, "every map drawn anew")):
        axes.set(title=title, xlabel="clusters", ylabel="ms", xticks=CLUSTERS)
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
    still.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def table(title, columns, scenes, cell):
    lines = [title, "", "| scene | " + " | ".join(str(c) for c in columns) + " |", "| --- | " + " | ".join(["---:"] * len(columns)) + " |"]
    return lines + [f"| {scene} | " + " | ".join(cell(scene, c) for c in columns) + " |" for scene in scenes]


def cluster_table(scenes, difference):
    def cell(scene, clusters):
        d = difference(scene, [f"clusters={clusters}", "bounces=1"], ["clusters=32", "bounces=1"])
        return f"{d['nrmse']:.3f} / {d['flip']:.4f}"
    return table("Difference from the picture of 32 clusters, one bounce: nRMSE / FLIP.", CLUSTERS[:-1], scenes, cell)


def second_table(scenes, difference):
    def cell(scene, count):
        d = difference(scene, [f"second_vpls={count}"], ["second_vpls=1024"])
        return f"{d['nrmse']:.3f} / {d['flip']:.4f}"
    return table("Second-bounce VPLs for each of 8 clusters: difference from 1,024 of them, both bounces together: nRMSE / FLIP.", SECOND_VPLS, scenes, cell)


def direction_table(scenes, difference):
    def cell(scene, directions):
        d = difference(scene, [f"directions={directions}"], ["second_vpls=1024"])
        return f"{d['nrmse']:.3f} / {d['bias'] * 100:+.1f} %"
    return table("Where 32 second-bounce VPLs for each cluster are drawn: difference from 1,024 by cosine: nRMSE / bias.",
                 ["square", "disc", "cosine"], scenes, cell)


if __name__ == "__main__":
    main()
