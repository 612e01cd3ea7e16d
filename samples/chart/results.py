"""What `lightwell chart` measured, as charts need it: which figures may be drawn, fronts, means over views."""
import math
import pathlib

from report import read_json
from pareto import pareto_front

# key: (title, whether it is an error of the irradiance, how to read it from a point's errors)
METRICS = {
    "relMSE": ("relative MSE of the irradiance", True, lambda e: e["relMSE"]),
    "nrmse": ("nRMSE of the irradiance", True, lambda e: e["nrmse"]),
    "bias": ("absolute bias of the irradiance", True, lambda e: abs(e["bias"])),
    "p99": ("99th percentile of the relative error", True, lambda e: e["p99"]),
    "score": ("10 less the score of the composite", False, lambda e: 10.0 - e["score"]),
    "flip": ("FLIP of the composite", False, lambda e: e["flip"]),
}
TRUTHS = {"own": "truth of the bounces that a technique models", "all": "truth of all bounces"}
TIMES = {"median": "median ms, host clock", "p99": "99th percentile ms, host clock"}


class Results:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        data = read_json(self.folder / "results.json", "lightwell-chart 1")
        self.header, self.views, self.points = data["header"], data["views"], data["points"]
        self.stale = [p for p in self.points if p["size"] != self.header["size"]]
        self.points = [p for p in self.points if p["size"] == self.header["size"]]
        self.techniques = list(dict.fromkeys(p["technique"] for p in self.points))
        self.scenes = list(dict.fromkeys(v["scene"] for v in self.views))

    def device_text(self):
        """What techniques ran on; a last run of the host's own alone has no device in its head."""
        device = self.header["device"]
        if device:
            return f"{device['name']}, {device['platform']} {device['driver']}, {device['width']} lanes"
        names = list(dict.fromkeys(p["device"] for p in self.points if p["device"]))
        return ", ".join(names) if names else self.header["versions"]["cpu"]

    def of_view(self, view):
        return [p for p in self.points if (p["scene"], p["camera"]) == (view["scene"], view["camera"])]

    def view_of(self, point):
        return next(v for v in self.views if (v["scene"], v["camera"]) == (point["scene"], point["camera"]))


def errors(point, truth="own"):
    return point["errors"].get(truth)


def is_drawn(point, truth="own"):
    """No figure is drawn where the truth's own noise exceeds a tenth of the error, or without a time."""
    judged = errors(point, truth)
    return judged is not None and judged["trusted"] and point["ms"] is not None


def value(point, metric="relMSE", truth="own"):
    """The error to be drawn; None where there is none or it is not to be drawn."""
    judged = errors(point, truth)
    if not is_drawn(point, truth) or metric not in ("relMSE", "nrmse", "bias", "p99") and metric not in judged:
        return None
    result = METRICS[metric][2](judged)
    return result if result > 0.0 else None  # logarithmic axes


def front(points, metric="relMSE", truth="own", time="median"):
    """The points on the front, by rising time."""
    drawn = [p for p in points if value(p, metric, truth) is not None]
    return [drawn[i] for i in pareto_front([(p["ms"][time], value(p, metric, truth)) for p in drawn])]


def means_over_views(results):
    """A point for each technique and setting: geometric means over all views. Settings that were not measured in
    every view are left out; an error is drawn only where it is in every view. Returns (points, left out)."""
    groups = {}
    for point in results.points:
        groups.setdefault((point["technique"], point["settings"]), []).append(point)
    made, left = [], []
    for (technique, settings), group in groups.items():
        if len(group) < len(results.views):
            left.append((technique, settings, "not measured in every view"))
            continue
        mean = {"id": f"mean/{technique}/{settings}", "technique": technique, "settings": settings,
                "label": group[0]["label"], "bounces": group[0]["bounces"], "ms": None, "errors": {}}
        if all(p["ms"] is not None for p in group):
            mean["ms"] = {time: geometric_mean([p["ms"][time] for p in group]) for time in TIMES}
        for truth in TRUTHS:
            mean["errors"][truth] = mean_errors(group, truth)
        if mean["errors"]["own"] and not mean["errors"]["own"]["trusted"]:
            noisy = sum(not is_drawn(p) for p in group)
            left.append((technique, settings, f"the truth is too noisy for it in {noisy} of {len(group)} views"))
        made.append(mean)
    return made, left


def mean_errors(group, truth):
    if any(errors(p, truth) is None for p in group):
        return None
    mean = {"trusted": all(errors(p, truth)["trusted"] for p in group)}
    for metric, (_, _, read) in METRICS.items():
        if any(metric not in errors(p, truth) for p in group):
            continue
        values = [max(read(errors(p, truth)), 1e-12) for p in group]
        mean[metric] = geometric_mean(values)
        if metric == "score":
            mean[metric] = 10.0 - mean[metric]
    return mean


def geometric_mean(values):
    return math.exp(sum(math.log(v) for v in values) / len(values))
