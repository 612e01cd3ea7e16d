"""Writes docs/techniques/cone_tracing_figures.md from what cone_tracing.py has measured."""
from cone_tracing_errors import BRIGHTER, CASCADES, LIMIT, LIMIT_CONES, LIMIT_MORE, LIMIT_SIZES, PICTURE, PICTURED, SETTINGS, SIZE
from program import ROOT

PAGE = ROOT / "docs/techniques/cone_tracing_figures.md"
GROUPS = {"voxelise": ("voxel_grid.",), "inject": ("voxel_light.clear", "voxel_light.inject"), "resolve": ("voxel_light.settle", "voxel_light.resolve"),
          "filter": ("voxel_mips.",), "trace": ("cone_gather.counts", "cone_gather.trace"), "from pixel to pixel": ("cone_gather.filter", "joint_bilateral.")}
VOXELS = list(GROUPS)[:4]
KINDS = {"first": "a first frame", "rest": "at rest", "light": "a light moves", "object": "an object moves"}
RATE = 720e6  # samples of eight gathers each that two cores take in a second
AIMS = {"interleaved": 18, "half": 26}  # ms, of nine cones through 128^3
BRICK, STORED, SURFACES, SIDES = 512, 736, 7, 6  # voxels of a brick, with its apron; words of a voxel's surfaces, of its light
SHARE = {"interleaved": 1 / 9, "full": 1, "half": 1 / 4, "quarter": 1 / 16}


def write(bench, timed):
    """timed: the names of all rows of times; a scene that lacks some is left out."""
    found = {part: bench.kept(part) for part in ("times", "errors", "cascades", "limit", "format", "pictures")}
    lacking = {scene for scene in scenes_of(timed) for name in timed if scene in name.split() and name not in found["times"]}
    found["times"] = {name: row for name, row in found["times"].items() if not lacking & set(name.split())}
    if not scenes_of(found["times"]):
        found["times"] = {}
    lines = ["<!-- Made by docs/figures/cone_tracing.py; do not edit. -->", "", "# cone_tracing: figures", "",
             "What the technique's passes take, what its errors are, and what they come from. What they mean stands in [cone_tracing](cone_tracing.md).", ""]
    for part, make in (("times", times), ("errors", errors), ("pictures", pictures), ("limit", limit), ("format", words)):
        lines += make(bench, found) if found[part] else [f"<!-- part {part}: not measured, or not to its end -->", ""]
    PAGE.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print(PAGE)


def spent(row, group):
    return sum(ms for name, ms in row["passes"].items() if name.startswith(GROUPS[group]))


def table(head, rows, left=1):
    rows = [row for row in rows if any(row[left:])]
    return ["| " + " | ".join(head) + " |", "| " + " | ".join(["---"] * left + ["---:"] * (len(head) - left)) + " |",
            *("| " + " | ".join(row) + " |" for row in rows), ""]


def ms(value):
    return f"{value:.1f}" if value < 10 else f"{value:.0f}"


def times(bench, found):
    rows = found["times"]
    device = next(row for row in rows.values() if "passes" in row)["device"]
    loads = [row["load"] for row in rows.values() if "load" in row]
    lines = ["## Time", "", f"{device}; {bench.options.size}, RSM of 512 x 512, defaults else; milliseconds of the device, medians of 7 frames at rest and of "
             f"5 in which something moves. Load average {min(loads):.1f} to {max(loads):.1f}. *Resolve*: sums compared, words of bricks whose light is another; "
             "*filter*: tables, aprons and larger voxels.", ""]
    return lines + traces(bench, rows) + voxels(rows) + frames(rows) + floors(rows) + memory(rows)


def floor_of(bench, rows, scene, size, mode, resolution):
    of = rows[f"samples {scene}"]
    width, height = (int(x) for x in bench.options.size.split("x"))
    return 1e3 * of["words"][str(size)][mode] * of["surfaces"] * width * height * SHARE[resolution] / RATE


