"""Pictures of a few rows beside their truth, and what they are off by. Used by lpv_thesis.py and cone_tracing_thesis.py."""
import numpy

import exr_planes
from thesis_setting import SCENES

KEY = 0.18       # log-average luminance of a picture at its exposure, as `lightwell compare` has it
DARKEST = 1e-4   # of the mean: a few nearly black pixels must not decide
FULL = 0.25      # of the screen's range: a difference that has full colour
WIDTH = 320      # of one picture


def write(settings, folder, name, shown, of_sponza):
    """shown: rows of every view, of_sponza: more of Sponza, as thesis_tables has them."""
    from PIL import Image

    lines = ["### Pictures", ""]
    for scene, s in SCENES.items():
        for view in s["views"]:
            setting = settings[scene, view]
            truth = composite(setting.truth)
            exposure = exposure_of(truth)
            columns = {**shown, **(of_sponza if scene == "sponza" else {})}
            screens = [encode(exposure * composite(setting.row(*what))) for what in columns.values()]
            reference = encode(exposure * truth)
            upper = numpy.hstack([reference, *screens])
            lower = numpy.hstack([numpy.full_like(reference, 0.5), *(signed(screen - reference) for screen in screens)])
            picture = Image.fromarray((255 * numpy.vstack([upper, lower]).clip(0, 1) + 0.5).astype(numpy.uint8))
            height = round(2 * WIDTH * reference.shape[0] / reference.shape[1])
            picture.resize(((len(columns) + 1) * WIDTH, height), Image.Resampling.LANCZOS).save(folder / f"{name}_{scene}_{view}.jpg", quality=85)
            lines += [f"![{s['title']}, {view}](../images/{name}_{scene}_{view}.jpg)", ""]
    more = f", in Sponza *| {' | '.join(of_sponza)}*" if of_sponza else ""
    return lines + ["*Truth | " + " | ".join(shown) + f"*{more}; "
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
