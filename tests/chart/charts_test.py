"""What charts make of measured figures: fronts, what is drawn, means. No program is run.

Usage: charts_test.py [unittest options]. Python's standard library only.
"""
import json
import os
import pathlib
import random
import re
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "samples", "chart"))
from looks import looks  # noqa: E402
from pareto import pareto_front  # noqa: E402
import report  # noqa: E402
import results as charts  # noqa: E402
import split_section  # noqa: E402


def beats(a, b):
    return a[0] <= b[0] and a[1] <= b[1] and a != b


class Pareto(unittest.TestCase):
    def test_by_hand(self):
        points = [(1, 9), (2, 5), (3, 5), (2, 7), (4, 1), (5, 2), (0.5, 20)]
        self.assertEqual(pareto_front(points), [6, 0, 1, 4])

    def test_few(self):
        self.assertEqual(pareto_front([]), [])
        self.assertEqual(pareto_front([(3, 3)]), [0])
        self.assertEqual(pareto_front([(3, 3), (3, 3)]), [0])  # of equal points the first

    def test_against_the_definition(self):
        """Whole numbers, so that ties are frequent: on the front is exactly what no other point beats."""
        random.seed(1)
        for _ in range(300):
            points = [(random.randrange(8), random.randrange(8)) for _ in range(random.randrange(1, 25))]
            front = pareto_front(points)
            expected = {p for p in points if not any(beats(q, p) for q in points)}
            self.assertEqual({points[i] for i in front}, expected, points)
            self.assertEqual(len(front), len(expected))
            self.assertEqual([points[i][0] for i in front], sorted(points[i][0] for i in front))


class Looks(unittest.TestCase):
    KNOWN = ["rsm", "ssvp", "screen_space", "horizon", "ao", "fallback", "rival", "instant_radiosity", "lpv", "cone_tracing", "static_vpl"]

    def test_each_technique_has_a_colour_of_its_own_in_every_figure(self):
        colours = {name: look[0] for name, look in looks(self.KNOWN + ["new", "newer"]).items()}
        self.assertEqual(len(set(colours.values())), len(colours))
        for name in self.KNOWN:
            self.assertEqual(looks([name])[name][0], colours[name])

    def test_variants_share_the_colour_and_differ_by_line(self):
        variants = ["ssvp", "ssvp,warm_start=off", "ssvp,clusters=4", "rsm"]
        found = looks(variants)
        self.assertEqual({found[v][0] for v in variants[:3]}, {found["ssvp"][0]})
        self.assertEqual(len({found[v][:2] for v in variants}), len(variants))
        self.assertNotEqual(found["rsm"][0], found["ssvp"][0])


def made_point(view, settings, ms, relmse, noise, label=""):
    own = {"bounces": 1, "relMSE": relmse, "nrmse": relmse, "bias": -relmse, "p99": relmse, "noise": noise,
           "trusted": noise <= 0.1 * relmse, "rmse": 0.1, "ssim": 0.9, "score": 8.0, "score255": 1.0, "flip": 0.1}
    return {"id": view + settings, "scene": view, "camera": "c", "technique": "t", "settings": settings, "label": label,
            "bounces": 1, "size": [8, 8], "frames": 9, "ms": {"median": ms, "p99": 2 * ms}, "device_ms": None,
            "errors": {"own": own, "all": None}, "load_average": 0.0}


def made_split(noise=1e-3, noise_of_total=1e-3, has_all=True, **shares):
    shares = {"model": -0.5, "resolution": 0.1, "visibility": 1.2, "sampling": 0.15, "bounding": 0.05, **shares}
    return {"scene": "s", "camera": "c", "technique": "t", "settings": "x=1", "label": "", "size": [8, 8], "patterns": 4, "vpls": 9,
            "truth_of_all_bounces": has_all, "total": sum(s or 0.0 for s in shares.values()), "shares": shares, "noise": noise,
            "noise_of_total": noise_of_total}


def made_results(points, header=()):
    views = sorted({p["scene"] for p in points})
    data = {"format": "lightwell-chart 1", "header": dict({"size": [8, 8]}, **dict(header)), "points": points,
            "views": [{"id": v, "scene": v, "camera": "c", "truths": [], "images": {}} for v in views]}
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "results.json"), "w", encoding="ascii") as file:
            json.dump(data, file)
        return charts.Results(folder)


