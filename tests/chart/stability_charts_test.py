"""What the report makes of a stability run's figures: levels, tables, plots, pictures. No program is run.

Usage: stability_charts_test.py [unittest options]. Python's standard library only; cases that draw go on in the
system's interpreter, or are left out, where matplotlib is missing.
"""
import base64
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "samples", "chart"))
import report  # noqa: E402
import stability_results as stability  # noqa: E402
import stability_section as section  # noqa: E402

HAS_MATPLOTLIB = importlib.util.find_spec("matplotlib") is not None
PIXEL = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNgAAAAAgABSK+kcQAAAABJRU5ErkJggg==")


def made_frame(t, leak):
    return {"error": 0.1, "flicker": 0.02 if t else None, "ghost": None, "leak": 0.001 * t if leak else None, "drift": 0.001 * t,
            "spike": 0.0, "floors": {"error": 0.01, "flicker": 0.001 if t else None, "ghost": None, "leak": None, "drift": 0.0,
                                     "spike": 0.0},
            "relMSE": 0.2, "nrmse": 0.3, "bias": -0.1, "noise": 1e-3, "ms": 2.0}


def made_result(technique, sequence, leak=None, **changes):
    name = f"{technique}_{sequence}"
    result = {"id": f"{technique}/{sequence}", "key": "k", "technique": technique, "sequence": sequence, "settings": "defaults",
              "parameters": {}, "bounces": 1, "device": None, "build": "b", "load_average": 0.5,
              "indices": {"error": 0.1, "flicker": 0.02, "ghost": None, "leak": leak, "drift": 0.5, "spike": 0.0},
              "floors": {"error": 0.01, "flicker": 0.001, "ghost": None, "leak": 0.0, "drift": 0.001, "spike": 0.0},
              "errors": {"relMSE": 0.2, "nrmse": 0.3, "bias": -0.05},
              "error_floors": {"relMSE": 1e-3, "nrmse": 0.02, "bias": 0.001},
              "not_finite": 0, "largest": 3.0, "is_dark_truth": False, "passes": True, "worst_frame": 2,
              "worst_reason": "drift", "frames": [made_frame(t, leak is not None) for t in range(4)],
              "images": {kind: f"images/{name}_{kind}.png" for kind in ("picture", "truth", "error", "triptych")}}
    result.update(changes)
    return result


def made_sequence(name, sweeps="", failure="what fails"):
    return {"id": name, "failure": failure, "frames": 4, "size": [8, 8], "scale": 1.0, "sweeps": sweeps,
            "truth": "traced", "samples": 32, "values": [0.3, 0.1, 0.01, 0.001] if sweeps else [0, 0, 0, 0],
            "sizes": [[8, 8], [8, 8], [4, 4], [4, 4]], "cuts": [0, 2]}


def made_data(results, sequences):
    return {"format": stability.FORMAT, "sequences": sequences, "results": results,
            "header": {"written": "2000-01-01 00:00:00 UTC", "size": [8, 8], "frames": 4, "quick": True, "build": "b",
                       "versions": {"lightwell": "1", "threads": "2"}, "techniques": ["t"], "device": None}}


class Levels(unittest.TestCase):
    def test_by_what_is_noticed(self):
        noticed = stability.INDICES["flicker"][1]
        for value, expected in ((None, "none"), (0.0, "exact"), (-0.1, "exact"), (0.9 * noticed, "quiet"), (1.1 * noticed, "seen"),
                                (4.1 * noticed, "bad")):
            self.assertEqual(stability.level("flicker", value, 0.0), expected, value)
        self.assertEqual(stability.level("bias", -0.2, 0.0), "seen")  # errors that have a sign count by their size

    def test_noise_hides_a_figure_unless_both_are_small(self):
        self.assertEqual(stability.level("flicker", 0.06, 0.02), "noisy")
        self.assertEqual(stability.level("flicker", 0.1, 0.02), "seen")
        self.assertEqual(stability.level("flicker", 0.004, 0.004), "quiet")
        self.assertEqual(stability.level("flicker", 0.004, 0.03), "noisy")
        self.assertEqual(stability.level("nrmse", 0.4, 0.12), "seen")  # a tenth of its square
        self.assertEqual(stability.level("nrmse", 0.4, 0.13), "noisy")

    def test_three_digits(self):
        for value, expected in ((None, ""), (0.0, "0"), (1.23456, "1.23"), (123.456, "123"), (0.0123456, "0.0123"), (0.00123, "0.0012"),
                                (-0.25, "-0.250"), (4.2e-9, "4.2e-9"), (31234.0, "3.1e4")):
            self.assertEqual(stability.short(value), expected)


class InFolder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def write(self, data, pictures=True):
        (self.folder / "images").mkdir(exist_ok=True)
        for result in data["results"] if pictures else []:
            for name in result["images"].values():
                (self.folder / name).write_bytes(PIXEL)
        (self.folder / section.FILE).write_text(json.dumps(data), encoding="utf-8")


