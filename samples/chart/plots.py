"""Charts as files: one SVG and one PNG for each scene, and a summary over all views."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: E402

from results import front, is_drawn, means_over_views, value  # noqa: E402

# Okabe and Ito's colours: told apart by most colour-blind readers, too.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442"]
MARKERS = {0: "D", 1: "o", 2: "s"}  # by bounces


def colour_of(results, technique):
    return COLOURS[results.techniques.index(technique) % len(COLOURS)]


def write_plots(results):
    """Writes SCENE.svg, SCENE.png, summary.svg, summary.png; returns their names."""
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "lightwell", "axes.grid": True, "grid.alpha": 0.25})
    names = []
    for scene in results.scenes:
        views = [view for view in results.views if view["scene"] == scene]
        names += save(results, scene, [(f"{scene}, {v['camera']}", results.of_view(v)) for v in views])
    means, _ = means_over_views(results)
    title = f"geometric means over {len(results.views)} views"
    return names + save(results, "summary", [(title, means)])


def save(results, name, charts):
    figure, axes = plt.subplots(1, len(charts), figsize=(6.4 * len(charts), 4.8), squeeze=False)
    for axis, (title, points) in zip(axes[0], charts):
        draw(results, axis, title, points)
    figure.text(0.01, 0.01, caption(results), fontsize=6.5, color="0.4")
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    written = []
    for extension in ("svg", "png"):
        path = results.folder / f"{name}.{extension}"
        figure.savefig(path, dpi=130, metadata={"Date": None} if extension == "svg" else None)
        written.append(path.name)
    plt.close(figure)
    return written


def caption(results):
    header = results.header
    return (f"{results.device_text()}, {header['versions']['threads']} threads; {header['size'][0]} x {header['size'][1]}; \n"
            f"time from the host's images to the host's output, warm; Lightwell {header['versions']['lightwell']}, {header['written'][:10]}")


def widen(axis, drawn):
    """Axes of half a decade at least, where small differences would look large."""
    for read, limit in ((lambda p: p["ms"]["median"], axis.set_xlim), (value, axis.set_ylim)):
        values = [read(p) for p in drawn] or [1.0]
        margin = max(1.15, (max(values) / min(values)) ** 0.06, math.sqrt(math.sqrt(10.0) * min(values) / max(values)))
        limit(min(values) / margin, max(values) * margin)


def draw(results, axis, title, points):
    drawn = [p for p in points if value(p) is not None]
    for technique in results.techniques:
        of_technique = [p for p in drawn if p["technique"] == technique]
        for bounces in sorted({p["bounces"] for p in of_technique}):
            some = [p for p in of_technique if p["bounces"] == bounces]
            name = technique if len({p["bounces"] for p in of_technique}) == 1 else f"{technique}, bounces={bounces}"
            axis.scatter([p["ms"]["median"] for p in some], [value(p) for p in some], s=22, linewidths=0, alpha=0.85,
                         color=colour_of(results, technique), marker=MARKERS.get(bounces, "^"), label=name)
    best = front(points)
    if best:
        axis.plot([p["ms"]["median"] for p in best], [value(p) for p in best], color="0.35", linewidth=1.0, zorder=0,
                  drawstyle="steps-post", label="Pareto front")
    for point in drawn:
        if point["label"]:
            axis.annotate(point["label"], (point["ms"]["median"], value(point)), xytext=(5, 5), textcoords="offset points",
                          fontsize=7, color=colour_of(results, point["technique"]))
            axis.scatter([point["ms"]["median"]], [value(point)], s=60, facecolors="none",
                         edgecolors=colour_of(results, point["technique"]), linewidths=1.0)
    hidden = sum(1 for p in points if not is_drawn(p))
    if hidden:
        axis.set_title(f"{hidden} of {len(points)} not drawn: the truth is too noisy for them", loc="right", fontsize=7,
                       color="0.4")
    widen(axis, drawn)
    axis.set_xscale("log")
    axis.set_yscale("log")
    for one in (axis.xaxis, axis.yaxis):  # plain numbers, readable also within one decade
        one.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        one.set_major_formatter(StrMethodFormatter("{x:g}"))
        one.set_minor_formatter(NullFormatter())
    axis.set_title(title, loc="left")
    axis.set_xlabel("milliseconds per frame")
    axis.set_ylabel("relative MSE, truth of the bounces modelled")
    if drawn:
        axis.legend(fontsize=7, loc="best")