def traces(bench, rows):
    lines = ["### Cones: nine, 128 voxels a side", "", f"Trace and what follows it (filter of interleaved pixels, up-sampling); in brackets the trace's floor, every word "
             f"that cones read until they leave the grid at {RATE / 1e6:.0f} million a second (eight gathers each). Cones that end at a wall before, and cells without "
             "a brick, read less.", ""]
    scenes = scenes_of(rows)
    modes = ["isotropic", "anisotropic", "sh2"]
    cells = []
    for scene in scenes:
        for resolution in SHARE:
            line = [scene, f"`{resolution}`"]
            for mode in modes:
                row = rows.get(f"{scene} rest size=128 mode={mode} resolution={resolution} cones=9")
                line.append(f"{ms(spent(row, 'trace'))} + {ms(spent(row, 'from pixel to pixel'))} ({ms(floor_of(bench, rows, scene, 128, mode, resolution))})" if row else "")
            cells.append(line)
    lines += table(["scene", "resolution", *(f"`{mode}`" for mode in modes)], cells, 2)
    for resolution, aim in AIMS.items():
        for mode in ("isotropic", "anisotropic"):
            each = [rows[f"{scene} rest size=128 mode={mode} resolution={resolution} cones=9"] for scene in scenes]
            sums = [spent(row, "trace") + spent(row, "from pixel to pixel") for row in each]
            verdict = ", ".join(f"{scene} {total:.1f} ({'met' if total < aim else 'missed'})" for scene, total in zip(scenes, sums))
            lines.append(f"- Aim of `{resolution}`, `{mode}`: below {aim} ms with the filter. {verdict}.")
    return [*lines, ""]


def scenes_of(rows):
    return list(dict.fromkeys(name.split()[0] for name in rows if " rest " in name))


def sizes_of(rows):
    return list(dict.fromkeys(name.split("size=")[1] for name in rows if " first " in name and "sparse" not in name))


def voxels(rows):
    """Sparse beside dense, where everything is made and where the light alone is."""
    lines = ["### Voxels", "", "Only bricks that hold something (all bricks, `sparse=off`):", ""]
    for kind in ("first", "light"):
        cells = []
        for scene in scenes_of(rows):
            for size in sizes_of(rows):
                one, dense = rows[f"{scene} {kind} size={size}"], rows.get(f"{scene} {kind} size={size} sparse=off")

                def beside(groups, one=one, dense=dense):
                    both = [ms(sum(spent(row, g) for g in groups)) for row in (one, dense) if row]
                    return both[0] if dense is None else f"{both[0]} ({both[1]})"
                cells.append([scene, size, *(beside([g]) for g in VOXELS), f"**{beside(VOXELS)}**"])
        lines += table([KINDS[kind], "size", *VOXELS, "together"], cells, 1)
    return lines


def frames(rows):
    cells = []
    for scene in scenes_of(rows):
        for size in sizes_of(rows):
            for kind in KINDS:
                row = rows[f"{scene} {kind} size={size}"]
                cells.append([scene, size, KINDS[kind], *(ms(spent(row, g)) for g in GROUPS), f"**{ms(row['total'])}**"])
    return ["### Whole frames", "", "`anisotropic`, `interleaved`. The lamp of the Cornell box goes aside, its short block moves; Sponza's sun turns, a crate of 12 triangles "
            "moves among 246,638.", "", *table(["scene", "size", "frame", *GROUPS, "whole frame"], cells, 3)]


