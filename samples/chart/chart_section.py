"""Section of the report for `lightwell chart`: error against time."""
import html

from report import HERE, Section, data_uri, table
from results import METRICS, TRUTHS, Results, counted, errors, front, is_drawn, means_over_views

FILE, ORDER = "results.json", 10
PICTURES_PER_TECHNIQUE = 5  # in a view; each is some 100 kB

BODY = """<p>Every point is a technique with one set of parameters: milliseconds per frame, from the host's images to the
host's output, against its error. Left and low is good; the grey line is the Pareto front: what nothing beats in both.
Points with a ring are named settings. Wheel and drag zoom a chart, a double click shows all again; a click on
a point shows its picture, where there is one, below.</p>
<p>A technique is judged against the truth of as many bounces as it models; the choice below compares all of them with the
light of all bounces, or those that take their light from the picture alone with the light of what the view shows, where that was
traced: the most that they can know. No point is drawn where the truth's own noise exceeds a tenth of its error. {judged}</p>
<form id="choices">
  <label>error <select id="metric"></select></label>
  <label>against <select id="truth"></select></label>
  <label>time <select id="time"></select></label>
</form>
<section id="summary"></section>
{left}
<section id="views"></section>
<h2>All figures</h2>
<p><input id="filter" type="search" placeholder="filter: scene, technique, vpls=256 ..." size="40">
A click on a head sorts. Figures in grey are not drawn: the truth is too noisy for them.</p>
<div class="wide"><table id="figures"><thead></thead><tbody></tbody></table></div>
<h2>Truths</h2>
<div class="wide">{truths}</div>
<h2>Measured on</h2>
<div class="wide">{head}</div>
"""


def make(folder):
    from plots import colour_of, present_truths, write_plots  # once the results are known to be right: matplotlib takes a second
    results = Results(folder)
    means, left = means_over_views(results)
    data = {"views": [describe_view(results, view) for view in results.views],
            "mean": {"id": "mean", "title": "Geometric means over " + counted(len(results.shared), "view"),
                     "points": [describe_point(p) for p in means], "fronts": fronts(results, means)},
            "colours": {t: colour_of(results, t) for t in results.techniques},
            "metrics": {key: {"title": title, "onAll": on_all} for key, (title, on_all, _) in METRICS.items()},
            "truths": {t: TRUTHS[t] for t in present_truths(results.points)}, "sharedViews": len(results.shared), "times": results.times, "time": results.time()}
    body = BODY.format(judged=judged_text(results), left=left_out(left), truths=truth_table(results), head=head(results))
    script = (HERE / "chart_section.js").read_text(encoding="utf-8")
    return Section("Speed against accuracy", body, data, script, written=write_plots(results))


def describe_point(point, pictures=()):
    described = {key: point[key] for key in ("id", "technique", "settings", "label", "bounces", "ms")}
    described["scene"], described["camera"] = point.get("scene", ""), point.get("camera", "")
    described["frames"], described["deviceMs"] = point.get("frames"), point.get("device_ms")
    described["errors"] = {truth: dict(errors(point, truth), drawn=is_drawn(point, truth), pictureDrawn=is_drawn(point, truth, "flip"))
                           if errors(point, truth) else None for truth in TRUTHS}
    if point in pictures:
        described["picture"] = True
    return described


def fronts(results, points):
    """Ids on the front for every choice that the page offers."""
    return {f"{metric}|{truth}|{time}": [p["id"] for p in front(points, metric, truth, time)]
            for metric, (_, on_all, _) in METRICS.items() for truth in TRUTHS if on_all or truth == "own" for time in results.times}


def describe_view(results, view):
    points = results.of_view(view)
    chosen = pictured(results, points)
    images = {p["id"]: {"picture": data_uri(results.folder / p["images"]["picture"]), "error": data_uri(results.folder / p["images"]["error"]),
                        "truth": f"truth_{p['bounces'] or 'all'}"} for p in chosen}
    truths = {key: data_uri(results.folder / path) for key, path in view["images"].items()}
    return {"id": view["id"], "title": f"{view['scene']}, camera {view['camera']}", "truths": truths, "images": images,
            "points": [describe_point(p, chosen) for p in points], "fronts": fronts(results, points)}


