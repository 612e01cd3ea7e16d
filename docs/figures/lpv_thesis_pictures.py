"""The pictures of docs/techniques/lpv_thesis.md: a few rows beside their truth, and what they are off by. Used by lpv_thesis.py."""
import numpy

import exr_planes
from lpv_thesis_scores import OURS, ROWS, SCENES

SHOWN = {"LPV 32": ROWS["LPV 32"], "LPV 32, SSAO": ROWS["LPV 32, SSAO"], "LPV 64": ROWS["LPV 64"], "sweep 32, 3 bounces": OURS["sweep 32, 3 bounces"]}
NESTED = "cascaded LPV 64"
KEY = 0.18       # log-average luminance of a picture at its exposure, as `lightwell compare` has it
DARKEST = 1e-4   # of the mean: a few nearly black pixels must not decide
FULL = 0.25      # of the screen's range: a difference that has full colour
WIDTH = 320      # of one picture


def write(settings, rows_of, folder):
    """rows_of(scene): the rows measured there; where cascades are, the finer ones are shown as well."""
    from PIL import Image

    lines = ["### Pictures", ""]
    for scene, s in SCENES.items():
        for view in s["views"]:
            setting = settings[scene, view]
            truth = composite(setting.truth)
            exposure = exposure_of(truth)
            columns = {**SHOWN, **({NESTED: ROWS[NESTED]} if NESTED in rows_of(scene) else {})}
            screens = [encode(exposure * composite(setting.row(*what))) for what in columns.values()]
            reference = encode(exposure * truth)
            upper = numpy.hstack([reference, *screens])
            lower = numpy.hstack([numpy.full_like(reference, 0.5), *(signed(screen - reference) for screen in screens)])
            picture = Image.fromarray((255 * numpy.vstack([upper, lower]).clip(0, 1) + 0.5).astype(numpy.uint8))
            height = round(2 * WIDTH * reference.shape[0] / reference.shape[1])
            picture.resize(((len(columns) + 1) * WIDTH, height), Image.Resampling.LANCZOS).save(folder / f"lpv_thesis_{scene}_{view}.jpg", quality=85)
            lines += [f"![{s['title']}, {view}](../images/lpv_thesis_{scene}_{view}.jpg)", ""]
    return lines + ["*Truth | " + " | ".join(SHOWN) + f"*, in Sponza *| {NESTED}*; "
                    "below, on the screen's scale, red where too bright and blue where too dark, full at "
                    f"{FULL:g} of its range.", ""]


def composite(path):
    names = [f"{layer}{c}" for layer in ("", "direct.", "albedo.") for c in "RGB"]
    planes = exr_planes.read_planes(path, names)
    return planes[..., 3:6] + planes[..., 6:9] / numpy.pi * planes[..., :3]


def exposure_of(light):
    luminance = light @ [0.2126, 0.7152, 0.0722]
    luminance = luminance[luminance > 0]
    return KEY / numpy.exp(numpy.log(numpy.maximum(luminance, DARKEST * luminance.mean())).mean())


def encode(light):
    """Reinhard's curve and sRGB's."""
    x = light / (1 + light)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * numpy.maximum(x, 1e-9) ** (1 / 2.4) - 0.055)


def signed(difference):
    """Mid grey for none."""
    share = (difference.mean(axis=-1) / FULL).clip(-1, 1)
    colour = numpy.where(share[..., None] > 0, [1.0, 0.1, 0.0], [0.0, 0.25, 1.0])
    return 0.5 + abs(share)[..., None] * (colour - 0.5)
