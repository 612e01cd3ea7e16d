"""The report: one HTML file with everything in it, so that it opens offline."""
import base64
import html
import json
import pathlib

from plots import colour_of
from results import METRICS, TIMES, TRUTHS, errors, front, is_drawn, means_over_views

HERE = pathlib.Path(__file__).resolve().parent
PICTURES_PER_TECHNIQUE = 5  # in a view; each is some 100 kB


def write_page(results, d3):
    means, left = means_over_views(results)
    data = {"views": [describe_view(results, view) for view in results.views],
            "mean": {"id": "mean", "title": f"Geometric means over {len(results.views)} views",
                     "points": [describe_point(p) for p in means], "fronts": fronts(means)},
            "colours": {t: colour_of(results, t) for t in results.techniques},
            "metrics": {key: {"title": title, "onAll": on_all} for key, (title, on_all, _) in METRICS.items()},
            "truths": TRUTHS, "times": TIMES}
    text = (HERE / "report.html").read_text(encoding="utf-8")
    parts = {"STYLE": (HERE / "report.css").read_text(encoding="utf-8"), "D3": d3,
             "SCRIPT": (HERE / "report.js").read_text(encoding="utf-8"), "HEAD": head(results),
             "TRUTHS": truth_table(results), "LEFT": left_out(results, left),
             "DATA": json.dumps(data, separators=(",", ":")).replace("</", "<\\/")}
    for name, part in parts.items():
        text = text.replace(f"<!--{name}-->", part)
    path = results.folder / "report.html"
    path.write_text(text, encoding="utf-8")
    return path.name


def describe_point(point, pictures=()):
    described = {key: point[key] for key in ("id", "technique", "settings", "label", "bounces", "ms")}
    described["scene"], described["camera"] = point.get("scene", ""), point.get("camera", "")
    described["frames"], described["deviceMs"] = point.get("frames"), point.get("device_ms")
    described["errors"] = {truth: dict(errors(point, truth), drawn=is_drawn(point, truth)) if errors(point, truth) else None
                           for truth in TRUTHS}
    if point in pictures:
        described["picture"] = True
    return described


def fronts(points):
    """Ids on the front for every choice that the page offers."""
    return {f"{metric}|{truth}|{time}": [p["id"] for p in front(points, metric, truth, time)]
            for metric, (_, on_all, _) in METRICS.items() for truth in TRUTHS if on_all or truth == "own" for time in TIMES}


def describe_view(results, view):
    points = results.of_view(view)
    chosen = pictured(results, points)
    images = {p["id"]: {"picture": data_uri(results, p["images"]["picture"]), "error": data_uri(results, p["images"]["error"]),
                        "truth": f"truth_{p['bounces'] or 'all'}"} for p in chosen}
    truths = {key: data_uri(results, path) for key, path in view["images"].items()}
    return {"id": view["id"], "title": f"{view['scene']}, camera {view['camera']}", "truths": truths, "images": images,
            "points": [describe_point(p, chosen) for p in points], "fronts": fronts(points)}


def pictured(results, points):
    """Named settings first, then the technique's own front, evenly."""
    chosen = []
    for technique in results.techniques:
        of_technique = [p for p in points if p["technique"] == technique]
        named = [p for p in of_technique if p["label"]][:PICTURES_PER_TECHNIQUE]
        others = [p for p in front(of_technique) if p not in named]
        room = PICTURES_PER_TECHNIQUE - len(named)
        if len(others) > room:
            others = [others[round(i * (len(others) - 1) / max(1, room - 1))] for i in range(room)]
        chosen += named + others
    return chosen


def data_uri(results, name):
    return "data:image/jpeg;base64," + base64.b64encode((results.folder / name).read_bytes()).decode("ascii")


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
                 f"(slow ones: at least 3 and {frames['patience']} s, very slow ones one), at most {frames['most']}"))
    loads = [p["load_average"] for p in results.points]
    if loads:
        rows.append(("load average", f"{min(loads):.1f} to {max(loads):.1f} while measuring"))
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
                         f"{sum(not is_drawn(p, kind) for p in points)} of {len(points)}"))
    return table(["scene", "camera", "bounces", "samples per pixel", "noise (relMSE)", "points too accurate for it"], rows)


def left_out(results, left):
    if not left:
        return ""
    items = "".join(f"<li>{html.escape(t)} {html.escape(s)}: {html.escape(why)}</li>" for t, s, why in left)
    return f"<details><summary>{len(left)} settings are not in the means</summary><ul>{items}</ul></details>"


def table(titles, rows):
    head_row = "".join(f"<th>{html.escape(str(t))}</th>" for t in titles) if any(titles) else ""
    body = "".join("<tr>" + "".join(f"<td>{html.escape(str(c))}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head_row}</tr></thead><tbody>{body}</tbody></table>"
