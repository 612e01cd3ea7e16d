"""The two models of the planner (docs/planner.md), fitted to planner_data.json: what a candidate takes, how wrong it is, and what is chosen.

Arrays are views x candidates; `None` in the data (not measured) is NaN here.
"""
import json
import math
import pathlib

import numpy as np

DATA = pathlib.Path(__file__).with_name("planner_data.json")
PROBES = ["indirectShare", "fluxOnScreen", "fluxConcentration", "depthComplexity", "extent", "albedo", "facing", "hidden"]
FLOORS = np.array([1e-3, 1e-3, 1e-4, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3])
FACING = PROBES.index("facing")
COVERAGE = "coverage"  # the probe that tells times alone
LIMIT = 2.5  # deviations beyond which a probe counts no more
SAME = 1.02  # as in src/planner/planner.cpp: of errors so near to each other the quickest is taken
SAME_TIME = 1.05  # likewise: where nothing fits
BUDGETS = [4, 8, 16, 33, 66]  # ms
SKIES = np.linspace(0.0, 1.0, 5)  # what a pixel without a surface may take, of what one with takes
RIDGES = [3.0, 10.0, 30.0, 100.0, 300.0]
MADE = 1.0  # what a made-up scene weighs in the error's fit beside a real one


class Data:
    def __init__(self, path=DATA):
        raw = json.loads(path.read_text(encoding="utf-8"))
        self.raw = raw
        self.candidates = [(c["technique"], c["settings"]) for c in raw["candidates"]]
        self.views = raw["views"]
        self.error = np.array([[np.nan if e is None else e for e in row] for row in raw["errors"]])
        self.ms = np.array([[np.nan if t is None else t for t in row] for row in raw["ms"]])
        self.log = np.log10(self.error)
        self.probes = np.array([[view["probes"][name] for name in PROBES] for view in self.views])
        self.coverage = np.array([view["probes"][COVERAGE] for view in self.views])
        # A scene and its other edition hold out each other: a box seen in training is no unseen scene.
        self.scene = np.array([{"cornell_original": "cornell"}.get(v["scene"], v["scene"]) for v in self.views])
        # Made-up scenes, of which errors alone are known, and of some candidates only: the error model learns from them, nothing is judged by them.
        self.madeLog = np.log10(np.array([[np.nan if e is None else e for e in row] for row in raw["made_errors"]]))
        self.madeProbes = np.array([[view["probes"][name] for name in PROBES] for view in raw["made_views"]])
        # What a frame at rest takes of one in which light is read, of the views and candidates where that is measured.
        self.rest = np.full_like(self.ms, np.nan)
        for view in raw.get("rest_shares", []):
            v = next(i for i, w in enumerate(self.views) if (w["scene"], w["camera"]) == (view["scene"], view["camera"]))
            self.rest[v] = [np.nan if s is None else s for s in view["shares"]]
        self.mega = {"pixels": raw["size"][0] * raw["size"][1] * 1e-6, "texels": raw["rsm_texels"] * 1e-6}

    def names(self):
        return [technique + (" " + settings if settings else "") for technique, settings in self.candidates]

    def scenes(self):
        return list(dict.fromkeys(self.scene))


# ------------------------------------------------------------------------------------------- time

def non_negative(matrix, values):
    """Least relative squares with no negative coefficient: columns whose coefficient would be negative leave one by one."""
    matrix, values = matrix / values[:, None], np.ones(len(values))
    active = list(range(matrix.shape[1]))
    while True:
        solution = np.linalg.lstsq(matrix[:, active], values, rcond=None)[0]
        if (solution >= 0).all() or len(active) == 1:
            break
        del active[int(np.argmin(solution))]
    result = np.zeros(matrix.shape[1])
    result[active] = np.maximum(solution, 0.0)
    return result


