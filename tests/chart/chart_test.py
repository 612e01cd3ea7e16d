"""`lightwell chart` in its short form, against the shipped references: figures, resumption, noise, report.

Usage: chart_test.py PROGRAM [unittest options]. Python's standard library only; the report's own case is left
out where matplotlib or D3 is missing.
"""
import fcntl
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = os.path.abspath(sys.argv[1]) if len(sys.argv) > 1 else ""
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "samples", "chart"))
import results as charts  # noqa: E402

# rsm's defaults at 320x180 against one bounce: (relMSE, nRMSE, absolute bias, FLIP), as measured when charts were
# new. A tenth more is a regression: same input gives the same bits, and other devices round, no more.
BOUNDS = {
    "cornell": (0.316, 0.261, 0.131, 0.0631),
    "basic": (0.120, 0.746, 0.138, 0.0131),
    "rooms": (0.172, 0.394, 0.133, 0.125),
}
SLACK = 1.1
QUICK = ["--quick", "--techniques", "rsm", "--no-report"]
POINT_KEYS = {"id", "key", "truth", "build", "warm_up", "processor_ms", "scene", "camera", "technique", "label", "settings", "parameters", "bounces", "size", "device",
              "frames", "ms", "device_ms", "bytes", "load_average", "errors", "images"}
ERROR_KEYS = {"bounces", "relMSE", "nrmse", "bias", "p99", "noise", "trusted", "rmse", "ssim", "score", "score255", "flip",
              "picture_noise", "picture_trusted"}


