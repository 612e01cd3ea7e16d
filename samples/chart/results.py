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
TRUTHS = {"own": "truth of the bounces that a technique models", "all": "truth of all bounces",
          "screen": "truth of one bounce from what the view shows"}
TIMES = {"median": "median ms, host clock", "p99": "99th percentile ms, host clock",
         "processor": "processor ms per thread"}
BUSY = 1.25  # load average for each thread above which the host's clock tells more of other work than of ours


class Results:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        data = read_json(self.folder / "results.json", "lightwell-chart 1")
        self.header, self.views, self.points = data["header"], data["views"], data["points"]
        self.stale = [p for p in self.points if p["size"] != self.header["size"]]
        self.points = [p for p in self.points if p["size"] == self.header["size"]]
        self.techniques = list(dict.fromkeys(p["technique"] for p in self.points))
        self.scenes = list(dict.fromkeys(v["scene"] for v in self.views))
        self.times = self.add_processor_times()
        # Views in which every technique was measured: what means are made over.
        self.shared = [v for v in self.views if {p["technique"] for p in self.of_view(v)} == set(self.techniques)]

    def add_processor_times(self):
        """Processor time as one more time, where it is that of the device (a CPU) and every point has it: what the frame
        would take at least if all threads had a core each. Returns the times that there are."""
        timed = [p for p in self.points if p["ms"] is not None]
        on_gpu = (self.header.get("device") or {}).get("is_gpu", False)
        if on_gpu or not timed or not all(p.get("processor_ms") for p in timed):
            return {key: title for key, title in TIMES.items() if key != "processor"}
        for point in timed:
            point["ms"]["processor"] = point["processor_ms"]["median"] / int(self.header["versions"]["threads"])
        return TIMES

    def loads(self):
        """Least and largest load average while measuring; None without points."""
        loads = [p["load_average"] for p in self.points]
        return (min(loads), max(loads)) if loads else None

    def is_busy(self):
        """Whether other work kept the machine busy while measuring."""
        return bool(self.points) and self.loads()[1] > BUSY * int(self.header["versions"]["threads"])

    def time(self):
        """The time that is drawn unless the reader chooses: processor time where other work lengthened the clock's."""
        return "processor" if self.is_busy() and "processor" in self.times else "median"

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


def counted(number, noun):
    return f"{number} {noun}{'' if number == 1 else 's'}"


def errors(point, truth="own"):
    return point["errors"].get(truth)


def is_drawn(point, truth="own", metric="relMSE"):
    """No figure is drawn where the truth's own noise exceeds a tenth of the error, or without a time. Composites need whole
    pictures, whose truth may be noisier than that of the pixels that the irradiance is judged at."""
    judged = errors(point, truth)
    if judged is None or not judged["trusted"] or point["ms"] is None:
        return False
    return METRICS[metric][1] or judged.get("picture_trusted", True)


def value(point, metric="relMSE", truth="own"):
    """The error to be drawn; None where there is none or it is not to be drawn."""
    judged = errors(point, truth)
    if not is_drawn(point, truth, metric) or metric not in ("relMSE", "nrmse", "bias", "p99") and metric not in judged:
        return None
    result = METRICS[metric][2](judged)
    return result if result > 0.0 else None  # logarithmic axes


def front(points, metric="relMSE", truth="own", time="median"):
    """The points on the front, by rising time."""
    drawn = [p for p in points if value(p, metric, truth) is not None]
    return [drawn[i] for i in pareto_front([(p["ms"][time], value(p, metric, truth)) for p in drawn])]


def baseline(results, truth):
    """A setting whose error is drawn in every shared view, by which others are compared where theirs is not; None: none is."""
    complete = [group for group in by_setting(results).values()
                if len(group) == len(results.shared) and all(is_drawn(p, truth) for p in group)]
    named = [group for group in complete if "default" in group[0]["label"].split(", ")]
    return (named or complete or [None])[0]


def by_setting(results):
    groups = {}
    for view in results.shared:
        for point in results.of_view(view):
            groups.setdefault((point["technique"], point["settings"]), []).append(point)
    return groups


def means_over_views(results):
    """A point for each technique and setting that was measured in every shared view: geometric means of its times over these,
    and of its errors over the views where they are drawn. In the others it is taken to stand to the baseline as
    it does on the whole in those; with fewer than half of the views it is not drawn. Returns (points, left out)."""
    baselines = {truth: baseline(results, truth) for truth in TRUTHS}
    made, left = [], []
    for (technique, settings), group in by_setting(results).items():
        if len(group) < len(results.shared):
            left.append((technique, settings, "not measured in every view"))
            continue
        mean = {"id": f"mean/{technique}/{settings}", "technique": technique, "settings": settings,
                "label": group[0]["label"], "bounces": group[0]["bounces"], "ms": None, "errors": {}}
        if all(p["ms"] is not None for p in group):
            mean["ms"] = {time: geometric_mean([p["ms"][time] for p in group]) for time in results.times}
        for truth in TRUTHS:
            mean["errors"][truth] = mean_errors(group, truth, baselines[truth])
        own = mean["errors"]["own"]
        if own and not own["trusted"]:
            left.append((technique, settings, f"the truth is too noisy for it in {len(group) - own['views']} of {len(group)} views"))
        made.append(mean)
    return made, left


def mean_errors(group, truth, base):
    if any(errors(p, truth) is None for p in group):
        return None
    drawn = [p for p in group if is_drawn(p, truth)]
    mean = {"views": len(drawn), "trusted": 2 * len(drawn) >= len(group) and (len(drawn) == len(group) or base is not None)}
    if not mean["trusted"]:
        drawn = group  # for the table, in grey
    mean["picture_trusted"] = all(errors(p, truth).get("picture_trusted", True) for p in drawn)
    places = {(p["scene"], p["camera"]) for p in drawn}
    for metric, (_, _, read) in METRICS.items():
        if any(metric not in errors(p, truth) for p in group):
            continue
        log_of = lambda points: [math.log(max(read(errors(p, truth)), 1e-12)) for p in points]  # noqa: E731
        logs = sum(log_of(drawn)) / len(drawn)
        if len(drawn) < len(group):
            there = log_of([p for p in base if (p["scene"], p["camera"]) in places])
            everywhere = log_of(base)
            logs += sum(everywhere) / len(everywhere) - sum(there) / len(there)
        mean[metric] = math.exp(logs)
        if metric == "score":
            mean[metric] = 10.0 - mean[metric]
    return mean


def geometric_mean(values):
    return math.exp(sum(math.log(v) for v in values) / len(values))
