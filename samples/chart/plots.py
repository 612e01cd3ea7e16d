"""Charts as files: one SVG and one PNG for each scene, and a summary over all views."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.text import Text  # noqa: E402
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter  # noqa: E402

from looks import looks  # noqa: E402
from results import TRUTHS, counted, errors, front, is_drawn, means_over_views, value  # noqa: E402

MARKERS = {0: "D", 1: "o", 2: "s"}  # by bounces


def colour_of(results, technique):
    return looks(results.techniques)[technique][0]


def write_plots(results):
    """Writes SCENE.svg, SCENE.png, summary.svg, summary.png; returns their names."""
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "lightwell", "axes.grid": True, "grid.alpha": 0.25})
    names = []
    for scene in results.scenes:
        views = [view for view in results.views if view["scene"] == scene]
        charts = [(f"{scene}, {v['camera']}", results.of_view(v)) for v in views]
        names += save(results, scene, [[(*chart, truth) for chart in charts] for truth in present_truths(results.points)])
    means, _ = means_over_views(results)
    title = "geometric means over " + counted(len(results.shared), "view")
    return names + save(results, "summary", [[(title, means, truth) for truth in present_truths(means)]])


def present_truths(points):
    """All bounces only where they were traced."""
    return [truth for truth in TRUTHS if truth == "own" or any(is_drawn(p, truth) for p in points)]


def save(results, name, rows):
    """`rows` of (title, points, truth) side by side."""
    size = (6.4 * len(rows[0]), 4.6 * len(rows) + 0.2)
    figure, axes = plt.subplots(len(rows), len(rows[0]), figsize=size, squeeze=False)
    for axis, chart in zip(axes.flat, [chart for row in rows for chart in row]):
        draw(results, axis, *chart)
    figure.text(0.01, 0.02 / len(rows), caption(results), fontsize=6.5, color="0.4")
    figure.tight_layout(rect=(0, 0.05 / len(rows), 1, 1))
    for axis, (_, points, truth) in zip(axes.flat, [chart for row in rows for chart in row]):
        name_points(results, axis, points, truth)  # at last: what overlaps is known once everything has its place
    written = []
    for extension in ("svg", "png"):
        path = results.folder / f"{name}.{extension}"
        figure.savefig(path, dpi=130 if len(rows[0]) == 1 else 100, metadata={"Date": None} if extension == "svg" else None)
        written.append(path.name)
    plt.close(figure)
    return written


def caption(results):
    header = results.header
    load = "load average {:.1f} to {:.1f}".format(*results.loads()) if results.loads() else ""
    return (f"{results.device_text()}, {header['versions']['threads']} threads; {header['size'][0]} x {header['size'][1]}\n"
            f"{load}; time from the host's images to the host's output, warm; Lightwell {header['versions']['lightwell']}, {header['written'][:10]}")


def widen(axis, places):
    """Axes of half a decade at least, where small differences would look large."""
    for index, limit in ((0, axis.set_xlim), (1, axis.set_ylim)):
        values = [place[index] for place in places] or [1.0]
        margin = max(1.15, (max(values) / min(values)) ** 0.06, math.sqrt(math.sqrt(10.0) * min(values) / max(values)))
        limit(min(values) / margin, max(values) * margin)


def label_axis(one, limits):
    """Plain numbers, readable also within one decade and not too many in several."""
    span = limits[1] / limits[0]
    digits = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 7.0) if span < 8.0 else (1.0, 2.0, 5.0) if span < 2e3 else (1.0,)
    one.set_major_locator(LogLocator(subs=digits, numticks=50))
    one.set_major_formatter(StrMethodFormatter("{x:g}"))
    one.set_minor_formatter(NullFormatter())


def draw_front(axis, places):
    """The staircase of what is attained: from the chart's upper edge down, to its right edge."""
    (left, right), (low, high) = axis.get_xlim(), axis.get_ylim()
    del left, low
    xs = [places[0][0]] + [x for x, _ in places] + [right]
    ys = [high] + [y for _, y in places] + [places[-1][1]]
    axis.plot(xs, ys, color="0.35", linewidth=1.0, zorder=0, drawstyle="steps-post", label="Pareto front")