def start(*arguments):
    return subprocess.Popen([PROGRAM, "chart", *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True)


class Chart(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        self.file = os.path.join(self.folder, "results.json")
        self.cache = os.path.join(self.folder, "truths")

    def chart(self, *arguments, code=0):
        process = start(*arguments, "--out", self.folder, "--truth-cache", self.cache)
        output, errors = process.communicate(timeout=300)
        self.assertEqual(process.returncode, code, errors)
        return errors

    def results(self):
        with open(self.file, encoding="utf-8") as file:
            return json.load(file)

    def test_figures_of_the_shipped_scenes(self):
        self.chart(*QUICK, "--scenes", *BOUNDS)
        data = self.results()
        header = data["header"]
        self.assertEqual((header["size"], header["quick"], header["noise_share"]), ([320, 180], True, 0.1))
        self.assertLessEqual({"name", "platform", "driver", "opencl", "width"}, set(header["device"]))
        self.assertLessEqual({"lightwell", "embree", "openimageio", "compiler", "cpu", "threads"}, set(header["versions"]))
        self.assertEqual([v["scene"] for v in data["views"]], list(BOUNDS))
        self.assertTrue(all(v["truths"][0]["shipped"] for v in data["views"]))
        for point in data["points"]:
            self.check_point(point)
        for scene in BOUNDS:
            self.check_scene(scene, [p for p in data["points"] if p["scene"] == scene])

    def check_point(self, point):
        self.assertEqual(set(point), POINT_KEYS)
        own = point["errors"]["own"]
        self.assertEqual(set(own), ERROR_KEYS)
        self.assertEqual(own["trusted"], own["noise"] <= 0.1 * own["relMSE"])
        self.assertEqual((point["bounces"], own["bounces"]), (1, 1))
        self.assertGreaterEqual(point["frames"], 1)
        self.assertGreater(point["ms"]["median"], 0.0)
        self.assertGreater(point["processor_ms"]["median"], 0.0)
        self.assertGreaterEqual(point["ms"]["p99"], point["ms"]["median"])
        self.assertLessEqual({"vpls", "sampling", "interleave", "filter", "resolution", "seed"}, set(point["parameters"]))
        for image in point["images"].values():
            self.assertTrue(os.path.exists(os.path.join(self.folder, image)), image)

    def check_scene(self, scene, points):
        labels = [p["label"] for p in points]
        self.assertEqual((labels.count("default"), labels.count("Dachsbacher 2005")), (1, 1))
        self.assertEqual(len({json.dumps(p["parameters"]) for p in points}), len(points))
        self.assertEqual({p["parameters"]["vpls"] for p in points}, {64, 256, 400, 1024, 4096})
        own = next(p for p in points if p["label"] == "default")["errors"]["own"]
        for key, bound in zip(("relMSE", "nrmse", "bias", "flip"), BOUNDS[scene]):
            with self.subTest(scene=scene, error=key):
                self.assertLess(abs(own[key]), SLACK * bound)

    def test_goes_on_where_it_was(self):
        """A finished point is not measured again; a stale one is; Ctrl-C keeps what there is."""
        scenes = ["--scenes", "cornell", "basic"]
        process = start(*QUICK, *scenes, "--out", self.folder, "--truth-cache", self.cache)
        deadline = time.time() + 200
        while not os.path.exists(self.file) and time.time() < deadline:
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 130, errors)
        before = {p["id"]: p for p in self.results()["points"]}
        self.chart(*QUICK, *scenes)
        data = self.results()
        after = {p["id"]: p for p in data["points"]}
        self.assertLess(len(before), len(after))
        for name, point in before.items():
            self.assertEqual(point, after[name])  # its very times: not measured again

        stale = data["points"][3]
        stale["key"], stale["frames"] = "of another build", -1
        with open(self.file, "w", encoding="utf-8") as file:
            json.dump(data, file)
        self.chart(*QUICK, *scenes)
        for name, point in {p["id"]: p for p in self.results()["points"]}.items():
            if name == stale["id"]:
                self.assertGreater(point["frames"], 0)
            else:
                self.assertEqual(point, after[name])

    def test_noisy_truths_are_kept_and_hide_points(self):
        arguments = ["--techniques", "rsm", "--scenes", "cornell", "--cameras", "first", "--size", "48x32", "--quick",
                     "--no-report"]
        self.chart(*arguments, "--noise", "10")
        [truth] = self.results()["views"][0]["truths"]
        self.assertEqual((truth["shipped"], truth["samples"]), (False, 16))
        hidden = [p for p in self.results()["points"] if not p["errors"]["own"]["trusted"]]
        self.assertGreater(len(hidden), 0)
        drawn = charts.Results(self.folder)
        for point in drawn.points:
            own = point["errors"]["own"]
            self.assertEqual(charts.value(point) is None, own["noise"] > 0.1 * own["relMSE"])
            self.assertNotIn(point["id"], [p["id"] for p in charts.front(drawn.points)] if not own["trusted"] else [])
        before = {p["id"]: p for p in self.results()["points"]}
        self.chart(*arguments, "--noise", "0.01")  # a better truth: all points are judged anew, none is timed
        for point in self.results()["points"]:
            known = before[point["id"]]
            self.assertEqual((point["ms"], point["frames"]), (known["ms"], known["frames"]))
            self.assertNotEqual((point["truth"], point["errors"]), (known["truth"], known["errors"]))
        [better] = self.results()["views"][0]["truths"]
        self.assertLessEqual(better["noise"], 0.01)
        self.assertLess(sum(not p["errors"]["own"]["trusted"] for p in self.results()["points"]), len(hidden))
        self.assertEqual(len([f for f in os.listdir(self.cache) if f.endswith(".exr")]), 1)

    def test_the_rival_and_chosen_points(self):
        """A technique of the host joins by its registration; --only picks points; bounces are judged apart."""
        self.chart("--quick", "--scenes", "cornell", "--size", "32x18", "--noise", "0.5", "--no-report", "--techniques", "rival",
                   "rsm", "--only", "spp=1", "vpls=64,1024")
        points = self.results()["points"]
        self.assertEqual({p["parameters"].get("spp", 1) for p in points}, {1})
        self.assertEqual({p["parameters"].get("vpls", 64) for p in points}, {64, 1024})
        self.assertEqual({p["errors"]["own"]["bounces"] for p in points if p["technique"] == "rival"}, {1, 2})
        self.assertTrue(all(p["ms"]["median"] > 0 and p["device"] is None for p in points if p["technique"] == "rival"))

    def test_points_with_their_parameters(self):
        """A technique named with parameters is one point alone, beside another's sweep, and none twice; it has the name of a setting."""
        self.chart("--quick", "--scenes", "cornell", "--size", "32x18", "--noise", "0.5", "--no-report", "--techniques", "rsm,vpls=64,interleave=2",
                   "rsm,vpls=256", "rsm,seed=0,vpls=256", "instant_radiosity", "--only", "shadows=off")
        points = self.results()["points"]
        self.assertEqual([(p["technique"], p["settings"], p["label"]) for p in points if p["technique"] == "rsm"],
                         [("rsm", "vpls=64 interleave=2", ""), ("rsm", "defaults", "default")])
        self.assertEqual({p["parameters"]["vpls"] for p in points if p["technique"] != "rsm"}, {1, 20, 200})
        self.assertIn("vplz", self.chart(*QUICK, "--techniques", "rsm,vplz=64", code=2))

    def test_some_pixels_tell_the_error_of_all(self):
        """One pixel of 4 x 4: errors of the irradiance within what so few pixels can tell, at the same effort a better truth."""
        common = ("--quick", "--scenes", "cornell", "--size", "320x180", "--techniques", "rsm", "--only", "vpls=256", "--no-report")
        self.chart(*common, "--judge-one-of", "1")
        whole = {p["id"]: p["errors"]["own"] for p in self.results()["points"]}
        self.chart(*common, "--judge-one-of", "4", "--picture-noise", "0.05")
        [truth] = self.results()["views"][0]["truths"]
        self.assertLessEqual(truth["noise"], 4e-3)
        self.assertGreater(truth["samples"], truth["picture_samples"])
        for point in self.results()["points"]:
            own = point["errors"]["own"]
            self.assertEqual(own["picture_trusted"], own["picture_noise"] <= 0.1 * own["relMSE"])
            # 3,600 pixels: the mean of their terms is known to some 4 %, that of the light to 1 %.
            self.assertLess(abs(own["relMSE"] / whole[point["id"]]["relMSE"] - 1.0), 0.15)
            self.assertLess(abs(own["bias"] - whole[point["id"]]["bias"]), 0.03)
        self.assertIn("--judge-one-of 8", self.chart(*common, "--judge-one-of", "8", code=2))

    def test_many_points_in_little_time(self):
        """--frames N and no whole pictures: the same error of the irradiance, neither score nor preview; no report can be made of that."""
        common = ("--quick", "--scenes", "cornell", "--size", "128x72", "--noise", "0.1", "--techniques", "rsm,vpls=64", "--judge-one-of", "2")
        self.chart(*common, "--no-report", "--picture-noise", "0.5")
        [whole] = self.results()["points"]
        self.chart(*common, "--no-report", "--picture-noise", "0", "--frames", "2")
        [point] = self.results()["points"]
        self.assertEqual((point["frames"], point["images"]), (2, {}))
        self.assertEqual(point["errors"]["own"]["relMSE"], whole["errors"]["own"]["relMSE"])
        self.assertNotIn("score", point["errors"]["own"])
        self.assertIn("--no-report", self.chart(*common, "--picture-noise", "0", code=2))
        self.assertIn("--frames", self.chart(*common, "--no-report", "--frames", "0", code=2))

    def test_one_bounce_against_what_the_view_shows(self):
        """--on-screen: techniques of the picture alone have a second truth, kept apart from the first, with less light."""
        common = ("--quick", "--scenes", "cornell", "--size", "64x36", "--noise", "0.02", "--techniques", "screen_space", "rival",
                  "--only", "samples=64", "levels=0,4", "start=quarter", "spp=1", "resolution=quarter", "--no-report")
        self.chart(*common)
        without = {p["id"]: p for p in self.results()["points"]}
        self.assertEqual([p["errors"]["screen"] for p in without.values()], [None] * len(without))
        self.chart(*common, "--on-screen")
        [view] = self.results()["views"]
        self.assertLessEqual(view["on_screen"]["noise"], 0.02)
        self.assertIn("-seen-", view["on_screen"]["name"])
        self.assertNotIn(view["on_screen"]["name"], [t["name"] for t in view["truths"]])
        points = self.results()["points"]
        self.assertEqual({p["technique"] for p in points}, {"screen_space", "rival"})
        for point in points:
            known = without[point["id"]]
            self.assertEqual(point["errors"]["screen"] is None, point["technique"] == "rival")
            if point["technique"] == "screen_space":
                self.assertEqual(point["ms"], known["ms"])  # judged anew, not timed
                # The Cornell box's front wall is not in the picture: it sends in one truth alone.
                self.assertGreater(point["errors"]["screen"]["bias"], point["errors"]["own"]["bias"] + 0.1)

    def test_refusals(self):
        self.assertIn("rsm", self.chart("--techniques", "nothing", code=2))
        self.assertIn("--on-screen", self.chart("--quick", "--techniques", "rsm", "--on-screen", "--no-report", code=2))
        self.assertIn("nothing", self.chart("--quick", "--scenes", "nothing", "--no-report", code=2))
        for wrong in ("vpls=65", "vplz=64", "vpls"):  # none charts everything instead
            self.assertIn("--only", self.chart(*QUICK, "--scenes", "cornell", "--only", wrong, code=2))
        with open(self.file, "w", encoding="ascii") as file:
            file.write("{}")
        self.assertIn("results.json", self.chart(*QUICK, "--scenes", "cornell", code=2))

    def test_one_writer_of_a_folder(self):
        """Of two charts into one folder the second would lose what the first measures."""
        os.makedirs(self.folder, exist_ok=True)
        with open(self.file + ".lock", "w", encoding="ascii") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertIn("another run", self.chart(*QUICK, "--scenes", "cornell", "--size", "16x9", code=2))
        self.assertFalse(os.path.exists(self.file))

    def test_a_dark_scene_is_left_out_and_unknown_ones_are_refused_at_once(self):
        with open(os.path.join(ROOT, "samples", "scenes", "cornell.json"), encoding="utf-8") as file:
            scene = json.load(file)
        scene["lights"] = []
        dark = os.path.join(self.folder, "dark.json")
        with open(dark, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        small = ["--quick", "--techniques", "rival", "--only", "spp=1", "--size", "16x9", "--noise", "10", "--no-report"]
        self.assertIn("nothing", self.chart(*small, "--scenes", "cornell", "nothing", code=2))
        self.assertFalse(os.path.exists(self.file))
        self.assertIn("dark/front has no indirect light", self.chart(*small, "--scenes", dark, "cornell"))
        self.assertEqual({p["scene"] for p in self.results()["points"]}, {"cornell"})

    def test_report(self):
        self.chart(*QUICK, "--scenes", "cornell", "basic")
        process = start("--report-only", "--out", self.folder)
        _, errors = process.communicate(timeout=300)
        if process.returncode == 1 and "apt-get install" in errors:
            self.assertTrue(os.path.exists(self.file))
            self.skipTest("no matplotlib or no D3 here")
        self.assertEqual(process.returncode, 0, errors)
        for name in ("cornell", "basic", "summary"):
            for extension in ("svg", "png"):
                self.assertGreater(os.path.getsize(os.path.join(self.folder, name + "." + extension)), 1000)
        with open(os.path.join(self.folder, "report.html"), encoding="utf-8") as file:
            page = file.read()
        self.assertEqual(re.findall(r"""(?:src|href)=["'](?!data:)[^"']*["']""", page), [])  # opens offline
        self.assertNotIn("<!--", page.split("<body>")[1].split("<script")[0])
        data = json.loads(re.search(r'<script id="chart-data" type="application/json">(.*?)</script>', page, re.S).group(1))
        self.assertEqual([v["id"] for v in data["views"]], ["cornell/front", "basic/overview"])
        self.assertTrue(all(len(v["images"]) >= 3 and v["fronts"]["relMSE|own|median"] for v in data["views"]))

    def test_without_python_the_results_stay(self):
        environment = dict(os.environ, LIGHTWELL_PYTHON="/nonexistent", PATH="/nonexistent")
        result = subprocess.run([PROGRAM, "chart", "--report-only", "--out", self.folder], env=environment, text=True,
                                capture_output=True, timeout=60)
        self.assertEqual(result.returncode, 1)  # neither results nor, perhaps, Python
        self.assertIn("results are kept", result.stderr)


if __name__ == "__main__":
    if not PROGRAM or PROGRAM.endswith("-h"):
        sys.exit(__doc__)
    del sys.argv[1]
    unittest.main()
