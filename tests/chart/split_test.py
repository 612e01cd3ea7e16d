"""`lightwell split` in its short form: shares that add up, visibility's above all, resumption, report.

Usage: split_test.py PROGRAM [unittest options]. Python's standard library only; the report's own case is left out where
matplotlib or D3 is missing.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else ""
SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "samples", "scenes")
SHARES = ["model", "resolution", "visibility", "sampling", "bounding"]
# rsm's defaults on cornell against one bounce, two patterns, as measured when the split was new: what is left with exact
# visibility, and with that and without the patterns' noise (truth's own noise 1e-3 in it). More is a regression.
WITH_VISIBILITY, WITHOUT_NOISE = 0.0186, 0.0106
SLACK = 1.25  # two patterns tell the noise to a fifth of it


class Split(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = cls.temporary.name
        cls.split("--quick", "--scenes", "cornell", "--techniques", "rsm", "--patterns", "2", "--no-report")
        cls.points = cls.read()["points"]

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def split(cls, *arguments, code=0):
        command = [PROGRAM, "split", *arguments, "--out", cls.folder, "--truth-cache", os.path.join(cls.folder, "truths")]
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
        if done.returncode != code:
            raise AssertionError(f"{done.returncode}: {done.stderr}")
        return done.stderr

    @classmethod
    def read(cls):
        with open(os.path.join(cls.folder, "split.json"), encoding="utf-8") as file:
            return json.load(file)

    def test_shares_add_up_to_the_error(self):
        self.assertEqual([p["label"] for p in self.points], ["default", "Dachsbacher 2005"])
        for point in self.points:
            self.assertEqual(list(point["shares"]), SHARES)
            self.assertAlmostEqual(sum(point["shares"].values()), point["total"], delta=1e-9)
            self.assertEqual((point["patterns"], point["bounces"], point["truth_of_all_bounces"]), (2, 1, False))
            self.assertEqual(point["shares"]["model"], 0.0)  # one bounce against one bounce

    def test_visibility_is_the_largest_share_in_cornell(self):
        shares = self.points[0]["shares"]
        self.assertGreater(shares["visibility"], 0.9 * self.points[0]["total"])
        self.assertLess(shares["sampling"] + shares["bounding"], SLACK * WITH_VISIBILITY)
        self.assertLess(shares["bounding"], SLACK * WITHOUT_NOISE)

    def test_only_its_own_resolution_is_replaced(self):
        self.split("--quick", "--scenes", "cornell", "--techniques", "rsm", "--patterns", "2", "--no-report", "--only",
                   "vpls=64", "interleave=1", "resolution=full", "sampling=uniform", "visibility=none")
        point = self.read()["points"][-1]
        self.assertEqual(point["settings"], "vpls=64 sampling=uniform interleave=1")
        self.assertTrue(0 < point["vpls"] <= 64)  # those that fell on lit texels
        # The same kernels twice: no difference at all.
        self.assertEqual(point["shares"]["resolution"], 0.0)

    def test_the_same_command_measures_nothing_again(self):
        before = self.read()["points"]
        self.split("--quick", "--scenes", "cornell", "--techniques", "rsm", "--patterns", "2", "--no-report")
        self.assertEqual(self.read()["points"][:2], before[:2])

    def test_wrong_arguments(self):
        self.assertIn("valid: rsm", self.split("--techniques", "nothing", code=2))
        self.assertIn("--cameras", self.split("--cameras", "some", code=2))
        self.split("--patterns", "1", code=2)
        self.assertIn("--noise", self.split("--noise", "0", code=2))
        for seconds in ("nan", "-1", "long"):
            self.assertIn("--truth-seconds", self.split("--truth-seconds=" + seconds, code=2))
        # Before anything is measured, not after the scenes before it.
        self.assertIn("no scene of this name", self.split("--quick", "--scenes", "cornell", "nowhere", "--size", "64x36", code=2))
        self.assertNotIn([64, 36], [p["size"] for p in self.read()["points"]])
        with tempfile.TemporaryDirectory() as folder:
            twin = os.path.join(folder, "cornell.json")
            shutil.copy(os.path.join(SCENES, "cornell.json"), twin)
            self.assertIn("another name", self.split("--quick", "--scenes", "cornell", twin, code=2))
        self.assertIn("memory", self.split("--quick", "--size", "16384x16384", code=2))
        note = self.split("--quick", "--scenes", "cornell", "--techniques", "rival", "--no-report")
        self.assertIn('rival has no debug view "vpls"', note)

    def test_nothing_is_traced_where_nothing_can_be_split(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([PROGRAM, "split", "--scenes", "cornell", "--techniques", "rival", "--no-report", "--size", "640x360",
                                   "--out", folder, "--truth-cache", os.path.join(folder, "truths")],
                                  capture_output=True, text=True, timeout=170)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertFalse(os.path.exists(os.path.join(folder, "truths")))

    def test_a_dark_scene_is_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(SCENES, "cornell.json"), encoding="utf-8") as file:
                scene = json.load(file)
            scene["lights"] = []
            dark = os.path.join(folder, "dark.json")
            with open(dark, "w", encoding="utf-8") as file:
                json.dump(scene, file)
            done = subprocess.run([PROGRAM, "split", "--quick", "--scenes", dark, "cornell", "--size", "32x18", "--no-report", "--noise",
                                   "0.1", "--patterns", "2", "--out", folder, "--truth-cache", os.path.join(folder, "truths")],
                                  capture_output=True, text=True, timeout=170)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("dark/front has no indirect light", done.stderr)
            with open(os.path.join(folder, "split.json"), encoding="utf-8") as file:
                self.assertEqual({p["scene"] for p in json.load(file)["points"]}, {"cornell"})

    def test_a_missing_folder_is_not_made_for_its_report(self):
        with tempfile.TemporaryDirectory() as folder:
            missing = os.path.join(folder, "missing")
            done = subprocess.run([PROGRAM, "split", "--report-only", "--out", missing], capture_output=True, text=True, timeout=170)
            self.assertNotEqual(done.returncode, 0)
            self.assertFalse(os.path.exists(missing))

    def test_a_file_of_another_format_is_refused(self):
        ours = '"format": "lightwell-split 1"'
        for text in ('{"format": "lightwell-chart 1", "header": {}, "views": [], "points": []}', '{"format": 3}', "{",
                     "{%s, \"views\": [], \"points\": []}" % ours, "{%s, \"header\": {}, \"views\": {}, \"points\": []}" % ours,
                     "{%s, \"header\": {}, \"views\": [], \"points\": [{\"id\": \"a\"}]}" % ours):
            with self.subTest(text), tempfile.TemporaryDirectory() as folder:
                with open(os.path.join(folder, "split.json"), "w", encoding="utf-8") as file:
                    file.write(text)
                done = subprocess.run([PROGRAM, "split", "--quick", "--out", folder], capture_output=True, text=True, timeout=170)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn('expected results in the format "lightwell-split 1"', done.stderr)

    def test_report(self):
        done = subprocess.run([PROGRAM, "split", "--report-only", "--out", self.folder], capture_output=True, text=True, timeout=120)
        if done.returncode and ("matplotlib" in done.stderr or "D3" in done.stderr):
            self.skipTest(done.stderr.strip())
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(os.path.join(self.folder, "report.html"), encoding="utf-8") as file:
            text = file.read()
        self.assertIn("Where the error comes from", text)
        self.assertIn("data:image/svg+xml;base64,", text)
        self.assertGreater(os.path.getsize(os.path.join(self.folder, "split.png")), 5000)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