def floors(rows):
    """Bytes that a pass cannot do without over the device's bandwidth."""
    bandwidth = rows["probe"]["bandwidth_GBps"] * 1e6  # bytes a millisecond
    cells = []
    for scene in scenes_of(rows):
        for size in sizes_of(rows):
            row = rows[f"{scene} first size={size}"]
            of, rest = row["counts"], rows[f"{scene} rest size={size}"]["counts"]
            surfaces = rest["voxel_bricks"] * BRICK * SURFACES * 4
            words, larger = rest["lit_bricks"] * STORED * SIDES * 4, rest["coarser_bricks"] * STORED * SIDES * 4
            bytes_ = {"voxelise": 2 * 36 * of["triangles"] + surfaces, "inject": 36 * of["rsm_texels"],
                      "resolve": surfaces + rest["voxel_bricks"] * BRICK * 24 + words, "filter": words + larger}
            cells.append([scene, size, *(f"{b / bandwidth:.2f} ({ms(spent(row, g))})" for g, b in bytes_.items())])
    return ["### Floors", "", f"Bytes over {rows['probe']['bandwidth_GBps']:.0f} GB/s, beside what a first frame takes: triangles twice and surfaces once; texels once; surfaces and "
            "sums read, words written; words read, larger ones written.", "", *table(["scene", "size", *VOXELS], cells, 1)]


