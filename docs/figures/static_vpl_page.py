"""Tables, plots and pictures of static_vpl.py. Needs numpy, matplotlib and Pillow."""
import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "lightwell"  # the same file from the same figures
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402

import thesis_pictures  # noqa: E402
from program import ROOT  # noqa: E402
from static_vpl_flicker import INDICES  # noqa: E402
from static_vpl_flip import VARIANTS, mean  # noqa: E402
from static_vpl_weak import REACH  # noqa: E402

IMAGES = ROOT / "docs/images"
COLOURS = {"truth": "black", "static": "#0072B2", "phantom": "#009E73", "traced 1": "#D55E00", "traced 20": "#E69F00", "traced 200": "#CC79A7"}
WIDTH = 360   # of one picture


def save(figure, name):
    figure.tight_layout()
    figure.savefig(IMAGES / f"static_vpl_{name}.svg", metadata={"Date": None})
    plt.close(figure)
    return [f"![{name}](../images/static_vpl_{name}.svg)", ""]


def table(head, rows, left=1):
    return ["| " + " | ".join(head) + " |", "|" + " --- |" * left + " ---: |" * (len(head) - left), *("| " + " | ".join(map(str, r)) + " |" for r in rows), ""]


def door(found):
    angles = [int(a) for a in found]
    share = {key: [f[key] / found["90"][key] for f in found.values()] for key in ("sent", "ours", "traced", "truth")}
    figure, panels = plt.subplots(1, 2, figsize=(9, 3))
    for axes, scale in zip(panels, ("linear", "log")):
        for key, label, style in (("sent", "flux of the places", "o-"), ("ours", "light in the picture", "s--")):
            axes.plot(angles, share[key], style, color=COLOURS["static"], label=label, markersize=3)
        for key, label, style in (("traced", "flux that rays say", "o-"), ("truth", "light, path-traced", "s--")):  # 0 when shut
            axes.plot(angles[1:], share[key][1:], style, color="black", label=label, markersize=3)
        axes.set(yscale=scale, xlabel="the door's opening, degrees", ylabel="share of what comes at 90 degrees")
        axes.grid(alpha=0.3)
    panels[1].axhline(1e-3, color="grey", linewidth=0.8)
    panels[0].legend(fontsize=7)
    rises = all(b >= a for a, b in zip(share["sent"], share["sent"][1:]))
    rows = [[a, f"{f['sent']:.3g}", f"{s:.2g}", f["kept"], f"{t:.2g}", f"{o:.2g}", f"{p:.2g}"] for a, f, s, t, o, p in
            zip(angles, found.values(), share["sent"], share["traced"], share["ours"], share["truth"])]
    return [*save(figure, "door"), f"Before culling {share['sent'][0]:.2g} of the open door's flux when shut; it {'never falls' if rises else '**falls somewhere**'} "
            "as the door opens.", "",
            *table(["degrees", "flux of the places, W", "of that at 90", "kept after culling", "truth: flux", "light in the picture", "truth: light"], rows, 0)]


def road(found):
    figure, axes = plt.subplots(figsize=(9, 2.6))
    axes.plot(found["x"], found["side"], color="black", label="rays: lit share of the lorry's side")
    axes.plot(found["x"], found["place"], ":", color="grey", label="rays: at the place alone")
    axes.plot(found["x"], found["ours"], color=COLOURS["static"], label="soft spheres")
    axes.set(xlabel="the lorry's place, m", ylabel="share of the sun")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    ours, side, place = (numpy.array(found[key]) for key in ("ours", "side", "place"))
    return [*save(figure, "road"), f"Mean difference from the lit share of the side: {abs(ours - side).mean():.3f}, from one ray at the place: "
            f"{abs(ours - place).mean():.3f} (one ray from the share: {abs(place - side).mean():.3f}); correlation {numpy.corrcoef(ours, side)[0, 1]:.2f}. "
            f"Greatest step from one position to the next: {abs(numpy.diff(ours)).max():.2f}, of the share {abs(numpy.diff(side)).max():.2f}, "
            f"of one ray {abs(numpy.diff(place)).max():.2f}.", ""]


def flip(found, exrs):
    lines = []
    for scene, rows in found.items():
        pictures(exrs[scene], list(exrs[scene]), f"flip_{scene}")
        body = [[variant, f"{numpy.mean(r['vpls']):.0f}", *(f"{mean(r[b], key):{f}}" for b in ("one", "two") for key, f in
                (("flip", ".3f"), ("relMSE", ".2g"), ("bias", "+.0%")))] for variant, r in rows.items()]
        lines += [f"**{scene}**", "", f"![{scene}](../images/static_vpl_flip_{scene}.jpg)", "", "*" + " | ".join(exrs[scene]) + "*, one bounce, second frame", "",
                  *table(["what", "VPLs that light", "FLIP, one bounce", "relMSE", "bias", "FLIP, two bounces", "relMSE", "bias"], body)]
    figure, panels = plt.subplots(1, len(found), figsize=(9, 2.8), sharey=True, squeeze=False)
    for axes, (scene, rows) in zip(panels[0], found.items()):
        for i, (variant, r) in enumerate(rows.items()):
            axes.bar(i, mean(r["two"], "flip"), color=colour(variant), label=variant)
            axes.plot([i] * len(r["two"]), [e["flip"] for e in r["two"]], "k.", markersize=3)
        axes.set_xticks(range(len(rows)), [v.replace(" ", "\n") for v in rows], fontsize=6)
        axes.set_title(scene, fontsize=9)
        axes.grid(alpha=0.3, axis="y")
    panels[0][0].set_ylabel("FLIP, two bounces")
    return save(figure, "flip") + lines