def fit_costs(data, rows):
    """cost[6] of every candidate, from the views `rows`: fixed, by pixel with a surface, by triangle, by texel of RSMs, by such pixel where all
    pairs face each other, all by million; and what a pixel of sky takes, as a share, alike for all of a technique. What is fixed and what grows with pixels is parted by the candidates that were
    measured at other sizes (the nearest in time of the same technique stands for the others); texels by the ones at other RSM sizes."""
    fits = np.array([fit_with_sky(data, rows, sky, fixed_shares(data, sky)) for sky in SKIES])
    off = np.array([np.log(predict_ms(data, fit, rows) / data.ms[rows]) ** 2 for fit in fits])
    result = np.zeros_like(fits[0])
    for technique in dict.fromkeys(t for t, _ in data.candidates):
        of = [c for c, (t, _) in enumerate(data.candidates) if t == technique]
        result[of] = fits[np.argmin(np.nanmedian(off[:, :, of].mean(axis=1), axis=1)), of]
    return result


def fit_with_sky(data, rows, sky, fixed):
    facing, lit = data.probes[rows, FACING], sky + (1.0 - sky) * data.coverage[rows]
    triangles = np.array([data.views[v]["triangles"] * 1e-6 for v in rows])
    texel = data.raw["ms_per_megatexel"]
    costs = np.zeros((len(data.candidates), 6))
    for c, (technique, _) in enumerate(data.candidates):
        known = ~np.isnan(data.ms[rows, c])
        if known.sum() < 3:
            continue
        perTexel = texel if needs_light(technique, data.candidates[c][1]) else 0.0
        rest = data.ms[rows, c][known] - perTexel * data.mega["texels"]
        share = fixed[c]
        # One column for what is fixed and what every pixel takes, parted by `share`.
        matrix = np.stack([share + (1.0 - share) * lit[known], triangles[known] * draws_geometry(technique, data.candidates[c][1]),
                           facing[known] * lit[known]], axis=1)
        same, byTriangle, byFacing = robust(matrix, rest)
        pixels = data.mega["pixels"]
        costs[c] = [share * same, (1.0 - share) * same / pixels, byTriangle, perTexel, byFacing / pixels, sky]
    return costs


def robust(matrix, values):
    """Leaves out what lies more than half off: frames that other work fell into."""
    kept = np.arange(len(values))
    for _ in range(3):
        solution = non_negative(matrix[kept], values[kept])
        ratio = values / (matrix @ solution)
        kept = np.where((ratio < 1.5) & (ratio > 1 / 1.5))[0]
    return solution


def fixed_shares(data, sky):
    """Of what each candidate takes in a view of the usual size that is all surfaces what does not grow with the pixels."""
    measured = {}
    for entry in data.raw["sizes"]:
        scale = entry["size"][0] * entry["size"][1] * 1e-6 / data.mega["pixels"]
        view = next(v for v, w in enumerate(data.views) if (w["scene"], w["camera"]) == (entry["scene"], entry["camera"]))
        for c, ms in enumerate(entry["ms"]):
            if ms is not None:
                measured.setdefault(c, []).append((view, scale, ms))
    shares = {}
    tried = np.linspace(0.0, 0.9, 181)[:, None]
    for c, points in measured.items():
        # ms / ms(usual size) = speed (share + (1 - share) lit scale) / (share + (1 - share) lit); speed: of the machine at that hour
        lit, scale = sky + (1.0 - sky) * data.coverage[[p[0] for p in points]], np.array([p[1] for p in points])
        ratio = np.array([p[2] / data.ms[p[0], c] for p in points])
        shape = (tried + (1.0 - tried) * lit * scale) / (tried + (1.0 - tried) * lit)
        speed = (shape @ ratio / (shape ** 2).sum(axis=1))[:, None]
        shares[c] = float(tried[np.argmin(((speed * shape - ratio) ** 2).sum(axis=1)), 0])
    usual = np.nanmedian(data.ms, axis=0)
    result = np.zeros(len(data.candidates))
    for c, (technique, _) in enumerate(data.candidates):
        kin = [k for k in shares if data.candidates[k][0] == technique] or list(shares)
        result[c] = shares[c] if c in shares else shares[min(kin, key=lambda k: abs(math.log(usual[k] / usual[c])))]
    return result


def needs_light(technique, settings):
    return technique in ("rsm", "ssvp", "lpv", "cone_tracing") or "second=" in settings


