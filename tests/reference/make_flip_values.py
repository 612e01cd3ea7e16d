"""Writes flip_values.h: LDR-FLIP at 67 pixels per degree by its authors' package.

    python3 -m venv venv && venv/bin/pip install flip-evaluator==1.7 numpy
    venv/bin/python tests/reference/make_flip_values.py
"""
import importlib.metadata
import os

import flip_evaluator as flip
import numpy as np

from metric_patterns import PROBES, pairs, write_header

rows = []
for p, d, reference, test in pairs():
    error, mean, parameters = flip.evaluate(reference.astype(np.float32), test.astype(np.float32), "LDR",
                                            inputsRGB=True, applyMagma=False, parameters={"ppd": 67.0})
    error = np.asarray(error).reshape(reference.shape[0], reference.shape[1], -1)[:, :, 0]
    rows.append((p, d, [mean], [error[y, x] for x, y in PROBES]))
write_header(os.path.join(os.path.dirname(os.path.abspath(__file__)), "flip_values.h"), "make_flip_values.py",
             "flip-evaluator " + importlib.metadata.version("flip-evaluator"), "flip_values", ["mean"], rows)
