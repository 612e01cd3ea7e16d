"""What ambient occlusion from voxels (VAO) does to cone-traced light, by rows of cone_tracing_thesis.py: of it, how much is brightness alone,
what it costs where the light is right already, and the variant that counts only what cones have missed. Used by cone_tracing_thesis.py."""
import json

import numpy

import exr_planes
from cone_tracing_thesis_scores import NEAR, VAO
from thesis_factor import FACTORS, score, scores_of
from thesis_pictures import composite, encode, exposure_of
from thesis_setting import SCENES
from thesis_tables import percent

LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722])


def light_of(path):
    return exr_planes.read_planes(path, ("R", "G", "B"))


def shading_of(path):
    """(direct light, albedo / pi)."""
    planes = exr_planes.read_planes(path, [f"{layer}.{c}" for layer in ("direct", "albedo") for c in "RGB"])
    return planes[..., :3], planes[..., 3:] / numpy.pi


def vao_row(setting, row, everything):
    """Figures of a row with and without VAO, kept beside its picture."""
    technique, settings, _ = row
    plain, dimmed = setting.row(*row), setting.render(technique, [*settings, *VAO])
    kept = plain.with_suffix(".vao.json")
    if not kept.exists():
        direct, albedo = shading_of(setting.truth)
        truth, light, less = (light_of(p) for p in (setting.truth, plain, dimmed))
        exposure = exposure_of(composite(setting.truth))
        reference = encode(exposure * (direct + albedo * truth))
        at = albedo.any(axis=-1)
        all_light = light.sum(axis=-1)
        factor = numpy.where(all_light > 0, less.sum(axis=-1) / numpy.maximum(all_light, 1e-30), 1.0)[..., None]
        mean = less[at].mean() / light[at].mean()
        kept.write_text(json.dumps({
            "factor": mean,
            "alone": setting.figures(plain)["bias"], "after": setting.figures(dimmed)["bias"],
            "too_bright": float(((light - truth)[at] @ LUMINANCE > 0).mean()),
            "score": setting.figures(plain)["score"], "with": setting.figures(dimmed)["score"],
            "evenly": float(score(encode(exposure * (direct + albedo * mean * light)), reference)),
            "truth": float(score(encode(exposure * (direct + albedo * factor * truth)), reference)),
            "relMSE": [setting.figures(p)["relMSE"] for p in (plain, dimmed)]}))
    found = json.loads(kept.read_text())
    if "mode=sh2" in settings and (everything or setting.is_measured(technique, [*settings, *NEAR], False)):
        near = setting.figures(setting.render(technique, [*settings, *NEAR]))
        found.update(near=near["score"], near_bias=near["bias"], near_relMSE=near["relMSE"])
    return found


def vao_tables(rows, everything):
    """everything: what is not measured yet as well."""
    head = ["row", "source: VAO changes", "ours", "evenly", "near", "bias alone", "VAO leaves", "bias with", "near", "too bright alone",
            "truth x VAO", "relMSE alone", "with", "near"]
    lines = ["### What VAO does", ""]
    for scene, s in SCENES.items():
        for view in s["views"]:
            lines += [f"{s['title']}, {view}:", "", "| " + " | ".join(head) + " |", "| --- | " + " | ".join(["---:"] * (len(head) - 1)) + " |"]
            measured = rows.of(scene)
            for row in measured:
                if f"{row}, VAO" in measured:
                    lines.append(f"| {row} | " + " | ".join(cells_of(vao_row(rows.settings[scene, view], rows.rows[row], everything), rows.published[scene, view], row)) + " |")
            lines.append("")
    return lines


def cells_of(found, theirs, row):
    has = "near" in found
    return [f"{theirs[row + ', VAO'] - theirs[row]:+.2f}", f"{found['with'] - found['score']:+.2f}", f"{found['evenly'] - found['score']:+.2f}",
            f"{found['near'] - found['score']:+.2f}" if has else "", percent(found["alone"]), f"{100 * found['factor']:.0f} %",
            percent(found["after"]), percent(found["near_bias"]) if has else "", f"{100 * found['too_bright']:.0f} %", f"{found['truth']:.2f}",
            *(f"{r:.3g}" for r in found["relMSE"]), f"{found['near_relMSE']:.3g}" if has else ""]


def gain_tables(rows, shown):
    """What VAO changes of the score if all light of both rows were so many times as bright."""
    lines = ["### What VAO changes if all of the light were so many times as bright", "",
             "| | source | " + " | ".join(f"x {f:g}" for f in FACTORS) + " |", "| --- | " + " | ".join(["---:"] * (len(FACTORS) + 1)) + " |"]
    for scene, s in SCENES.items():
        for view in s["views"]:
            setting = rows.settings[scene, view]
            for row in shown:
                alone, dimmed = (scores_of(setting, setting.row(*rows.rows[r])) for r in (row, f"{row}, VAO"))
                theirs = rows.published[scene, view]
                lines.append(f"| {s['title']}, {view}: {row} | {theirs[row + ', VAO'] - theirs[row]:+.2f} | "
                             + " | ".join(f"{d - a:+.2f}" for a, d in zip(alone, dimmed)) + " |")
    return lines + [""]
