"""Stacked charts of the error split: shares of the whole, and the error left after each step."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from split_section import SHARES, steps, title  # noqa: E402


def write_plots(folder, header, points):
    """Writes split.svg, split.png; returns their names."""
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "lightwell"})
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 1.6 + 0.34 * len(points)), sharey=True,
                                         gridspec_kw={"width_ratios": [3, 2]})
    shares(left, points)
    falls(right, points)
    figure.text(0.01, 0.01, caption(header), fontsize=6.5, color="0.4")
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    names = []
    for extension in ("svg", "png"):
        figure.savefig(folder / f"split.{extension}", dpi=130, metadata={"Date": None} if extension == "svg" else None)
        names.append(f"split.{extension}")
    plt.close(figure)
    return names


def shares(axis, points):
    """Bars of length one; negative shares stand left of zero and are made up for on the right."""
    for row, point in enumerate(points):
        right, left = 0.0, 0.0
        for name, (_, _, colour) in SHARES.items():
            width = (point["shares"][name] or 0.0) / point["total"]
            start = right if width >= 0.0 else left
            axis.barh(row, width, left=start, color=colour, height=0.72)
            right, left = (right + width, left) if width >= 0.0 else (right, left + width)
    axis.set_yticks(range(len(points)), [", ".join(title(point)) for point in points])
    axis.invert_yaxis()
    axis.axvline(0.0, color="0.2", linewidth=0.8)
    axis.axvline(1.0, color="0.2", linewidth=0.8, linestyle=":")
    axis.set_xlabel("share of the relative MSE")
    handles = [plt.Rectangle((0, 0), 1, 1, color=colour) for _, _, colour in SHARES.values()]
    axis.legend(handles, [text for text, _, _ in SHARES.values()], ncols=len(SHARES), fontsize=7.5, loc="lower left",
                bbox_to_anchor=(0.0, 1.0), frameon=False)


def falls(axis, points):
    """The error as it falls from step to step; what is below zero by noise is not drawn."""
    colours = {f"{name} exact": colour for name, (_, _, colour) in SHARES.items()}
    for row, point in enumerate(points):
        fall = [(name, left) for name, left in steps(point) if left > 0.0]
        axis.plot([left for _, left in fall], [row] * len(fall), color="0.7", zorder=1)
        for name, left in fall:
            axis.scatter([left], [row], s=30, color=colours.get(name, "black"), zorder=2)
    axis.set_xscale("log")
    axis.grid(alpha=0.25)
    axis.set_xlabel("relative MSE: black as rendered, then each step exact")


def caption(header):
    device = header["device"]
    return (f"{device['name']}, {device['width']} lanes; {header['size'][0]} x {header['size'][1]}; means over {header['patterns']} "
            f"patterns of VPLs; Lightwell {header['versions']['lightwell']}, {header['written'][:10]}")