class Refused(InFolder):
    def test_what_is_no_result(self):
        for change, said in (({"format": "lightwell-stability 0"}, "lightwell-stability 1"), ({"results": None}, "malformed"),
                             ({"results": []}, "at least one technique")):
            self.write({**made_data([], [made_sequence("a")]), **change}, pictures=False)
            with self.assertRaisesRegex(report.ReportError, said):
                section.make(self.folder)


@unittest.skipUnless(HAS_MATPLOTLIB, "matplotlib is missing")
class Page(InFolder):
    def make(self, results, sequences, draws=False):
        """The section; without drawing, an empty plot for each sequence."""
        self.write(made_data(results, sequences))
        if draws:
            return section.make(self.folder)
        names = {s["id"]: "plot.svg" for s in sequences}
        (self.folder / "plot.svg").write_text("<svg/>", encoding="ascii")
        with mock.patch("stability_plots.write_plots", lambda results: names):
            return section.make(self.folder)

    def test_tables_hold_every_figure(self):
        made = self.make([made_result("t", "walls", leak=0.5), made_result("u", "walls"), made_result("t", "pan")],
                         [made_sequence("walls", sweeps="wall thickness, m"), made_sequence("pan"), made_sequence("unmeasured")])
        self.assertEqual(made.data["techniques"], ["t", "u"])
        self.assertEqual([s["id"] for s in made.data["sequences"]], ["walls", "pan"])
        cells = made.data["sequences"][0]["cells"]
        self.assertEqual([c["text"] for c in cells["leak"]], ["0.500", ""])
        self.assertEqual([c["level"] for c in cells["leak"]], ["bad", "none"])
        self.assertEqual(cells["flicker"][0], {"text": "0.0200", "floor": "0.0010", "level": "quiet", "value": 0.02})
        self.assertEqual(made.data["sequences"][1]["cells"]["flicker"][1]["level"], "none")  # u has no pan
        self.assertIn('<td class="number stability-bad" data-value="0.5">0.500<small>0.0010</small></td>', made.body)  # drift
        self.assertEqual(made.body.count("<tr><td><a href="), 3)
        self.assertNotIn("Light that must not be", made.body)

    def test_plots_and_pictures_are_in_the_page(self):
        made = self.make([made_result("t", "walls", leak=0.5)], [made_sequence("walls", sweeps="wall thickness, m")], draws=True)
        self.assertEqual(made.written, ["stability_walls.svg"])
        self.assertEqual(len(re.findall('src="data:image/png;base64,', made.body)), 3)
        self.assertEqual(len(re.findall('src="data:image/svg[+]xml;base64,', made.body)), 1)
        self.assertIn("t, frame 2, the worst by drift", made.body)
        self.assertIn("sweeps wall thickness, m: 0.3 to 0.001", made.body)
        svg = (self.folder / "stability_walls.svg").read_text(encoding="utf-8")
        self.assertIn("wall thickness, m", svg)
        first = svg
        self.make([made_result("t", "walls", leak=0.5)], [made_sequence("walls", sweeps="wall thickness, m")], draws=True)
        self.assertEqual(first, (self.folder / "stability_walls.svg").read_text(encoding="utf-8"))  # same figures, same file

    def test_the_page_is_one_file_that_loads_nothing(self):
        made = self.make([made_result("t", "walls", leak=0.5)], [made_sequence("walls", failure="<b>&")])
        text = report.page([("stability", made)], "/* d3 */")
        self.assertNotIn("<b>&", text)
        self.assertIn("&lt;b&gt;&amp;", text)
        for source in re.findall(r'(?:src|href)="([^"]*)"', text):
            self.assertTrue(source.startswith(("data:", "#")), source[:60])
        ids = re.findall(r'id="([^"]*)"', text)
        self.assertEqual(len(ids), len(set(ids)))

    def test_light_that_must_not_be(self):
        made = self.make([made_result("t", "none", is_dark_truth=True, passes=False, largest=0.25)],
                         [{**made_sequence("none"), "truth": "dark"}])
        self.assertIn("Light that must not be", made.body)
        self.assertIn("truth: dark", made.body)

    def test_a_missing_picture_is_named(self):
        self.write(made_data([made_result("t", "walls")], [made_sequence("walls")]), pictures=False)
        (self.folder / "plot.svg").write_text("<svg/>", encoding="ascii")
        with mock.patch("stability_plots.write_plots", lambda results: {"walls": "plot.svg"}), \
                self.assertRaisesRegex(report.ReportError, "t/walls: picture.*t_walls_picture.png"):
            section.make(self.folder)

    def test_no_pictures_are_no_error(self):
        made = self.make([made_result("t", "walls", images={})], [made_sequence("walls")])
        self.assertNotIn("stability-worst", made.body)


if __name__ == "__main__":
    SYSTEM = "/usr/bin/python3"
    if not HAS_MATPLOTLIB and os.path.exists(SYSTEM) and not os.path.samefile(SYSTEM, sys.executable) and \
            subprocess.call([SYSTEM, "-c", "import matplotlib"], stderr=subprocess.DEVNULL) == 0:
        os.execv(SYSTEM, [SYSTEM, *sys.argv])
    unittest.main()
