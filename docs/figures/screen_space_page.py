"""The page and the pictures of screen_space.py. Needs numpy and matplotlib."""
import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.hashsalt"] = "lightwell"  # the same file from the same figures
import matplotlib.pyplot as plt  # noqa: E402
import numpy  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: E402

from exr_planes import read_planes  # noqa: E402

COLOURS = {"quarter": "#0072B2", "half": "#D55E00", "full": "#009E73"}
MARKERS = {"quarter": "o", "half": "s", "full": "^"}
STEPS = {"pyramid": ("mip_pyramid",), "deal": ("screen_gather.deal",), "gather": ("screen_gather.level",),
         "filter, add": ("screen_combine.filter", "screen_combine.add"), "finish": ("screen_combine.finish",)}
KINDS = {"screen, no shadows": "on screen, no shadows", "screen": "on screen", "all": "all light"}


def mean(path):
    return float(read_planes(path).mean())


def largest(path):
    return float(read_planes(path).max())


def display(light, white):
    """Reinhard and sRGB, `white` being where the half of the scale lies."""
    scaled = numpy.clip(light, 0.0, None) / white
    scaled = scaled / (1.0 + scaled)
    return numpy.where(scaled <= 0.0031308, 12.92 * scaled, 1.055 * scaled ** (1 / 2.4) - 0.055)