def draws_geometry(technique, settings):
    return technique in ("ssvp", "lpv", "cone_tracing") or "voxel" in settings or "second=" in settings and "second=rsm" not in settings


def predict_ms(data, costs, rows):
    triangles = np.array([data.views[v]["triangles"] * 1e-6 for v in rows])[:, None]
    fixed, byPixel, byTriangle, byTexel, byFacing, sky = costs.T
    lit = data.mega["pixels"] * (sky + (1.0 - sky) * data.coverage[rows][:, None])
    return fixed + (byPixel + byFacing * data.probes[rows, FACING][:, None]) * lit + byTriangle * triangles + byTexel * data.mega["texels"]


def saved_at_rest(data, rows):
    """Milliseconds that each candidate does not take at rest, the median of what is measured in `rows` of candidates with the same light: what is kept is the world's, alike in all
    views. 0 of what has nothing to keep."""
    saved = (data.ms * (1.0 - data.rest))[rows]
    known = {}
    for c, of in enumerate(saved.T):  # NaN where it was not measured
        known.setdefault(light_of(data.candidates[c]), []).extend(of[~np.isnan(of)])
    return np.array([max(float(np.median(known[light_of(c)] or [0.0])), 0.0) if needs_light(*c) else 0.0 for c in data.candidates])


def keeps_light(technique, settings):
    """Whether nothing of the world is made again at rest; else maps alone are not read again."""
    return technique == "ssvp" and "sampling=view" not in settings and "voxel" not in settings


def light_of(candidate):
    """What is the same for all that keep the same at rest: their VPLs, clusters and maps, or the reading of light maps."""
    if not keeps_light(*candidate):
        return "reading"
    return " ".join(s for s in candidate[1].replace("careful", "strict").split() if not s.startswith(("resolution=", "interleave=")))


def at_rest(data, ms):
    """Times of all views and candidates at rest: measured ones less what is saved at the median (single sittings are off by a tenth and more), and predicted ones, `ms`, a view's
    scene left out."""
    predicted = ms.copy()
    for scene in data.scenes():
        predicted[data.scene == scene] -= saved_at_rest(data, np.where(data.scene != scene)[0])
    return data.ms - saved_at_rest(data, np.arange(len(data.views))), predicted


def fit_rest(data, costs, rows):
    """rest[2] of every candidate: milliseconds saved beyond what texels take that are not read (less than 0 where texels take more than is saved: by the fit), and the share of
    texels that is read all the same."""
    saved, texels = saved_at_rest(data, rows), costs[:, 3] * data.mega["texels"]
    reads = np.array([needs_light(*c) for c in data.candidates])
    keeps = np.array([keeps_light(*c) for c in data.candidates])
    share = np.clip(1.0 - saved / np.where(texels > 0.0, texels, np.inf), 0.0, 1.0)
    return np.stack([np.where(keeps, saved - texels, 0.0), np.where(keeps, 0.0, np.where(reads, share, 1.0))], axis=1)


# ------------------------------------------------------------------------------------------ error

class ErrorModel:
    """log10 relMSE = mean + slopes . z, of the candidates `columns` (NaN of the others), from the views `rows` and all made-up scenes. One part
    of the slopes is the view's, alike for all candidates; the other tells candidates from each other: two ridges (Hoerl and Kennard 1970)."""

    def __init__(self, data, rows, columns, ridge, ofView):
        probes = np.concatenate([data.probes[rows], data.madeProbes])
        log = np.concatenate([data.log[np.ix_(rows, columns)], data.madeLog[:, columns]])
        weights = np.concatenate([self.weights(data, rows), np.full(len(data.madeLog), MADE)])
        raw = np.log10(np.maximum(probes, FLOORS))
        self.mean = np.average(raw, axis=0, weights=weights)
        self.deviation = np.maximum(np.sqrt(np.average((raw - self.mean) ** 2, axis=0, weights=weights)), 0.05)
        z = self.standardised(probes)
        self.means = np.full(len(data.candidates), np.nan)
        self.slopes = np.full((len(PROBES), len(data.candidates)), np.nan)
        self.means[columns] = weights @ log / weights.sum()
        rest = log - self.means[columns]
        view = rest.mean(axis=1, keepdims=True)
        weighted = z * weights[:, None]

        def shrunk(values, by):
            return np.linalg.solve(weighted.T @ z + by * np.eye(len(PROBES)), weighted.T @ values)

        self.slopes[:, columns] = shrunk(rest - view, ridge)
        if math.isfinite(ofView):
            self.slopes[:, columns] += shrunk(view, ofView)

    @staticmethod
    def weights(data, rows):
        """Scenes count alike, however many cameras they have."""
        scenes = data.scene[rows]
        return np.array([1.0 / (scenes == s).sum() for s in scenes])

    def standardised(self, probes):
        z = (np.log10(np.maximum(probes, FLOORS)) - self.mean) / self.deviation
        return np.clip(z, -LIMIT, LIMIT)

    def predict(self, probes):
        return self.means + self.standardised(probes) @ self.slopes