def memory(rows):
    def mib(count):
        return f"{count / 2 ** 20:.1f}"
    cells = []
    for scene in scenes_of(rows):
        for size in sizes_of(rows):
            of, bricks = rows[f"{scene} rest size={size}"], (int(size) // 8) ** 3
            counts = of["counts"]
            cells.append([scene, size, f"{counts['voxel_bricks']} of {bricks}", f"{counts['lit_bricks']}", f"{counts['coarser_bricks']}",
                          mib(counts["voxel_bricks"] * BRICK * SURFACES * 4), mib(counts["voxel_bricks"] * BRICK * 3 * (8 + 4)),
                          mib(counts["lit_bricks"] * STORED * SIDES * 4), mib(counts["coarser_bricks"] * STORED * SIDES * 4),
                          f"**{mib(of['bytes'])}**", *(mib(row["bytes"]) if row else "" for row in [rows.get(f"{scene} first size={size} sparse=off")])])
    return ["### Memory", "", "MiB. Of the bricks that hold something: surfaces, light (sums of 64 bits and what they were), words, larger words. *All*: what the technique has on the device at rest, with "
            "room for more bricks, RSMs and the view's own images; *dense*: the same with `sparse=off`.", "",
            *table(["scene", "size", "bricks with surfaces", "with words", "larger", "surfaces", "light", "words", "larger words", "all", "dense"], cells, 1)]


def cell(row):
    return f"{row['relMSE']:.3g} / {row['nrmse']:.2f} / {100 * row['bias']:+.0f} %" if row else ""


def errors(bench, found):
    rows = found["errors"]
    scenes = list(dict.fromkeys(name.split()[0] for name in rows))
    noise = ", ".join(f"{scene} {rows[name]['reference_noise']:.2g}" for scene in scenes for name in list(rows) if name.startswith(scene + " size=64"))
    noise = ", ".join(dict.fromkeys(noise.split(", ")))
    lines = ["## Error", "", f"relMSE / nRMSE / bias against one bounce by path tracing, {SIZE}; relMSE of the truths' own noise: {noise}. Defaults else: nine cones, `anisotropic`, "
             "`interleaved`, `normal_aware`.", ""]
    cells = [[f"`{' '.join(settings)}`", *(cell(rows.get(' '.join([scene, *settings]))) for scene in scenes)] for settings in SETTINGS]
    lines += table(["", *scenes], cells)
    if len(rows) < len(SETTINGS) * len(scenes):
        lines += [f"<!-- {len(rows)} of {len(SETTINGS) * len(scenes)} measured -->", ""]
    if found["cascades"]:
        counts = sorted({count for _, count in CASCADES})
        cells = [[f"`size={size}`", *(cell(found["cascades"].get(f"size={size} cascades={count}")) for count in counts)] for size in sorted({s for s, _ in CASCADES})]
        lines += ["Cascades around the eye, sponza_crytek:", "", *table(["", *(f"`cascades={count}`" for count in counts)], cells)]
    return lines


def pictures(_bench, found):
    lines = ["## Pictures", "", f"Truth | `{' '.join(PICTURE)}` | what it is off by on the screen's scale: red too bright, blue too dark, full at a quarter of its range.", ""]
    for scene in PICTURED:
        if scene in found["pictures"]:
            lines += [f"![{scene}](../images/{found['pictures'][scene]})", ""]
    return lines


def limit(_bench, found):
    rows = found["limit"]
    lines = ["## The limit", "", f"Cornell box, `{' '.join(LIMIT)}`; relMSE / nRMSE / bias.", "",
             *table(["", *(f"{cones} cones" for cones in LIMIT_CONES)],
                    [[f"`size={size}`", *(cell(rows.get(f"size={size} cones={cones}")) for cones in LIMIT_CONES)] for size in LIMIT_SIZES])]
    lines += ["One thing at a time:", "", *table(["", "relMSE / nRMSE / bias"], [[f"`{' '.join(more)}`", cell(rows.get(" ".join(more)))] for more in LIMIT_MORE])]
    finest = rows.get(f"size={LIMIT_SIZES[-1]} cones={LIMIT_CONES[-1]}")
    between = [[f"{cones} cones instead of {LIMIT_CONES[-1]}, at {LIMIT_SIZES[-1]}", f"cones {cones}"] for cones in LIMIT_CONES[:-1]]
    between += [[f"{size} voxels a side instead of {LIMIT_SIZES[-1]}, {LIMIT_CONES[-1]} cones", f"size {size}"] for size in LIMIT_SIZES[:-1]]
    cells = [[what, f"{rows[name]['nrmse']:.3f}", f"{100 * rows[name]['bias']:+.1f} %"] for what, name in between if name in rows]
    if finest:
        cells.append(["the finest of them against the truth", f"{finest['nrmse']:.3f}", f"{100 * finest['bias']:+.1f} %"])
    return [*lines, "What one picture differs by from another:", "", *table(["", "nRMSE", "bias"], cells), *split(rows)]


def split(rows):
    """Steps of `lightwell split` for this technique: each approximation refined, one after the other, and what of the squared error goes with it."""
    steps = {"nine cones (more cones)": (128, 9), "voxels (half as large)": (128, 256), "what stays": (256, 256)}
    found = [rows.get(f"size={size} cones={cones}") for size, cones in steps.values()]
    if not all(found):
        return []
    squares = [row["nrmse"] ** 2 for row in found] + [0.0]
    shares = ", ".join(f"{name} {100 * (a - b) / squares[0]:.0f} %" for name, a, b in zip(steps, squares, squares[1:]))
    return [f"**Where the error sits.** `lightwell split` passes over techniques without virtual lights; the same by this technique's own limits, of the squared error of "
            f"`size=128 cones=9`, one step after the other: {shares}. What stays is larger voxels' averages (narrow cones are in them, too, from some distance on), where cones begin, "
            f"surfaces moved to voxels' middles, and of the truth's own noise {100 * found[0]['reference_noise'] / found[-1]['relMSE']:.0f} % of the relMSE that is left.", ""]


def words(_bench, found):
    of, lines = found["format"], ["## Words of 32 bits", ""]
    if "test" in of:
        lines += table(["irradiance at 60 points from words, against floats (`voxel_light_test`)", "rms over mean", "worst over mean"],
                       [[{"even": "a room of one light", "contrast": "contrasts of 10^4"}[name], f"{100 * row['rms']:.3f} %", f"{100 * row['worst']:.3f} %"]
                        for name, row in of["test"].items()])
    if "cornell" in of:
        row = of["cornell"]
        lines += [f"The Cornell box at 128 voxels a side by lamps of {len(BRIGHTER)} brightnesses ({BRIGHTER[0]:g} to {BRIGHTER[-1]:g}), each picture over its lamp's: what differs is rounding. "
                  f"Pixels spread by {100 * row['rms']:.3f} % of the mean irradiance (root of the mean square; {100 * row['relative']:.2f} % of their own), pictures' means by {100 * row['mean']:.4f} % at "
                  "most.", ""]
    return lines
