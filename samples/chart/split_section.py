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
    "bounding": ("bounding", "the bounded geometry term, the RSM's own texels, and light that stands in no RSM", "#0072B2"),
}
TRUSTED = 0.1  # share of a figure that the truth's noise may be

BODY = """<p>Each bar is the relative MSE of one technique with one set of parameters, against the light of {truth}. Its
approximations are replaced by exact ones from left to right: {model}every pixel gathers from every
VPL; each pair of pixel and VPL gets a shadow ray; the mean over many patterns of VPLs stands for the one. What the
error loses with a step is that approximation's share; the rest is the bounding's. A share left of zero is an approximation that hid the
error of another: light without shadows is too much, left-out bounces are too little. Light of a kind that stands in no RSM (a
sky, glowing surfaces) is missing with every step and stays in the bounding's share.</p>
<img class="plot" src="{plot}" alt="shares of the error">
<div class="wide">{figures}</div>
<p>Noise: relMSE of the truth itself, which stands in the bounding's share, that of all bounces in the model's. In brackets:
less than ten times the noise; hatched in the chart, and without a bar where it is the whole error.{left_out}</p>
"""


def make(folder):
    data = read_json(folder / FILE, FORMAT)
    points, stale = current(data)
    if not points:
        raise ReportError(f"{folder / FILE}: no point is measured yet")
    from split_plots import write_plots  # matplotlib takes a second
    written = write_plots(folder, data["header"], points)
    return Section("Where the error comes from", body(points, stale, data_uri(folder / written[0])), written=written)


def current(data):
    """The points of the last run's size, and how many of others the file holds besides."""
    size = data["header"]["size"]
    points = [p for p in data["points"] if p.get("size", size) == size]
    return points, len(data["points"]) - len(points)


def body(points, stale, plot):
    modelled = {p["truth_of_all_bounces"] for p in points}
    truth = {True: "all bounces", False: "as many bounces as the technique models"}
    left_out = f" Points of other sizes in this file, left out: {stale}." if stale else ""
    return BODY.format(plot=plot, figures=figures(points), left_out=left_out,
                       truth=" or ".join(truth[key] for key in sorted(modelled, reverse=True)),
                       model="the bounces it leaves out are added; " if True in modelled else "")


def title(point):
    """What a bar is called: view, then technique and settings."""
    settings = point["label"] or point["settings"]
    return f"{point['scene']}, {point['camera']}", f"{point['technique']} {settings}"


def steps(point):
    """(name, error left after it) of each step, from the whole error down."""
    left, rows = point["total"], [("as rendered", point["total"])]
    for name in list(SHARES)[:-1]:
        if not is_measured(point, name):
            continue
        left -= point["shares"][name]
        rows.append((f"{name} exact", left))
    return rows


def is_measured(point, name):
    return point["shares"][name] is not None and (name != "model" or point["truth_of_all_bounces"])


def noise(point, name):
    """relMSE of the truth that stands in a share, or in the error after a step; patterns and differences of two pictures against
    one truth hold none."""
    if name in ("total", "model", "as rendered"):
        return point.get("noise_of_total", point["noise"])
    return point["noise"] if name == "bounding" or name.endswith(" exact") else 0.0


def is_trusted(point, name, value=None):
    """No figure is trusted where the truth's own noise exceeds a tenth of it. `name`: of a share, or "total"; of a step with the
    error that is left after it."""
    if value is None:
        value = point["total"] if name == "total" else point["shares"][name]
    own = noise(point, name)
    return own == 0.0 or own <= TRUSTED * (abs(value) if name == "model" else value)


def figure_text(point, name):
    """A share, or the "total", as the tables give it."""
    if name == "total":
        text = f"{point['total']:.3g}"
    elif is_measured(point, name):
        text = f"{point['shares'][name]:+.3g}"
    else:
        return ""
    return text if is_trusted(point, name) else f"({text})"


def figures(points):
    titles = ["view", "technique", "VPLs", "relMSE", *(text for text, _, _ in SHARES.values()), "noise"]
    rows = []
    for point in points:
        view, name = title(point)
        rows.append([view, name, point["vpls"], *(figure_text(point, key) for key in ["total", *SHARES]), f"{point['noise']:.1e}"])
    return table(titles, rows, numbers_from=2)
