"""Writes ssim_values.h: SSIM by scikit-image with the window of Wang et al. (11x11, sigma 1.5).

    python3 -m venv venv && venv/bin/pip install scikit-image==0.26.0 numpy
    venv/bin/python tests/reference/make_ssim_values.py

`mean` is the package's own value (windows wholly inside), `score` and `score255` are means over its whole
map of max(SSIM, 0)^1000, times ten, with the constants for 0..255 and for the values' own range.
"""
import importlib.metadata
import os

import numpy as np
from skimage.metrics import structural_similarity

from metric_patterns import PROBES, pairs, write_header


def similarity(x, y, data_range):
    return structural_similarity(x, y, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
                                 data_range=data_range, channel_axis=2, full=True)


rows = []
for p, d, reference, test in pairs():
    mean, full = similarity(reference, test, 1.0)
    score255 = 10.0 * np.mean(np.maximum(full, 0.0) ** 1000)
    score = 10.0 * np.mean(np.maximum(similarity(reference, test, 255.0)[1], 0.0) ** 1000)
    probes = full.mean(axis=2)
    rows.append((p, d, [mean, score, score255], [probes[y, x] for x, y in PROBES]))
write_header(os.path.join(os.path.dirname(os.path.abspath(__file__)), "ssim_values.h"), "make_ssim_values.py",
             "scikit-image " + importlib.metadata.version("scikit-image"), "ssim_values",
             ["mean", "score", "score255"], rows)
