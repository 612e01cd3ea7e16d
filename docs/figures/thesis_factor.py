"""The score if all light of the rows were so many times as bright, which the source does not calibrate. Used by lpv_thesis.py and
cone_tracing_thesis.py.

The score is computed here anew, in numpy (docs/accuracy.md); at factor 1 it is that of `lightwell compare` to the last digit shown.
"""
import json

import numpy
from scipy.ndimage import correlate1d
from scipy.stats import spearmanr

import exr_planes
from thesis_pictures import composite, encode, exposure_of
from thesis_setting import SCENES

FACTORS = [0.125, 0.25, 0.5, 0.71, 1.0, 1.41, 2.0]
WINDOW = numpy.exp(-0.5 * (numpy.arange(-5, 6) / 1.5) ** 2)
WINDOW /= WINDOW.sum()


def blurred(planes):
    return correlate1d(correlate1d(planes, WINDOW, axis=0, mode="mirror"), WINDOW, axis=1, mode="mirror")


def score(x, y):
    """Pictures in [0,1] with constants of 0 .. 255, SSIM to the power of 1000."""
    c1, c2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    mean_x, mean_y = blurred(x), blurred(y)
    varied = blurred((x - y) ** 2) - (mean_x - mean_y) ** 2
    variances = blurred(x * x + y * y) - mean_x ** 2 - mean_y ** 2
    ssim = (1 - (mean_x - mean_y) ** 2 / (mean_x ** 2 + mean_y ** 2 + c1)) * (1 - varied / (variances + c2))
    lit = x.any(axis=-1) | y.any(axis=-1)
    return 10 * (numpy.maximum(ssim, 0) ** 1000)[lit].mean()


def scores_of(setting, picture):
    """By factor; kept beside the picture."""
    kept = picture.with_suffix(".factors.json")
    if not kept.exists():
        truth = composite(setting.truth)
        exposure = exposure_of(truth)
        reference = encode(exposure * truth)
        planes = exr_planes.read_planes(picture, [f"{layer}{c}" for layer in ("", "direct.", "albedo.") for c in "RGB"])
        indirect = planes[..., 6:9] / numpy.pi * planes[..., :3]
        kept.write_text(json.dumps([score(encode(exposure * (planes[..., 3:6] + f * indirect)), reference) for f in FACTORS]))
    return json.loads(kept.read_text())


def lines_of(rows, shown):
    """rows: thesis_tables.Rows; the scores of those in `shown` are written out."""
    lines = ["### If all of the light were so many times as bright", "",
             "| | " + " | ".join(f"x {f:g}" for f in FACTORS) + " |", "| --- | " + " | ".join(["---:"] * len(FACTORS)) + " |"]
    for scene, s in SCENES.items():
        for view in s["views"]:
            setting, measured = rows.settings[scene, view], rows.of(scene)
            table = {row: scores_of(setting, setting.row(*rows.rows[row])) for row in measured}
            for row in shown:
                lines.append(f"| {s['title']}, {view}: {row} | " + " | ".join(f"{x:.2f}" for x in table[row]) + " |")
            theirs = [rows.published[scene, view][row] for row in measured]
            ranks = [spearmanr(theirs, [table[row][i] for row in measured])[0] for i in range(len(FACTORS))]
            lines.append(f"| *Spearman over its {len(measured)} rows* | " + " | ".join(f"{r:+.2f}" for r in ranks) + " |")
    return lines + [""]