def colour(variant):
    return next(c for name, c in reversed(list(COLOURS.items())) if variant.startswith(name))


def studs(found):
    figure, panels = plt.subplots(1, 2, figsize=(9, 3))
    for way, row in found.items():
        x = numpy.linspace(-REACH, REACH, len(row["red"]))
        panels[0].plot(x, row["red"], ".-", color=colour(way), label=way)
        if row["degrees"]:
            panels[1].plot(x, row["degrees"], ".-", color=colour(way), label=way)
    panels[0].set(xlabel="the beam's axis, m from the seam", ylabel="R / (R + G) opposite")
    panels[1].set(xlabel="the beam's axis, m from the seam", ylabel="mean normal off the wall's, degrees")
    for axes in panels:
        axes.grid(alpha=0.3)
    panels[0].legend(fontsize=7)
    truth = numpy.array(found["truth"]["red"])
    light = numpy.array(found["truth"]["light"])
    rows = [[way, f"{abs(numpy.array(r['red']) - truth).mean():.3f}", f"{abs(numpy.diff(r['red'])).max():.2f}", f"{steps(r['light'], light):.2f}",
             f"{max(r['degrees']):.0f}" if r["degrees"] else "", f"{abs(numpy.diff(r['degrees'])).max():.0f}" if r["degrees"] else ""] for way, r in found.items()]
    return [*save(figure, "studs"), *table(["what", "mean error of R / (R + G)", "its greatest step", "greatest step of the light", "farthest off the wall's normal, degrees",
                                           "greatest step, degrees"], rows)]


def steps(light, truth):
    """Of the light over the truth's mean, from one position to the next."""
    return abs(numpy.diff(light)).max() / truth.mean()


def block(found, exrs):
    shown = ["truth", "static", "phantom", "phantom, second bounce"]
    pictures(exrs, shown, "block")
    rows = [[way, f"{f['behind']:.2f}", f"{f['before']:.2f}", f"{f['flip']:.3f}"] for way, f in found.items() if way != "truth"]
    return ["![Light on a block](../images/static_vpl_block.jpg)", "", "*" + " | ".join(shown) + "*; below what they are off by, red where too bright and blue where too "
            "dark, full at a quarter of the screen's range.", "", *table(["what", "light behind the phantom's plane, of the truth's", "before it", "FLIP"], rows)]


def pictures(exrs, shown, name):
    """A row of pictures at the truth's exposure, and one of their errors."""
    from PIL import Image

    exposure = thesis_pictures.exposure_of(thesis_pictures.composite(exrs["truth"]))
    screens = [thesis_pictures.encode(exposure * thesis_pictures.composite(exrs[way])) for way in shown]
    errors = [numpy.full_like(screens[0], 0.5), *(thesis_pictures.signed(s - screens[0]) for s in screens[1:])]
    both = numpy.vstack([numpy.hstack(screens), numpy.hstack(errors)])
    picture = Image.fromarray((255 * both.clip(0, 1) + 0.5).astype(numpy.uint8))
    height = round(2 * WIDTH * screens[0].shape[0] / screens[0].shape[1])
    picture.resize((len(shown) * WIDTH, height), Image.Resampling.LANCZOS).save(IMAGES / f"static_vpl_{name}.jpg", quality=85)


def first(found, exrs):
    ways = ["places", "places and spheres", "traced, no shadows"]
    lines = []
    for scene in found:
        pictures(exrs[scene], ["truth", *ways], f"first_{scene}")
        lines += [f"![{scene}](../images/static_vpl_first_{scene}.jpg)", ""]
    rows = [[scene, f["vpls"], f["spheres"], *(f"{f[way][key]:{fmt}}" for way in ways for key, fmt in (("relMSE", ".2g"), ("bias", "+.0%"), ("flip", ".3f")))]
            for scene, f in found.items()]
    return [*lines, "*Truth | " + " | ".join(ways) + "*; below what they are off by.", "",
            *table(["scene", "places", "spheres", *(f"{key}, {way}" for way in ways for key in ("relMSE", "bias", "FLIP"))], rows)]


def flicker(found):
    figure, panels = plt.subplots(2, len(found), figsize=(9, 4.4), sharey="row", squeeze=False)
    lines = []
    for column, (sequence, rows) in enumerate(found.items()):
        names = [v for v in VARIANTS if v in rows]
        for axes, index in zip(panels[:, column], ("flicker", "spike")):
            axes.bar(range(len(names)), [rows[n][index][0] for n in names], color=[colour(n) for n in names])
            axes.axhline(rows[names[0]][index][1], color="black", linewidth=0.8, linestyle=":")  # the floor
            axes.set_xticks(range(len(names)), [n.replace(" ", "\n") for n in names], fontsize=5)
            axes.set_ylabel(index if column == 0 else "")
            axes.grid(alpha=0.3, axis="y")
        panels[0][column].set_title(sequence, fontsize=8)
        lines += [[f"`{sequence}`", n, *(f"{rows[n][i][0]:.2g} *{rows[n][i][1]:.2g}*" for i in INDICES), f"{rows[n]['relMSE']:.2g}", f"{rows[n]['bias']:+.0%}"]
                  for n in names]
    panels[1][0].set_yscale("log")
    return [*save(figure, "flicker"), *table(["sequence", "what", *INDICES, "relMSE", "bias"], lines, 2)]


def stereo(found):
    rows = [[name, f"{found[key]:.0f}"] for name, key in (("one update, one eye", "one"), ("one update, two eyes", "two"), ("two updates, two eyes", "two_updates"))]
    return table(["frame of 200 places, 640x360 an eye", "microseconds"], rows)
