"""Stacked charts of the error split: shares of the whole, and the error left after each step."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

from split_section import SHARES, is_measured, is_trusted, steps, title  # noqa: E402


def write_plots(folder, header, points):
    """Writes split.svg, split.png; returns their names. A bar only where the truth's noise is a tenth of the error or less."""
    every, points = len(points), [p for p in points if is_trusted(p, "total")]
    plt.rcParams.update({"font.size": 9, "svg.hashsalt": "lightwell"})
    figure, (left, right) = plt.subplots(1, 2, figsize=(13, 1.6 + 0.34 * len(points)), sharey=True,
                                         gridspec_kw={"width_ratios": [3, 2]})
    shares(left, points)
    falls(right, points)
    figure.text(0.01, 0.01, caption(header, points, every), fontsize=6.5, color="0.4")
    figure.tight_layout(rect=(0, 0.03, 1, 1))
    names = []
    for extension in ("svg", "png"):
        figure.savefig(folder / f"split.{extension}", dpi=130, metadata={"Date": None} if extension == "svg" else None)
        names.append(f"split.{extension}")
    plt.close(figure)
    return names


def shares(axis, points):
    """Bars of length one; negative shares stand left of zero and are made up for on the right. Hatched: within the truth's noise."""
    drawn = [name for name in SHARES if any(is_measured(p, name) for p in points)]
    for row, point in enumerate(points):
        right, left = 0.0, 0.0
        for name in drawn:
            if not is_measured(point, name):
                continue
            width = point["shares"][name] / point["total"]
            start = right if width >= 0.0 else left
            look = {"color": SHARES[name][2]} if is_trusted(point, name) else {
                "facecolor": "white", "edgecolor": SHARES[name][2], "hatch": "////", "linewidth": 0.0}
            axis.barh(row, width, left=start, height=0.72, **look)
            right, left = (right + width, left) if width >= 0.0 else (right, left + width)
    axis.set_yticks(range(len(points)), [", ".join(title(point)) for point in points])
    axis.invert_yaxis()
    axis.axvline(0.0, color="0.2", linewidth=0.8)
    axis.axvline(1.0, color="0.2", linewidth=0.8, linestyle=":")
    axis.set_xlabel("share of the relative MSE")
    handles = [plt.Rectangle((0, 0), 1, 1, color=SHARES[name][2]) for name in drawn]
    axis.legend(handles, [SHARES[name][0] for name in drawn], ncols=len(SHARES), fontsize=7.5, loc="lower left",
                bbox_to_anchor=(0.0, 1.0), frameon=False)


def falls(axis, points):
    """The error as it falls from step to step, as far as it is ten times the truth's noise."""
    colours = {f"{name} exact": colour for name, (_, _, colour) in SHARES.items()}
    for row, point in enumerate(points):
        fall = [(name, left) for name, left in steps(point) if left > 0.0 and is_trusted(point, name, left)]
        axis.plot([left for _, left in fall], [row] * len(fall), color="0.7", zorder=1)
        for name, left in fall:
            axis.scatter([left], [row], s=30, color=colours.get(name, "black"), zorder=2)
    axis.set_xscale("log")
    axis.grid(alpha=0.25)
    axis.set_xlabel("relative MSE: black as rendered, then each step exact")


def caption(header, points, every):
    device = header["device"]
    patterns = " or ".join(str(count) for count in sorted({p["patterns"] for p in points})) or header["patterns"]
    text = (f"{device['name']}, {device['width']} lanes; {header['size'][0]} x {header['size'][1]}; means over {patterns} "
            f"patterns of VPLs; Lightwell {header['versions']['lightwell']}, {header['written'][:10]}")
    if len(points) < every:
        text += f"; {every - len(points)} of {every} not drawn: the truth is too noisy for them"
    if any(not is_trusted(p, name) for p in points for name in SHARES if is_measured(p, name)):
        text += "; hatched: less than ten times the truth's noise, and no step drawn there"
    return text