def choose(ms, log, budget):
    """Index of the candidate that planner.cpp chooses: predicted times and errors of one view."""
    affordable = np.where(ms <= max(budget, SAME_TIME * ms.min() if ms.min() > budget else 0.0))[0]
    near = affordable[log[affordable] <= log[affordable].min() + math.log10(SAME)]
    return int(near[np.argmin(ms[near])])


def reach(ms, log, target):
    """Likewise without a budget, with a target of relMSE: the cheapest predicted to reach it, None where none is."""
    able = np.where(log <= math.log10(target))[0]
    return int(able[np.argmin(ms[able])]) if len(able) else None


def outcomes(data, ms, log, rows, allowed):
    """(view, budget, chosen, best, ratio of their errors) of each view of `rows`, by predictions `ms` and `log`."""
    result = []
    for i, v in enumerate(rows):
        for budget in BUDGETS:
            fits = np.where(data.ms[v] <= budget)[0]
            chosen = allowed[choose(ms[i][allowed], log[i][allowed], budget)]
            # Where nothing fits, the quickest is the best that can be had.
            best = fits[np.argmin(data.log[v, fits])] if len(fits) else int(np.nanargmin(data.ms[v]))
            result.append((v, budget, chosen, int(best), 10 ** (data.log[v, chosen] - data.log[v, best]), bool(len(fits))))
    return result


def held_out(data, rows, columns, ridge, ofView):
    """log10 errors of every view of `rows` by models that knew none of its scene."""
    log = np.full((len(rows), len(data.candidates)), np.nan)
    for scene in dict.fromkeys(data.scene[rows]):
        outside = data.scene[rows] == scene
        log[outside] = ErrorModel(data, rows[~outside], columns, ridge, ofView).predict(data.probes[rows[outside]])
    return log


def strengths(data, rows, columns):
    """The two ridges that predict best what is the candidates' and what is the view's, one scene of `rows` after the other left out. Not by what
    is chosen: that is settled by a few views and leaps with each that is added."""
    def off(ridge, ofView):
        return (held_out(data, rows, columns, ridge, ofView) - data.log[rows])[:, columns]

    def misses_candidates(ridge):
        each = off(ridge, math.inf)
        return float(np.mean((each - each.mean(axis=1, keepdims=True)) ** 2))

    return min(RIDGES, key=misses_candidates), min(RIDGES + [math.inf], key=lambda ofView: float(np.mean(off(RIDGES[-1], ofView).mean(axis=1) ** 2)))


def leave_scenes_out(data, allowed):
    """Times and errors of each view by models without its scene; nested: their ridges are chosen among the other scenes."""
    everything = np.arange(len(data.views))
    log, ms = (np.full((len(everything), len(data.candidates)), np.nan) for _ in range(2))
    for scene in data.scenes():
        inside, outside = everything[data.scene != scene], everything[data.scene == scene]
        log[outside] = ErrorModel(data, inside, allowed, *strengths(data, inside, allowed)).predict(data.probes[outside])
        ms[outside] = predict_ms(data, fit_costs(data, inside), outside)
    return ms, log