def save_panels(panels, columns, path):
    """`panels` of (title, picture in [0,1])."""
    rows = -(-len(panels) // columns)
    height, width, _ = panels[0][1].shape
    figure, axes = plt.subplots(rows, columns, figsize=(3.6 * columns, 3.6 * height / width * rows + 0.3 * rows), squeeze=False)
    for axis in axes.flat:
        axis.axis("off")
    for axis, (title, picture) in zip(axes.flat, panels):
        axis.imshow(picture, interpolation="antialiased")
        axis.set_title(title, fontsize=9)
    figure.tight_layout(pad=0.3)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_levels(pictures, path):
    """Direct light, what each level adds, all together; returns each level's share of the mean irradiance."""
    sums = [read_planes(p) for p in pictures]
    levels = [sums[0]] + [after - before for before, after in zip(sums, sums[1:])]
    direct = read_planes(pictures[0], ("direct.R", "direct.G", "direct.B"))
    white = 2.0 * sums[-1].mean()
    panels = [("direct light", display(direct, 2.0 * direct.mean()))]
    panels += [(f"level {n}", display(level, white)) for n, level in enumerate(levels, 1)]
    panels.append(("all levels", display(sums[-1], white)))
    save_panels(panels, 3, path)
    return [float(level.mean() / sums[-1].mean()) for level in levels]


def draw_slices(pictures, truths, share, path):
    figure, axis = plt.subplots(figsize=(7.5, 3.4))
    lines = [("unbounded (eq. 3)", pictures["unbounded"], "#D55E00", 0.7), ("bounded (eq. 4)", pictures["bounded"], "#009E73", 1.3),
             ("truth, on screen, no shadows", truths["screen, no shadows"], "#000000", 0.6),
             ("truth, on screen", truths["screen"], "#0072B2", 0.6)]
    top = 0.0
    for name, exr, colour, width in lines:
        planes = read_planes(exr)
        values = planes[int(share * planes.shape[0])].mean(axis=1)
        axis.plot(values, color=colour, linewidth=width, label=name, zorder=1 if "eq. 3" in name else 2)
        top = max(top, numpy.percentile(values, 99.5)) if "eq. 3" not in name else top
    axis.set(xlabel="column", ylabel="irradiance, mean of RGB (W/m$^2$)", ylim=(0.0, 1.6 * top))
    axis.grid(alpha=0.25)
    axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def draw_cameras(pictures, path):
    planes = [read_planes(p) for p in pictures]
    white = 2.0 * planes[-1].mean()
    titles = ("one camera", "with the other camera", "truth: what both show", "truth: all light")
    save_panels([(title, display(p, white)) for title, p in zip(titles, planes)], 2, path)


def draw_starts(found, kind, starts, path):
    """Error against time, start by start."""
    scenes = list(found["starts"])
    figure, axes = plt.subplots(1, len(scenes), figsize=(4.6 * len(scenes), 3.6), squeeze=False)
    for axis, scene in zip(axes.flat, scenes):
        for start in starts:
            points = curve(found, scene, (start, starts[start]), kind)
            axis.plot([t for t, _, _ in points], [e for _, e, _ in points], color=COLOURS[start], marker=MARKERS[start], label=f"start={start}")
            for t, e, n in points:
                axis.annotate(str(n), (t, e), xytext=(4, 3), textcoords="offset points", fontsize=6, color=COLOURS[start])
        axis.set(title=scene, xlabel="ms", ylabel=f"relMSE, {KINDS[kind]}", xscale="log", yscale="log")
        for one in (axis.xaxis, axis.yaxis):  # plain numbers
            one.set_major_locator(LogLocator(subs=(1.0, 1.5, 2.0, 3.0, 5.0, 7.0)))
            one.set_major_formatter(StrMethodFormatter("{x:g}"))
            one.set_minor_formatter(NullFormatter())
        axis.margins(0.08)
        axis.grid(alpha=0.25)
        axis.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def curve(found, scene, start, kind):
    """(ms, relMSE, samples) of the settings with this start and levels that were timed."""
    timed = {tuple(m["setting"]): m["total"] for m in found["times"]["measured"]}
    return sorted((timed[(*start, int(n))], errors[kind]["relMSE"], int(n)) for n, errors in found["starts"][scene][start[0]].items()
                  if (*start, int(n)) in timed)


def milliseconds(measured, names):
    return sum(ms for name, ms in measured["passes"].items() if name.startswith(names))


def of_setting(found, setting):
    return next(m for m in found["times"]["measured"] if m["setting"] == list(setting[:3]))


def write(found, root, settings, starts, slice_settings, slice_size):
    draw_starts(found, "screen, no shadows", starts, root / "docs/images/screen_space_starts.svg")
    lines = head(found) + levels_text(found) + slices_text(found, slice_settings, slice_size) + settings_text(found, settings) + gather_text(found, settings)
    lines += starts_text(found, starts) + cameras_text(found)
    page = root / "docs/techniques/screen_space_figures.md"
    page.write_text("\n".join(lines).rstrip() + "\n", encoding="utf-8")
    print(page)


def head(found):
    times = found["times"]
    paths = ", ".join(f"{spp} per pixel in {scene}" for scene, spp in found["spp"].items())
    return ["<!-- Made by docs/figures/screen_space.py; do not edit. -->", "", "# screen_space: the figures of its paper", "",
            "What C. Soler et al. show in figures 4 to 9 of *Hierarchical Screen-Space Indirect Illumination for Video Games* (2009), measured "
            f"here. Times: {times['device']}; {times['scene']}, {times['size']}; medians of 5 frames without history, of three rounds the quickest; load average "
            f"{times['load'][0]:.1f} before, {times['load'][1]:.1f} after. Errors at {found['size']}, one bounce, against three truths (paths: {paths}): light from "
            "*all* surfaces; from those that the picture shows (*on screen*: the most that a technique of the picture can know); and the same "
            "with *no shadows* between what sends and what receives, which is what this technique estimates. "
            "`lightwell reference --on-screen [--unshadowed]` makes them.", ""]


def levels_text(found):
    lines = ["## Figure 4: what each level brings", ""]
    for scene, of_levels in found["levels"].items():
        shares = ", ".join(f"{100 * s:.0f} %" for s in of_levels)
        lines += [f"![{scene}: direct light, levels 1 to 4, all of them](../images/screen_space_levels_{scene}.png)",
                  f"{scene}, defaults. Irradiance that each level adds after filter and up-sampling, at one exposure. Shares of "
                  f"the mean: {shares}.", ""]
    return lines


def error_cells(errors, kinds=KINDS):
    return " | ".join(f"{errors[k]['relMSE']:.3g} | {100 * errors[k]['bias']:+.0f} %" for k in kinds)


def error_heads(kinds=KINDS):
    return " | ".join(f"relMSE, {KINDS[k]} | bias" for k in kinds)


def slices_text(found, settings, size):
    lines = ["## Figure 5: the bounded form factor", "", f"{size}, `{' '.join(settings)}`, traced direct light, no history; one row of the picture.", ""]
    kinds = [kind for kind in KINDS if kind != "all"]
    rows = ["| scene | form | " + error_heads(kinds) + " | largest pixel over the truth's (no shadows) |",
            "| --- | --- |" + " ---: |" * (2 * len(kinds) + 1)]
    for scene, forms in found["slices"].items():
        lines += [f"![{scene}: irradiance along a row](../images/screen_space_slices_{scene}.svg)", ""]
        rows += [f"| {scene} | {r['form']} | {error_cells(r['errors'], kinds)} | {r['largest']:.1f} |" for r in forms]
    texts = []
    for scene, (bounded, unbounded) in found["slices"].items():
        before, after = (100 * form["errors"][kinds[0]]["bias"] for form in (unbounded, bounded))
        texts.append(f"{scene}: the bound takes the largest pixel from {unbounded['largest']:.1f} to {bounded['largest']:.1f} times the truth's, and the mean "
                     f"from {before:+.0f} to {after:+.0f} %.")
    return lines + rows + ["", *texts, ""]


def settings_text(found, settings):
    lines = ["## Figure 6: the paper's settings", "", "Milliseconds. The paper's totals: GTX 260 / 8800 GTS.", "",
             "| start, levels, samples | " + " | ".join(STEPS) + " | total | paper's total |", "| --- |" + " ---: |" * (len(STEPS) + 2)]
    for s in settings:
        measured = of_setting(found, s)
        cells = " | ".join(f"{milliseconds(measured, names):.2f}" for names in STEPS.values())
        lines.append(f"| {s[0]}, {s[1]}, {s[2]} | {cells} | {measured['total']:.2f} | {s[3]} / {s[4]} |")
    lines += ["", "| scene | start, levels, samples | " + error_heads() + " |", "| --- | --- |" + " ---: |" * 6]
    for scene, of_settings in found["settings"].items():
        for s, errors in zip(settings, of_settings):
            lines.append(f"| {scene} | {s[0]}, {s[1]}, {s[2]} | {error_cells(errors)} |")
    noises = [e["reference_noise"] for of_settings in found["settings"].values() for errors in of_settings for e in errors.values()
              if e["reference_noise"] is not None]
    return lines + (["", f"The truths' own noise (relMSE), which is in every relMSE, is {min(noises):.2g} to {max(noises):.2g}."] if noises else []) + [""]


def gather_text(found, settings):
    lines = ["## Figure 7: the gather by level", "", "The paper, half, 64 samples: more than 70 % in the first level, a fifth costs about 1 % of the whole.", "",
             "| start, levels, samples | " + " | ".join(f"level {n}" for n in range(1, 6)) + " | first | fifth |", "| --- |" + " ---: |" * 7]
    for s in settings:
        measured = of_setting(found, s)
        ms = [milliseconds(measured, (f"screen_gather.level{n}",)) for n in range(1, s[1] + 1)]
        fifth = f"{100 * ms[4] / sum(ms):.1f} %" if len(ms) > 4 else ""
        lines.append(f"| {s[0]}, {s[1]}, {s[2]} | " + " | ".join([f"{m:.2f}" for m in ms] + [""] * (5 - len(ms))) +
                     f" | {100 * ms[0] / sum(ms):.0f} % | {fifth} |")
    shares = [milliseconds(m, ("screen_gather.level1",)) / milliseconds(m, ("screen_gather.level",)) for m in map(lambda s: of_setting(found, s), settings)]
    return lines + ["", f"First level: {100 * min(shares):.0f} to {100 * max(shares):.0f} % of the gather.", ""]


def at_no_more_time(points, ms):
    """relMSE on the logarithmic line through the points; past the last of them, what that one has; None before the first."""
    if ms >= points[-1][0]:
        return points[-1][1]
    for (t0, e0, _), (t1, e1, _) in zip(points, points[1:]):
        if t0 <= ms <= t1:
            share = 0.0 if t1 == t0 else numpy.log(ms / t0) / numpy.log(t1 / t0)
            return float(e0 * (e1 / e0) ** share)
    return None


def starts_text(found, starts):
    kind = "screen, no shadows"
    reach = ", ".join(f"{start}: {levels}" for start, levels in starts.items())
    lines = ["## Figure 8: a lower start and more samples at equal cost", "",
             f"The paper: at the same cost a lower start with more samples looks better. Levels such that all reach equally far ({reach}); numbers in the "
             "plot are samples.", "", "![Error against time by start](../images/screen_space_starts.svg)", "",
             "| scene | start, samples | ms | relMSE | the next lower start in no more time | so the lower start |", "| --- | --- | ---: | ---: | ---: | --- |"]
    wins = total = 0
    for scene in found["starts"]:
        for lower, higher in zip(starts.items(), list(starts.items())[1:]):
            below = curve(found, scene, lower, kind)
            for ms, error, n in curve(found, scene, higher, kind):
                other = at_no_more_time(below, ms)
                total += other is not None
                wins += other is not None and other < error
                verdict = "is not that quick" if other is None else "wins" if other < error else "loses"
                lines.append(f"| {scene} | {higher[0]}, {n} | {ms:.1f} | {error:.3g} | {'' if other is None else f'{other:.3g}'} | {verdict} |")
    return lines + ["", f"The lower start wins {wins} of {total} pairs. relMSE against the truth on screen without shadows, whose own noise is in every one of them.", ""]


def recovered(r):
    """What part of the light that the other camera adds to the truth arrives: it is joined where that one shows the receiver itself."""
    gained = (r["errors"]["two"]["all"]["bias"] - r["errors"]["one"]["all"]["bias"]) * r["mean"]["all"]
    there = r["mean"]["both screens"] - r["mean"]["screen"]
    return (f"Of the difference {100 * gained / there:.0f} % arrive: the other camera's light reaches only pixels whose own surface it shows, which is how "
            "the paper joins cameras.")


def cameras_text(found):
    lines = ["## Figure 9: a second camera", "", "`--source-view OTHER --set cameras=on`.", ""]
    rows = ["| scene, camera, other | cameras | relMSE, all light | bias | relMSE, both screens | bias | relMSE, own screen | bias |",
            "| --- | --- |" + " ---: |" * 6]
    for scene, pairs in found["cameras"].items():
        for r in pairs:
            means = r["mean"]
            lines += [f"![{scene}, {r['camera']} and {r['other']}](../images/{r['picture']})",
                      f"{scene}, {r['camera']}, with {r['other']}. Of the true mean irradiance the picture's own surfaces send "
                      f"{100 * means['screen'] / means['all']:.0f} %, those that either camera shows {100 * means['both screens'] / means['all']:.0f} %. {recovered(r)}", ""]
            for name, errors in r["errors"].items():
                cells = " | ".join(f"{errors[k]['relMSE']:.3g} | {100 * errors[k]['bias']:+.0f} %" for k in ("all", "both screens", "screen"))
                rows.append(f"| {scene}, {r['camera']}, {r['other']} | {name} | {cells} |")
    return lines + rows + [""]