# Where a name may stand beside its point, the nearest places first: points right and up, and which of its ends is there.
NAME_PLACES = [(x * side, y, "left" if side > 0 else "right") for y, x in ((5, 5), (-10, 5), (15, 8), (-20, 8), (25, 12), (-30, 12), (35, 16), (-40, 16),
                                                                          (48, 20), (-52, 20), (62, 24), (-64, 24)) for side in (1, -1)]


def name_points(results, axis, points, truth):
    """The names of settings, none over another: the first free place near its point, with a line to it from afar; else none,
    which the report's table and its interactive charts still have."""
    renderer = axis.figure.canvas.get_renderer()
    frame, taken = axis.get_window_extent(renderer), []
    legend = axis.get_legend()
    if legend is not None:
        taken.append(legend.get_window_extent(renderer))
    named = [p for p in points if p["label"] and value(p, truth=truth) is not None]
    for point in sorted(named, key=lambda p: p["ms"][results.time()]):
        at = (point["ms"][results.time()], value(point, truth=truth))
        colour = colour_of(results, point["technique"])
        for x, y, end in NAME_PLACES:
            text = axis.annotate(point["label"], at, xytext=(x, y), textcoords="offset points", fontsize=7, color=colour, ha=end,
                                 arrowprops=None if abs(y) <= 10 else {"arrowstyle": "-", "color": colour, "linewidth": 0.5, "shrinkB": 4})
            text.update_positions(renderer)
            box = Text.get_window_extent(text, renderer)  # of the letters alone: lines may cross
            inside = frame.x0 <= box.x0 and box.x1 <= frame.x1 and frame.y0 <= box.y0 and box.y1 <= frame.y1
            if inside and not any(box.overlaps(other) for other in taken):
                taken.append(box)
                break
            text.remove()


def draw(results, axis, title, points, truth):
    time = results.time()
    place = lambda p: (p["ms"][time], value(p, truth=truth))  # noqa: E731
    drawn = [p for p in points if value(p, truth=truth) is not None]
    for technique in results.techniques:
        of_technique = [p for p in drawn if p["technique"] == technique]
        for bounces in sorted({p["bounces"] for p in of_technique}):
            some = [p for p in of_technique if p["bounces"] == bounces]
            name = technique if len({p["bounces"] for p in of_technique}) == 1 else f"{technique}, bounces={bounces}"
            axis.scatter([place(p)[0] for p in some], [place(p)[1] for p in some], s=22, linewidths=0, alpha=0.85,
                         color=colour_of(results, technique), marker=MARKERS.get(bounces, "^"), label=name)
    widen(axis, [place(p) for p in drawn])
    axis.set_xscale("log")
    axis.set_yscale("log")
    best = front(points, truth=truth, time=time)
    if best:
        draw_front(axis, [place(p) for p in best])
    for point in drawn:
        if point["label"]:
            axis.scatter(*[[c] for c in place(point)], s=60, facecolors="none",
                         edgecolors=colour_of(results, point["technique"]), linewidths=1.0)
    judged = [p for p in points if errors(p, truth)]
    hidden = sum(1 for p in judged if not is_drawn(p, truth))
    if hidden:
        axis.set_title(f"{hidden} of {len(judged)} not drawn: the truth is too noisy for them", loc="right", fontsize=7,
                       color="0.4")
    label_axis(axis.xaxis, axis.get_xlim())
    label_axis(axis.yaxis, axis.get_ylim())
    axis.set_title(title, loc="left")
    axis.set_xlabel(results.times[time])
    axis.set_ylabel("relative MSE, " + TRUTHS[truth])
    if drawn:
        axis.legend(fontsize=7, loc="best")
