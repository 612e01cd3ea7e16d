"""`lightwell stability` in its short form: bounds that a regression crosses, floors, resumption, comparison.

Usage: stability_test.py PROGRAM [unittest options]. Python's standard library only.
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else ""

# What no run may exceed: measured when the catalogue was new, and a fifth more. Same input gives the same bits; other
# devices round, and a truth's noise is in both figures. A floor must be under a quarter of its bound.
BOUNDS = {
    "rsm/camera_pan": {"flicker": 0.134, "drift": 0.064, "spike": 0.46},
    "rsm/camera_cut": {"flicker": 1e-5, "drift": 1e-5},  # at rest the same bits, whatever the device
    "rsm/light_sweep_slow": {"flicker": 0.056, "spike": 0.1},  # twice what it was: its floor asks for that
    "rsm/thin_walls": {"leak": 0.124},
    "rival/camera_pan": {"spike": 0.12},
    "rival/camera_cut": {"flicker": 1e-5, "drift": 1e-5},
    "rival/light_sweep_slow": {"flicker": 0.056, "spike": 0.05},
    "rival/thin_walls": {"leak": 0.004},
}
LEAST_LEAK = 0.05  # rsm has no visibility: a thin wall that stops its light would be the catalogue's own fault
MOVEMENTS = ["camera_pan", "camera_dolly", "light_sweep_slow"]  # of any scene
INDICES = {"error", "flicker", "ghost", "leak", "drift", "spike"}
RESULT_KEYS = {"id", "key", "technique", "sequence", "settings", "parameters", "bounces", "device", "build", "load_average",
               "indices", "floors", "errors", "error_floors", "not_finite", "largest", "is_dark_truth", "passes", "worst_frame",
               "worst_reason", "frames", "images"}


class Stability(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.cache = os.path.join(cls.temporary.name, "truths")
        cls.folder = os.path.join(cls.temporary.name, "quick")
        process = cls.start("--quick", "--no-report")
        cls.output, errors = process.communicate(timeout=300)
        if process.returncode != 0:
            raise RuntimeError(errors)
        with open(os.path.join(cls.folder, "stability.json"), encoding="utf-8") as file:
            cls.data = json.load(file)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def start(cls, *arguments, folder=None):
        command = [PROGRAM, "stability", "--out", folder or cls.folder, "--truth-cache", cls.cache, *arguments]
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def run_again(self, *arguments, code=0, folder=None):
        process = self.start(*arguments, folder=folder)
        output, errors = process.communicate(timeout=300)
        self.assertEqual(process.returncode, code, errors)
        return output, errors

    def results(self):
        return {r["id"]: r for r in self.data["results"]}

    def test_bounds_and_floors(self):
        results = self.results()
        for name, bounds in BOUNDS.items():
            for index, bound in bounds.items():
                with self.subTest(result=name, index=index):
                    self.assertLess(results[name]["indices"][index], bound)
                    self.assertLess(results[name]["floors"][index], 0.25 * bound)

    def test_walls_leak_where_there_is_no_visibility(self):
        self.assertGreater(self.results()["rsm/thin_walls"]["indices"]["leak"], LEAST_LEAK)
        self.assertEqual(self.results()["rsm/thin_walls"]["floors"]["leak"], 0.0)

    def test_lightless_sequences_are_exactly_dark(self):
        for technique in ("rsm", "rival"):
            for sequence in ("empty_scene", "no_light"):
                result = self.results()[f"{technique}/{sequence}"]
                self.assertTrue(result["passes"])
                self.assertEqual((result["largest"], result["not_finite"]), (0.0, 0))

    def test_what_the_file_states(self):
        self.assertEqual(self.data["format"], "lightwell-stability 1")
        self.assertEqual(self.data["header"]["size"], [160, 90])
        self.assertEqual(self.data["header"]["frames"], 8)
        for result in self.data["results"]:
            self.assertEqual(RESULT_KEYS, set(result))
            self.assertEqual(INDICES, set(result["indices"]))
            self.assertEqual(len(result["frames"]), 8)
            for picture in result["images"].values():
                with open(os.path.join(self.folder, picture), "rb") as file:
                    self.assertEqual(file.read(8), b"\x89PNG\r\n\x1a\n")
            self.assertIn(result["sequence"], self.output)
        cut = next(s for s in self.data["sequences"] if s["id"] == "camera_cut")
        self.assertEqual(cut["cuts"], [4])
        walls = next(s for s in self.data["sequences"] if s["id"] == "thin_walls")
        self.assertAlmostEqual(walls["values"][0], 0.3)
        self.assertAlmostEqual(walls["values"][-1], 0.001)

    def test_a_second_run_measures_nothing(self):
        picture = os.path.join(self.folder, "images", "rsm_thin_walls_picture.png")
        before = os.stat(picture).st_mtime_ns
        self.run_again("--quick", "--no-report")
        self.assertEqual(before, os.stat(picture).st_mtime_ns)

    def test_only_what_is_missing_is_measured(self):
        folder = os.path.join(self.temporary.name, "missing")
        arguments = ("--no-report", "--size", "32x18", "--frames", "3", "--sequences", "camera_dolly")
        path, picture = os.path.join(folder, "stability.json"), os.path.join(folder, "images", "rsm_camera_dolly_picture.png")
        self.run_again(*arguments, "--techniques", "rsm", folder=folder)
        before = os.stat(picture).st_mtime_ns
        self.run_again(*arguments, "--techniques", "rsm", "rival", folder=folder)
        self.assertEqual(before, os.stat(picture).st_mtime_ns)
        with open(path, "rb") as file:
            data = file.read()
        self.assertEqual({r["id"] for r in json.loads(data)["results"]}, {"rsm/camera_dolly", "rival/camera_dolly"})
        # Better truths alone change nothing that is known of the results.
        self.run_again(*arguments, "--only-truths", "--truth-effort", "2", folder=folder)
        with open(path, "rb") as file:
            self.assertEqual(data, file.read())

    def test_comparison(self):
        path = os.path.join(self.folder, "stability.json")
        output, _ = self.run_again("--quick", "--no-report", "--report-only", "--compare", path)
        self.assertIn("0 worse beyond noise", output)

        old = json.loads(json.dumps(self.data))
        result = next(r for r in old["results"] if r["id"] == "rsm/thin_walls")
        result["indices"]["leak"] *= 0.5
        better = os.path.join(self.temporary.name, "better.json")
        with open(better, "w", encoding="utf-8") as file:
            json.dump(old, file)
        output, errors = self.run_again("--quick", "--no-report", "--report-only", "--compare", better, code=1)
        self.assertIn("WORSE   rsm/thin_walls: leak", output)
        self.assertIn("rsm/thin_walls: leak", errors)

        # Nothing in common is nothing checked.
        for result in old["results"]:
            result["id"] = result["id"].replace("/", "/basic.")
        with open(better, "w", encoding="utf-8") as file:
            json.dump(old, file)
        _, errors = self.run_again("--quick", "--no-report", "--report-only", "--compare", better, code=2)
        self.assertIn("--compare", errors)

        old["header"]["frames"] = 32
        with open(better, "w", encoding="utf-8") as file:
            json.dump(old, file)
        _, errors = self.run_again("--quick", "--no-report", "--report-only", "--compare", better, code=2)
        self.assertIn("frames", errors)

    def test_an_interrupted_run_goes_on(self):
        folder = os.path.join(self.temporary.name, "interrupted")
        arguments = ("--no-report", "--size", "96x54", "--frames", "6", "--sequences", "no_light", "camera_dolly", "--techniques", "rsm")
        known = set(os.listdir(self.cache))
        process = self.start(*arguments, folder=folder)
        deadline = time.time() + 60
        while time.time() < deadline and set(os.listdir(self.cache)) == known:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertIn(process.returncode, (0, 130), errors)  # 0: it was done before the signal came
        _, errors = self.run_again(*arguments, folder=folder)
        with open(os.path.join(folder, "stability.json"), encoding="utf-8") as file:
            self.assertEqual({r["id"] for r in json.load(file)["results"]}, {"rsm/no_light", "rsm/camera_dolly"})

    def test_sizes_change_from_frame_to_frame(self):
        folder = os.path.join(self.temporary.name, "sizes")
        self.run_again("--no-report", "--size", "80x45", "--frames", "8", "--truth-effort", "0.25", "--sequences", "resolution_change", folder=folder)
        with open(os.path.join(folder, "stability.json"), encoding="utf-8") as file:
            data = json.load(file)
        self.assertEqual([w for w, _ in data["sequences"][0]["sizes"]], [80, 80, 64, 64, 40, 40, 64, 64])
        for result in data["results"]:
            if result["technique"] == "auto":
                continue  # what it chooses follows the times of frames before
            errors = [frame["relMSE"] for frame in result["frames"]]
            self.assertEqual(errors[2], errors[6])  # the same picture before and after a smaller one
            self.assertNotEqual(errors[2], errors[4])

    def test_other_parameters_stand_beside_the_defaults(self):
        folder = os.path.join(self.temporary.name, "variants")
        self.run_again("--no-report", "--size", "32x18", "--frames", "3", "--truth-effort", "0.1", "--sequences", "camera_dolly",
                       "--techniques", "rsm", "rsm,vpls=16,filter=off", folder=folder)
        with open(os.path.join(folder, "stability.json"), encoding="utf-8") as file:
            results = {result["technique"]: result for result in json.load(file)["results"]}
        self.assertEqual(set(results), {"rsm", "rsm,vpls=16,filter=off"})
        self.assertEqual(results["rsm,vpls=16,filter=off"]["settings"], "vpls=16 filter=off")
        self.assertNotEqual(results["rsm"]["frames"], results["rsm,vpls=16,filter=off"]["frames"])

    def test_scenes_are_moved_through(self):
        folder = os.path.join(self.temporary.name, "scenes")
        cheap = ("--no-report", "--size", "32x18", "--frames", "3", "--truth-effort", "0.1", "--techniques", "rsm", "rival")
        output, _ = self.run_again("--scenes", "cornell", "basic", *cheap, folder=folder)
        with open(os.path.join(folder, "stability.json"), encoding="utf-8") as file:
            data = json.load(file)
        names = [f"{scene}.{movement}" for scene in ("cornell", "basic") for movement in MOVEMENTS]
        self.assertEqual([s["id"] for s in data["sequences"]], names)
        self.assertEqual({r["id"] for r in data["results"]}, {f"{t}/{name}" for t in ("rsm", "rival") for name in names})
        for sequence in data["sequences"]:
            self.assertIn(sequence["id"], output)
            steps = [b - a for a, b in zip(sequence["values"], sequence["values"][1:])]
            self.assertGreater(min(steps), 0.0)
            self.assertAlmostEqual(steps[0], steps[1], places=6)
        for result in data["results"]:
            self.assertTrue(result["passes"])
            self.assertIsNotNone(result["indices"]["flicker"])

        # One of them by its name, and some of a scene's: what is known already is not measured again.
        picture = os.path.join(folder, "images", "rsm_basic.camera_pan_picture.png")
        before = os.stat(picture).st_mtime_ns
        self.run_again("--sequences", "basic.camera_pan", *cheap, folder=folder)
        self.run_again("--scenes", "basic", "--sequences", "camera_pan", *cheap, folder=folder)
        self.assertEqual(before, os.stat(picture).st_mtime_ns)
        # The catalogue's sequences go into the same file.
        self.run_again("--sequences", "no_light", "rooms.camera_dolly", *cheap, folder=folder)
        with open(os.path.join(folder, "stability.json"), encoding="utf-8") as file:
            self.assertEqual([s["id"] for s in json.load(file)["sequences"]], [*names, "no_light", "rooms.camera_dolly"])

    def test_wrong_scenes_are_named(self):
        path = os.path.join(self.temporary.name, "dark.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"materials": {"grey": {"albedo": [0.5, 0.5, 0.5]}},
                       "meshes": [{"material": "grey", "box": {"lower": [0, 0, 0], "upper": [1, 1, 1]}}], "lights": []}, file)
        for arguments, named in [(("--scenes", "nowhere"), ("--scenes 'nowhere'", "cornell")),
                                 (("--scenes", "furnace"), ("--scenes 'furnace'", "point light")),
                                 (("--scenes", path), (f"--scenes '{path}'", "point light")),
                                 (("--scenes", self.temporary.name), ("--scenes", "expected a path")),
                                 (("--scenes", "basic", "--sequences", "thin_walls"), ("--sequences 'thin_walls'", "camera_dolly")),
                                 (("--sequences", "furnace.camera_pan"), ("--sequences 'furnace.camera_pan'", "point light")),
                                 (("--sequences", "basic.thin_walls"), ("basic.thin_walls", "SCENE.MOVEMENT")),
                                 (("--sequences", "nowhere.camera_pan"), ("nowhere.camera_pan", "SCENE.MOVEMENT"))]:
            with self.subTest(arguments=arguments):
                folder = os.path.join(self.temporary.name, "wrong")
                _, errors = self.run_again(*arguments, "--quick", "--no-report", code=2, folder=folder)
                for text in named:
                    self.assertIn(text, errors)
                self.assertEqual(errors.count("\n"), 1)

    def test_wrong_arguments_are_named(self):
        _, errors = self.run_again("--sequences", "pan", code=2)
        self.assertIn("camera_pan", errors)
        _, errors = self.run_again("--quick", "--frames", "9", "--no-report", code=2)
        self.assertIn("frames", errors)
        _, errors = self.run_again("--techniques", "magic", code=2)
        self.assertIn("rival", errors)
        _, errors = self.run_again("--techniques", "rsm,vpl=3", code=2)
        self.assertIn("vpls", errors)
        for effort in ("0", "-1", "nan", "inf", "1e300"):
            _, errors = self.run_again("--truth-effort", effort, code=2)
            self.assertIn("--truth-effort", errors)
            self.assertEqual(errors.count("\n"), 1)
        _, errors = self.run_again("--size", "16384x16384", "--frames", "10000", code=2)
        self.assertIn("memory", errors)
        self.run_again("--only-truths", "--report-only", code=2)

    def test_what_is_no_result_is_refused_before_measuring(self):
        folder, path = os.path.join(self.temporary.name, "refused"), os.path.join(self.temporary.name, "other.json")
        head = {"format": "lightwell-stability 1", "header": {"size": [8, 8], "frames": 2}, "sequences": [], "results": []}
        others = [{"format": 5}, {**head, "header": {}}, {**head, "results": [{"id": "rsm/no_light"}]}, {**head, "results": [3]}]
        for data, named in [(head, "size")] + [(other, "expected the results") for other in others]:
            with self.subTest(data=data):
                with open(path, "w", encoding="utf-8") as file:
                    json.dump(data, file)
                _, errors = self.run_again("--quick", "--no-report", "--compare", path, code=2, folder=folder)
                self.assertIn(named, errors)
                self.assertFalse(os.path.exists(os.path.join(folder, "stability.json")))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v", *sys.argv[2:]])