def pictured(results, points):
    """Named settings first, then the technique's own front, evenly."""
    chosen = []
    for technique in results.techniques:
        of_technique = [p for p in points if p["technique"] == technique and "error" in p["images"]]
        named = [p for p in of_technique if p["label"]][:PICTURES_PER_TECHNIQUE]
        others = [p for p in front(of_technique) if p not in named]
        room = PICTURES_PER_TECHNIQUE - len(named)
        if len(others) > room:
            others = [others[round(i * (len(others) - 1) / max(1, room - 1))] for i in range(room)]
        chosen += named + others
    return chosen


def judged_text(results):
    block = results.header.get("judged_block", 1)
    if block == 1:
        return ""
    return (f"The irradiance is judged at one pixel of each {block} x {block}, composites on whole pictures, whose truth is noisier "
            "and leaves out more points.")


def head(results):
    header = results.header
    rows = [("size", "{} x {} pixels".format(*header["size"]) + (", quick form" if header["quick"] else "")),
            ("written", header["written"])]
    if header["device"]:
        device = header["device"]
        rows.append(("device", "{name}, {platform} {driver}, {opencl}, {compute_units} compute units, width {width}"
                     .format(**device)))
    rows += list(header["versions"].items())
    frames = header["frames"]
    rows.append(("frames", f"{frames['warm_up']} unmeasured, then at least {frames['fewest']} and {frames['seconds']} s "
                 f"(slow ones: at least 3 and {frames['patience']} s, very slow ones one, cold), at most {frames['most']}"))
    if results.loads():
        rows.append(("load average", "{:.1f} to {:.1f} while measuring".format(*results.loads()) +
                     (": other work lengthened the host clock's times" if results.is_busy() else "")))
    if header.get("run_seconds"):
        rows.append(("the last run took", ", ".join(f"{name} {seconds:.0f} s" for name, seconds in header["run_seconds"].items())))
    others = sum(p.get("build", header["build"]) != header["build"] for p in results.points)
    if others:
        rows.append(("builds", f"{others} of {len(results.points)} points are of another build than the last run"))
    if results.stale:
        rows.append(("left out", f"{len(results.stale)} points of another size"))
    return table(["", ""], rows)


def truth_table(results):
    rows = []
    for view in results.views:
        for truth in view["truths"]:
            points = [p for p in results.of_view(view) if (truth["bounces"] == 0 and errors(p, "all")) or
                      p["bounces"] == truth["bounces"]]
            kind = "all" if truth["bounces"] == 0 else "own"
            rows.append((view["scene"], view["camera"], truth["bounces"] or "all", truth["samples"], f"{truth['noise']:.2e}",
                         f"{sum(not is_drawn(p, kind) for p in points)} of {len(points)}",
                         truth.get("picture_samples", truth["samples"]), f"{truth.get('picture_noise', truth['noise']):.2e}"))
        if view.get("on_screen"):
            points = [p for p in results.of_view(view) if errors(p, "screen")]
            truth = view["on_screen"]
            rows.append((view["scene"], view["camera"], "1, of what the view shows", truth["samples"], f"{truth['noise']:.2e}",
                         f"{sum(not is_drawn(p, 'screen') for p in points)} of {len(points)}", "", ""))
    return table(["scene", "camera", "bounces", "samples per judged pixel", "noise (relMSE)", "points too accurate for it",
                  "samples per pixel of whole pictures", "their noise"], rows)


def left_out(left):
    if not left:
        return ""
    items = "".join(f"<li>{html.escape(t)} {html.escape(s)}: {html.escape(why)}</li>" for t, s, why in left)
    return f"<details><summary>{len(left)} settings are not drawn in the means</summary><ul>{items}</ul></details>"