class Drawn(unittest.TestCase):
    def test_noise_above_a_tenth_hides_a_point(self):
        clear, hidden = made_point("a", "x", 1.0, 0.5, 0.05), made_point("a", "y", 0.5, 0.4, 0.0401)
        self.assertEqual(charts.value(clear), 0.5)
        self.assertIsNone(charts.value(hidden))
        self.assertEqual(charts.front([clear, hidden]), [clear])  # though faster and better by its figure

    def test_composites_need_the_truth_of_whole_pictures(self):
        point = made_point("a", "x", 1.0, 0.5, 0.01)
        point["errors"]["own"].update(picture_noise=0.06, picture_trusted=False)
        self.assertEqual(charts.value(point), 0.5)
        self.assertIsNone(charts.value(point, "flip"))
        self.assertEqual(charts.front([point], "score"), [])
        mean = charts.means_over_views(made_results([point, made_point("b", "x", 1.0, 0.5, 0.01)]))[0][0]
        self.assertEqual(charts.value(mean), 0.5)
        self.assertIsNone(charts.value(mean, "score"))

    def test_no_truth_no_point(self):
        self.assertIsNone(charts.value(made_point("a", "x", 1.0, 0.5, 0.0), truth="all"))

    def test_each_error_is_less_is_better(self):
        point = made_point("a", "x", 1.0, 0.5, 0.0)
        self.assertEqual(charts.value(point, "bias"), 0.5)
        self.assertEqual(charts.value(point, "score"), 2.0)


class Means(unittest.TestCase):
    def test_geometric_over_views(self):
        points = [made_point("a", "x", 1.0, 0.1, 0.0), made_point("b", "x", 4.0, 0.4, 0.0)]
        means, left = charts.means_over_views(made_results(points))
        self.assertEqual(left, [])
        self.assertAlmostEqual(means[0]["ms"]["median"], 2.0)
        self.assertAlmostEqual(charts.value(means[0]), 0.2)

    def test_only_what_every_view_has(self):
        points = [made_point("a", "x", 1, 0.1, 0), made_point("b", "x", 1, 0.1, 0.1), made_point("a", "y", 1, 0.1, 0)]
        means, left = charts.means_over_views(made_results(points))
        self.assertEqual([m["settings"] for m in means], ["x"])
        self.assertIsNone(charts.value(means[0]))  # one of its views is too noisy, and nothing is drawn in both
        self.assertEqual(sorted(settings for _, settings, _ in left), ["x", "y"])

    def test_views_that_one_technique_lacks_are_in_no_mean(self):
        points = [made_point("a", "x", 1.0, 0.1, 0.0), made_point("b", "x", 4.0, 0.4, 0.0), dict(made_point("a", "z", 2.0, 0.2, 0.0), technique="u")]
        means, left = charts.means_over_views(made_results(points))
        self.assertEqual([(m["technique"], m["ms"]["median"]) for m in means], [("t", 1.0), ("u", 2.0)])
        self.assertEqual(left, [])

    def test_where_the_truth_is_too_noisy_the_ratio_to_another_setting_serves(self):
        """"fine" is half of the default in a and b, and hidden in c, where the default is four times as bad."""
        points = [made_point(view, "defaults", 1.0, error, 0.0, "default") for view, error in (("a", 0.1), ("b", 0.1), ("c", 0.4))]
        points += [made_point("a", "fine", 8.0, 0.05, 0.0), made_point("b", "fine", 8.0, 0.05, 0.0),
                   made_point("c", "fine", 8.0, 1e-6, 0.1)]
        means, left = charts.means_over_views(made_results(points))
        default, fine = means
        self.assertAlmostEqual(charts.value(default), 0.1 * 4.0 ** (1.0 / 3.0))
        self.assertAlmostEqual(charts.value(fine), 0.5 * charts.value(default))
        self.assertEqual((default["errors"]["own"]["views"], fine["errors"]["own"]["views"]), (3, 2))
        self.assertEqual(left, [])

        points += [made_point("a", "rare", 8.0, 0.05, 0.0), made_point("b", "rare", 8.0, 0.05, 0.1), made_point("c", "rare", 8.0, 0.05, 0.1)]
        means, left = charts.means_over_views(made_results(points))
        self.assertIsNone(charts.value(means[2]))  # drawn in one view of three
        self.assertEqual([settings for _, settings, _ in left], ["rare"])


class Times(unittest.TestCase):
    def made(self, load, gpu=False, missing=False):
        points = [made_point("a", "x", 10.0, 0.1, 0.0), made_point("a", "y", 20.0, 0.1, 0.0)]
        for point in points:
            point["load_average"], point["processor_ms"] = load, {"median": 6.0, "p99": 7.0}
        if missing:
            del points[1]["processor_ms"]
        return made_results(points, {"device": {"is_gpu": gpu}, "versions": {"threads": "2"}})

    def test_processor_time_is_that_of_all_threads(self):
        results = self.made(0.5)
        self.assertEqual(results.points[0]["ms"]["processor"], 3.0)
        self.assertEqual((results.time(), results.is_busy()), ("median", False))

    def test_it_is_drawn_where_other_work_lengthened_the_clocks(self):
        self.assertEqual((self.made(9.0).time(), self.made(9.0).is_busy()), ("processor", True))

    def test_it_says_nothing_of_a_gpu_and_must_be_complete(self):
        for results in (self.made(9.0, gpu=True), self.made(9.0, missing=True)):
            self.assertEqual((results.time(), "processor" in results.times), ("median", False))


