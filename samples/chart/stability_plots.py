"""Figures over time as files, one SVG for each sequence."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402

from looks import looks  # noqa: E402
from stability_results import COLUMNS, INDICES  # noqa: E402

PANELS = ["nrmse", "bias", *INDICES]
SWEPT_RATIO = 10.0  # from this ratio of its ends on, what a sequence sweeps has a logarithmic axis


def write_plots(results):
    """Writes stability_SEQUENCE.svg; returns the names by sequence."""
    plt.rcParams.update({"font.size": 8, "svg.hashsalt": "lightwell", "axes.grid": True, "grid.alpha": 0.25})
    return {s["id"]: save(results, s) for s in results.sequences}


def series(result, key, floor=False):
    """One number per frame; NaN where a frame has none."""
    frames = [f["floors"] if floor else f for f in result["frames"]]
    return [float("nan") if f.get(key) is None else f[key] for f in frames]


def has_any(values):
    return any(v == v for v in values)


def save(results, sequence):
    shown = [(t, results.of(t, sequence)) for t in results.techniques if results.of(t, sequence)]
    panels = [key for key in PANELS if any(has_any(series(r, key)) for _, r in shown)]
    columns = min(4, max(1, len(panels)))
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(3.1 * columns, 2.2 * rows), squeeze=False)
    for axis in axes.flat[len(panels):]:
        axis.set_visible(False)
    for axis, key in zip(axes.flat, panels):
        draw(axis, results, sequence, shown, key)
    # Above all panels: with a technique for each colour it would lie over the lines of the first.
    longest = max((len(name) for name, _ in shown), default=0)
    across = max(1, min(3 * columns, int(3.1 * columns / (0.5 + 0.06 * longest))))  # inches: a line, its marker, 7-point letters
    lines = -(-len(shown) // across)
    figure.legend(*axes.flat[0].get_legend_handles_labels(), fontsize=7, loc="upper center", ncol=across, frameon=False)
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 1.0 - (0.06 + 0.17 * lines) / figure.get_figheight()))
    path = results.folder / f"stability_{sequence['id']}.svg"
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
    return path.name


def draw(axis, results, sequence, shown, key):
    x = axis_values(axis, sequence, key)
    for technique, result in shown:
        colour, line, marker = looks(results.techniques)[technique]
        axis.plot(x, series(result, key), color=colour, linestyle=line, linewidth=1.2, marker=marker, markersize=2.5, label=technique)
        floors = series(result, key, floor=True)
        if has_any(floors):
            axis.plot(x, floors, color=colour, linewidth=0.9, linestyle=":")
    if key != "leak" or not sequence.get("sweeps"):
        sizes = sequence.get("sizes") or []
        changes = [f for f in range(1, len(sizes)) if sizes[f] != sizes[f - 1]]
        for frame in set(changes) | {f for f in sequence.get("cuts") or [] if f > 0}:
            axis.axvline(frame, color="0.6", linewidth=0.8, zorder=0)
    # From 0 on, where small differences would look large.
    low, high = axis.get_ylim()
    axis.set_ylim(min(low, 0.0) if low < 0.0 and key in ("bias", "ghost", "leak", "drift") else 0.0, max(high, 1e-6))
    axis.set_title(COLUMNS[key][0], loc="left")


def axis_values(axis, sequence, key):
    """Frames; a leak's is what the sequence sweeps, such as the wall's thickness."""
    values = sequence.get("values") or []
    if key == "leak" and sequence.get("sweeps") and len(values) == sequence["frames"]:
        axis.set_xlabel(sequence["sweeps"])
        low, high = min(values), max(values)
        if low > 0.0 and high / low >= SWEPT_RATIO:
            axis.set_xscale("log")
        return values
    axis.set_xlabel("frame")
    axis.xaxis.set_major_locator(MaxNLocator(integer=True))
    axis.set_xlim(-0.5, sequence["frames"] - 0.5)  # the same for all, whatever frames a figure has
    return list(range(sequence["frames"]))
