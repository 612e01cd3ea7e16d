"""`lightwell plan`: what it prints can be run by `render`, follows budget and error, and refuses nonsense.

Usage: plan_cli_test.py PROGRAM [unittest options]. Python's standard library only.
"""
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "docs/figures")]
from cli_test import SIZE, CommandLine  # noqa: E402
import planner_scenes  # noqa: E402

VIEW = ["cornell", *SIZE, "--rsm-size", "64"]
CHOICE = ["technique", "parameters", "predicted_ms", "predicted_error", "confidence", "within_budget", "reaches_error"]
PROBES = {"indirect_share", "flux_on_screen", "flux_concentration", "depth_complexity", "extent", "albedo", "facing", "hidden", "coverage"}


class Plan(CommandLine):
    def plan(self, *arguments):
        return self.json("plan", *VIEW, *arguments, "--json")

    def test_a_choice_can_be_rendered(self):
        plan = self.plan("--budget-ms", "33")
        self.assertLessEqual(set(CHOICE) | {"reason", "probes", "device", "budget_ms", "error_target"}, set(plan))
        self.assertEqual((plan["budget_ms"], plan["error_target"]), (33, None))
        self.assertTrue(plan["within_budget"])
        self.assertLessEqual(plan["predicted_ms"], 33)
        self.assertIn(plan["technique"], plan["reason"])
        self.assertTrue(0 < plan["confidence"] <= 1)
        self.assertEqual(set(plan["probes"]), PROBES)
        self.assertGreater(plan["triangles"], 0)
        for name, value in plan["probes"].items():
            self.assertTrue(0 <= value <= (100 if name == "extent" else 1), "%s: %s" % (name, value))
        self.assertNotIn("candidates", plan)
        sets = [word for setting in plan["parameters"].split() for word in ("--set", setting)]
        self.done("render", *VIEW, "--technique", plan["technique"], *sets, "--frames", "1", "--warmup", "0", "--hash")

    def test_all_of_them_and_what_budgets_and_errors_pick(self):
        everything = self.plan()
        candidates = everything["candidates"]
        self.assertEqual(list(candidates[0]), CHOICE)
        times = [each["predicted_ms"] for each in candidates]
        self.assertEqual(times, sorted(times))
        least = min(each["predicted_error"] for each in candidates)
        self.assertLessEqual(everything["predicted_error"], 1.021 * least)
        tight = self.plan("--budget-ms", "0.0001", "--all")
        self.assertFalse(tight["within_budget"])
        self.assertLessEqual(tight["predicted_ms"], 1.05 * times[0])  # of what is about as quick, the most accurate
        self.assertEqual(len(tight["candidates"]), len(candidates))
        cheap = self.plan("--error", "1e9")
        self.assertEqual((cheap["predicted_ms"], cheap["reaches_error"]), (times[0], True))
        self.assertFalse(self.plan("--error", "1e-9", "--budget-ms", "50")["reaches_error"])
        self.assertGreater(self.plan("--error", "1e9", "--views", "2")["predicted_ms"], times[0])
        rest = self.plan("--at-rest")
        self.assertEqual((rest["at_rest"], everything["at_rest"]), (True, False))
        usual = {(each["technique"], each["parameters"]): each["predicted_ms"] for each in candidates}
        self.assertTrue(all(each["predicted_ms"] <= usual[each["technique"], each["parameters"]] for each in rest["candidates"]))
        self.assertLess(sum(each["predicted_ms"] for each in rest["candidates"]), sum(times))
        flat = self.plan("--no-geometry")
        self.assertLess(len(flat["candidates"]), len(candidates))
        self.assertIn("triangles", self.plan("--no-geometry", "--error", "1e9")["reason"])

    def test_text(self):
        text = self.done("plan", *VIEW, "--budget-ms", "33").stdout
        self.assertIn("predicted", text)
        self.assertIn("possible", text)
        self.assertIn("relMSE", self.done("plan", *VIEW).stdout)

    def test_scenes_that_its_fit_learns_from(self):
        paths = planner_scenes.write(pathlib.Path(self.path("made")))
        again = planner_scenes.write(pathlib.Path(self.path("again")))
        self.assertEqual([path.read_text() for path in paths], [path.read_text() for path in again])
        self.assertEqual(len(paths), 24)
        for path in dict(zip(planner_scenes.KINDS, paths)).values():  # one of each kind: light comes in, and goes on from there
            for bounces in ("1", "all"):
                self.done("reference", str(path), *SIZE, "--bounces", bounces, "--spp", "4", "--out", self.path(bounces + ".exr"))
            bias = self.json("compare", self.path("1.exr"), self.path("all.exr"), "--json")["bias"]
            self.assertTrue(-1 <= bias < -1e-3, "%s: %s" % (path.name, bias))

    def test_wrong_arguments(self):
        self.refused(["plan"], "SCENE")
        for wrong in ("-3", "0", "inf", "3ms", ""):
            self.refused(["plan", *VIEW, "--budget-ms=" + wrong], "--budget-ms")
        for wrong in ("nan", "soon"):
            self.refused(["plan", *VIEW, "--error=" + wrong], "--error")
        self.refused(["plan", *VIEW, "--views", "0"], "--views")
        self.refused(["plan", *VIEW, "--views", "65"], "--views")
        self.refused(["plan", *VIEW, "--width", "3"], "--width", "16")
        self.refused(["plan", "cornell", "--camera", "nobody"], "nobody", "front")
        self.refused(["plan", "cornell", "--rsm-size", "63", "--cascades", "2"], "--rsm-size", "even")
        self.refused(["plan", *VIEW, "--device", "nothing like it"], "nothing like it")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