class Page(unittest.TestCase):
    """The seam by which instruments join the report."""

    def test_every_instrument_has_its_place(self):
        known = report.instruments()
        self.assertIn("chart", [name for name, _ in known])
        for _, module in known:
            self.assertTrue(module.FILE.endswith(".json") and callable(module.make), module)
        self.assertEqual(len({module.FILE for _, module in known}), len(known))
        self.assertEqual([module.ORDER for _, module in known], sorted(module.ORDER for _, module in known))

    def test_sections_stand_side_by_side(self):
        """Neither texts nor scripts of one section reach another; what comes from a file stays text."""
        hostile = {"name": "</script><!-- <b>", "more": "<!--SCRIPTS-->"}
        one = report.Section("One & only", "<p>first</p>", hostile, "const data2 = data.name;", ".one-x { color: red; }")
        two = report.Section("Two", "<p><!--TITLE--></p>", None, "const data2 = 1;")
        text = report.page([("one", one), ("two", two)], "/* d3 */")
        self.assertIn('<a href="#one">One &amp; only</a>', text)
        self.assertIn('<section id="two"><h1>Two</h1>', text)
        self.assertIn(".one-x { color: red; }", text)
        [data] = re.findall(r'<script id="one-data" type="application/json">(.*?)</script>', text, re.S)
        self.assertEqual(json.loads(data), hostile)
        self.assertEqual(text.count("<script"), text.count("</script>"))
        self.assertIn("<p><!--TITLE--></p>", text)  # parts are not searched for places
        self.assertNotIn("<nav>", report.page([("one", one)], ""))
        with self.assertRaises(ValueError):
            report.page([("one", report.Section("One", "", float("nan")))], "")

    def test_tables_escape(self):
        text = report.table(["a", "b"], [("<i>", 1)], numbers_from=1)
        self.assertIn("<td>&lt;i&gt;</td><td class=number>1</td>", text)

    def test_what_is_no_result_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "results.json")
            with self.assertRaisesRegex(report.ReportError, "no-such"):
                report.read_json(pathlib.Path(folder, "no-such.json"), "f 1")
            for text, said in (('{"format": "f 0"}', "expected format f 1, got f 0"), ("[]", "got list"), ('{"format"', "results.json")):
                path.write_text(text, encoding="ascii")
                with self.assertRaisesRegex(report.ReportError, said):
                    report.read_json(path, "f 1")

class Split(unittest.TestCase):
    def test_steps_end_at_the_last_share(self):
        steps = split_section.steps(made_split())
        self.assertEqual([name for name, _ in steps], ["as rendered"] + [f"{n} exact" for n in ("model", "resolution", "visibility", "sampling")])
        self.assertAlmostEqual(steps[1][1], 1.5)  # a negative share: the error rises
        self.assertAlmostEqual(steps[-1][1], 0.05)
        # One pattern, one truth: neither sampling's nor model's share is known.
        alone = made_split(has_all=False, model=0.0, sampling=None)
        self.assertEqual([name for name, _ in split_section.steps(alone)], ["as rendered", "resolution exact", "visibility exact"])
        self.assertEqual([split_section.figure_text(alone, name) for name in ("model", "sampling")], ["", ""])

    def test_what_the_truths_noise_spoils(self):
        text = lambda name, **noises: split_section.figure_text(made_split(**noises), name)  # noqa: E731
        self.assertEqual(text("bounding", noise=4e-3), "+0.05")
        self.assertEqual(text("bounding", noise=6e-3), "(+0.05)")
        self.assertEqual(text("bounding", bounding=-0.05, noise=1e-4), "(-0.05)")  # no squared error
        self.assertEqual(text("model", noise_of_total=0.04), "-0.5")
        self.assertEqual(text("model", noise_of_total=0.06), "(-0.5)")
        self.assertEqual(text("total", noise_of_total=0.09), "1")
        self.assertEqual(text("total", noise_of_total=0.11), "(1)")
        # Differences against one truth, and what differs between patterns: its noise falls out.
        self.assertEqual(text("visibility", noise=1.0, noise_of_total=1.0), "+1.2")
        self.assertEqual(text("sampling", noise=1.0, noise_of_total=1.0), "+0.15")
        self.assertFalse(split_section.is_trusted(made_split(noise=6e-3), "sampling exact", 0.05))

    def test_points_of_another_size_are_left_out(self):
        points = [made_split(), {**made_split(), "size": [4, 4]}]
        self.assertEqual(split_section.current({"header": {"size": [4, 4]}, "points": points}), ([points[1]], 1))

    def test_the_text_names_the_truth(self):
        self.assertIn("against the light of all bounces", split_section.body([made_split()], 0, ""))
        text = split_section.body([made_split(has_all=False)], 2, "")
        self.assertIn("against the light of as many bounces as the technique models", text)
        self.assertNotIn("are added", text)
        self.assertIn("other sizes in this file, left out: 2", text)


if __name__ == "__main__":
    unittest.main()
