"""Section of the report for `lightwell split`: where a VPL technique's error comes from."""
from report import ReportError, Section, data_uri, read_json, table

FILE, ORDER = "split.json", 20
FORMAT = "lightwell-split 1"

# In the order in which they are replaced by exact; colours of Okabe and Ito.
SHARES = {
    "model": ("model", "bounces that the technique leaves out", "#56B4E9"),
    "resolution": ("resolution", "halves, interleaving and their filters", "#009E73"),
    "visibility": ("visibility", "what stands between VPL and pixel", "#D55E00"),
    "sampling": ("sampling", "few VPLs for all light: differs from pattern to pattern", "#E69F00"),
    "bounding": ("bounding", "the bounded geometry term, and the RSM's own texels", "#0072B2"),
}

BODY = """<p>Each bar is the relative MSE of one technique with one set of parameters, against the light of all bounces. Its
approximations are replaced by exact ones from left to right: the bounces it leaves out are added; every pixel gathers from every
VPL; each pair of pixel and VPL gets a shadow ray; the mean over many patterns of VPLs stands for the one. What the
error loses with a step is that approximation's share; the rest is the bounding's. A share left of zero is an approximation that hid the
error of another: light without shadows is too much, left-out bounces are too little.</p>
<img class="plot" src="{plot}" alt="shares of the error">
<div class="wide">{figures}</div>
<p>Noise: relMSE of the truth itself, which stands in the last share. Grey: that share is less than ten times the noise.</p>
"""


def make(folder):
    data = read_json(folder / FILE, FORMAT)
    points = data["points"]
    if not points:
        raise ReportError(f"{folder / FILE}: no point is measured yet")
    from split_plots import write_plots  # matplotlib takes a second
    written = write_plots(folder, data["header"], points)
    return Section("Where the error comes from", BODY.format(plot=data_uri(folder / written[0]), figures=figures(points)),
                   written=written)


def title(point):
    """What a bar is called: view, then technique and settings."""
    settings = point["label"] or point["settings"]
    return f"{point['scene']}, {point['camera']}", f"{point['technique']} {settings}"


def steps(point):
    """(name, error left after it) of each step, from the whole error down."""
    left, rows = point["total"], [("as rendered", point["total"])]
    for name in list(SHARES)[:-1]:
        share = point["shares"][name]
        if share is None or (name == "model" and not point["truth_of_all_bounces"]):
            continue
        left -= share
        rows.append((f"{name} exact", left))
    return rows


def is_trusted(point):
    return point["noise"] <= 0.1 * point["shares"]["bounding"]


def figures(points):
    titles = ["view", "technique", "VPLs", "relMSE", *(text for text, _, _ in SHARES.values()), "noise"]
    rows = []
    for point in points:
        view, name = title(point)
        cells = [view, name, point["vpls"], f"{point['total']:.3g}"]
        for key in SHARES:
            share = point["shares"][key]
            text = "" if share is None or (key == "model" and not point["truth_of_all_bounces"]) else f"{share:+.3g}"
            cells.append(f"({text})" if key == "bounding" and not is_trusted(point) else text)
        rows.append(cells + [f"{point['noise']:.1e}"])
    return table(titles, rows, numbers_from=2)
