"""`lightwell place-vpls` and its file, the schema of that file, and instant radiosity as a technique.

Usage: place_vpls_test.py PROGRAM [unittest options]. Python's standard library only.
"""
import json
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import schemas  # noqa: E402
from cli_test import SIZE, SUM_ROUNDING, CommandLine, png_size  # noqa: E402

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SCHEMA = schemas.read(os.path.join(ROOT, "docs", "static-vpls.schema.json"))
QUICK = ["--points", "8", "--paths", "400", "--cap", "40"]


class PlaceVpls(CommandLine):
    def place(self, scene, name, *arguments):
        report = self.json("place-vpls", scene, *arguments, "--out", self.path(name), "--json")
        with open(self.path(name), encoding="utf-8") as file:
            return report, json.load(file)

    def test_a_room(self):
        """Cornell's box: what is found, what it stands for, and a file that the schema accepts."""
        png = self.path("vpls.png")
        report, placed = self.place("cornell", "a.json", *QUICK, *SIZE, "--png", png)
        self.assertEqual(schemas.faults(placed, SCHEMA), [])
        self.assertEqual(png_size(png), (96, 54))
        self.assertEqual(report["vpls"], len(placed["vpls"]))
        self.assertLessEqual(report["vpls"], 40)
        self.assertGreater(report["vpls"], 20)
        self.assertEqual((report["points"], report["paths"], report["light_paths"]), (8, 400, 4096))
        # Five walls of 0.55 m and two blocks: 1.5 + 0.3 m^2 of walls that can be seen, about 0.55 of blocks.
        self.assertAlmostEqual(report["area"], sum(v["weight"] for v in placed["vpls"]), delta=1e-6)
        self.assertTrue(1.5 < report["area"] < 2.6, report["area"])
        reds = [v for v in placed["vpls"] if v["reflectance"][0] > 2 * v["reflectance"][1]]
        greens = [v for v in placed["vpls"] if v["reflectance"][1] > 2 * v["reflectance"][0]]
        self.assertTrue(reds and greens)
        for vpl in placed["vpls"]:
            self.assertAlmostEqual(math.sqrt(sum(n * n for n in vpl["normal"])), 1.0, delta=1e-6)
        # Once more: the same bytes. Another seed: others.
        self.place("cornell", "b.json", *QUICK)
        self.place("cornell", "c.json", *QUICK, "--seed", "2")
        texts = []
        for name in ("a.json", "b.json", "c.json"):
            with open(self.path(name), encoding="utf-8") as file:
                texts.append(file.read())
        self.assertEqual(texts[0], texts[1])
        self.assertNotEqual(texts[0], texts[2])

    def test_runs_accumulate_and_hands_are_kept(self):
        _, placed = self.place("cornell", "v.json", *QUICK)
        hand = {"name": "mine", "position": [0.1, 0.0, 0.1], "normal": [0, 2, 0], "reflectance": 0.25, "light_mask": "0x5"}
        placed["vpls"].append(hand)
        placed["blockers"].append({"center": [0, 0, 0], "radius": 0.5})
        with open(self.path("v.json"), "w", encoding="utf-8") as file:
            json.dump(placed, file)
        report, again = self.place("cornell", "v.json", *QUICK, "--seed", "9", "--append")
        self.assertEqual(report["by_hand"], 1)
        self.assertEqual(report["earlier"], len(placed["vpls"]))
        self.assertEqual(again["blockers"], placed["blockers"])
        kept = [v for v in again["vpls"] if v.get("name") == "mine"]
        self.assertEqual(len(kept), 1)
        self.assertEqual(kept[0]["normal"], [0, 1, 0])
        self.assertEqual(kept[0]["light_mask"], "0x5")
        self.assertNotIn("weight", kept[0])
        self.assertEqual(schemas.faults(again, SCHEMA), [])
        self.assertGreater(sum(v.get("population", 0) for v in again["vpls"]), 1.5 * sum(v.get("population", 0) for v in placed["vpls"]))

    def test_moving_objects(self):
        """The door's VPLs are the door's, and stand in its own coordinates: within its leaf."""
        _, placed = self.place("rooms", "v.json", "--time", "2", "--points", "20", "--paths", "3000", "--cap", "120")
        doors = [v for v in placed["vpls"] if v.get("object") == "door"]
        self.assertTrue(doors)
        for vpl in doors:
            self.assertTrue(all(-1.5 < p < 2.5 for p in vpl["position"]), vpl)
        self.assertEqual({v.get("object", "door") for v in placed["vpls"]}, {"door"})

    def test_light_paths(self):
        """Without paths of the lights it does not matter where the lamp stands."""
        with open(os.path.join(ROOT, "samples", "scenes", "cornell.json"), encoding="utf-8") as file:
            scene = json.load(file)
        scene["lights"][0]["target"] = [0.1, 0, 0.1]
        del scene["lights"][0]["direction"]
        moved = self.path("moved.json")
        with open(moved, "w", encoding="utf-8") as file:
            json.dump(scene, file)
        for count, same in ((0, True), (400, False)):
            made = [self.place(lamp, "v%d.json" % i, *QUICK, "--light-paths", str(count)) for i, lamp in enumerate(("cornell", moved))]
            self.assertEqual([report["light_paths"] for report, _ in made], [count, count])
            self.assertEqual(made[0][1]["vpls"] == made[1][1]["vpls"], same)

    def test_a_file_follows_the_unit_of_length(self):
        """A file is in metres of the scene's file; of a scene in another unit its places and spheres are, too: the picture is the same."""
        _, placed = self.place("rooms", "v.json", "--time", "2", *QUICK)
        placed["vpls"][0].pop("weight")  # by the distance to its neighbours
        self.assertTrue(any("object" in v for v in placed["vpls"]))
        placed["blockers"] = [{"center": [-1, 1, 0], "radius": 0.7}, {"object": "door", "center": [0, 1, 0.5], "radius": 0.6}]
        with open(self.path("v.json"), "w", encoding="utf-8") as file:
            json.dump(placed, file)
        base = ["render", "rooms", "--technique", "static_vpl", "--set", "vpls_file=" + self.path("v.json"), *SIZE, "--time", "2", "--warmup", "0",
                "--frames", "1", "--json"]
        plain = self.json(*base)
        self.assertGreater(plain["counts"]["kept_vpls"], 3)
        for scale in ("8", "0.125"):  # a power of two rounds nothing
            self.assertEqual(self.json(*base, "--scale", scale)["hash"], plain["hash"], scale)
        # And so in the catalogue's sequences of other units.
        self.place("cornell", "c.json", *QUICK)
        out = self.path("stability")
        def measured(*sequences):
            self.done("stability", "--out", out, "--no-report", "--techniques", "static_vpl,vpls_file=" + self.path("c.json"), "--sequences", *sequences,
                      "--frames", "2", "--size", "48x27", "--truth-effort", "0.5", "--truth-cache", self.path("truths"))
            with open(os.path.join(out, "stability.json"), encoding="utf-8") as file:
                return {r["sequence"]: r["errors"] for r in json.load(file)["results"]}
        errors = measured("camera_dolly", "scale_small", "scale_large")
        for name in ("scale_small", "scale_large"):
            for key, value in errors["camera_dolly"].items():
                self.assertAlmostEqual(errors[name][key], value, delta=1e-3 * abs(value), msg=name + " " + key)
        # What is kept is of these VPLs, not of any in a file of that name.
        with open(self.path("c.json"), encoding="utf-8") as file:
            others = json.load(file)
        others["area_per_weight"] *= 4
        with open(self.path("c.json"), "w", encoding="utf-8") as file:
            json.dump(others, file)
        self.assertNotEqual(measured("camera_dolly")["camera_dolly"], errors["camera_dolly"])

    def test_the_schema_and_the_reader_agree(self):
        """What the reader refuses the schema refuses, and the other way round."""
        good = {"format": "lightwell-static-vpls", "version": 1, "metres_per_unit": 0.5, "area_per_weight": 2,
                "vpls": [{"name": "n", "object": "o", "position": [1, 2.5, 3], "normal": [0, 0, 5], "reflectance": [0, 0.5, 1],
                          "weight": 1e-9, "light_mask": 4294967295, "receiver_mask": "0xff", "population": 0}],
                "blockers": [{"name": "b", "center": [0, 0, 0], "radius": 1e-3}]}
        self.assertEqual(schemas.faults(good, SCHEMA), [])
        spoilt = [({"version": 2}, {}, {}), ({"format": "x"}, {}, {}), ({"vpls": 1}, {}, {}), ({"more": 1}, {}, {}), ({"metres_per_unit": 0}, {}, {}),
                  ({"area_per_weight": -1}, {}, {}), ({}, {"position": [1, 2]}, {}), ({}, {"reflectance": 1.1}, {}), ({}, {"reflectance": [0, 0, -0.1]}, {}),
                  ({}, {"weight": 0}, {}), ({}, {"light_mask": 0}, {}), ({}, {"light_mask": "0x00"}, {}), ({}, {"weight": "1"}, {}), ({}, {"light_mask": -1}, {}), ({}, {"light_mask": 4294967296}, {}),
                  ({}, {"receiver_mask": "ff"}, {}), ({}, {"receiver_mask": "0x"}, {}), ({}, {"name": ""}, {}), ({}, {"extra": 1}, {}),
                  ({}, {}, {"radius": 0}), ({}, {}, {"center": 1}), ({}, {}, {"extra": 1})]
        path = self.path("v.json")
        for root, vpl, blocker in spoilt:
            bad = {**good, "vpls": [{**good["vpls"][0], **vpl}], "blockers": [{**good["blockers"][0], **blocker}], **root}
            self.assertNotEqual(schemas.faults(bad, SCHEMA), [], (root, vpl, blocker))
            with open(path, "w", encoding="utf-8") as file:
                json.dump(bad, file)
            key = list({**root, **vpl, **blocker})[0]
            self.refused(["place-vpls", "cornell", *QUICK, "--out", path, "--append"], path, key, "expected")
        # An object that the scene has not is the scene's fault, which no schema knows.
        with open(path, "w", encoding="utf-8") as file:
            json.dump(good, file)
        self.refused(["place-vpls", "cornell", *QUICK, "--out", path, "--append"], '"o"', "cornell")

    def test_wrong_arguments(self):
        out = ["--out", self.path("never.json")]
        self.refused(["place-vpls", "cornell"], "--out")
        self.refused(["place-vpls", "cornell", "--out", self.path("never.txt")], ".json")
        self.refused(["place-vpls", "cornell", *out, "--append"], "--append", "never.json")
        self.refused(["place-vpls", "cornell", *out, "--png", self.path("a.exr")], "--png", ".png")
        self.refused(["place-vpls", "cornell", *out, "--from", "1,2"], "--from", "X,Y,Z")
        self.refused(["place-vpls", "cornell", *out, "--from", "0,900,0"], "0, 900, 0", "sees none")
        self.refused(["place-vpls", "cornell", *out, "--cap", "5000"], "--cap", "4096")
        self.refused(["place-vpls", "cornell", *out, "--spacing", "0"], "--spacing", "'0'", "above 0")
        self.refused(["place-vpls", "cornell", *out, "--angle", "90"], "--angle", "'90'", "under 90")
        self.refused(["place-vpls", "cornell", *out, "--offset=-1"], "--offset", "'-1'")
        self.refused(["place-vpls", "cornell", *out, "--seed", "x"], "--seed", "'x'")
        self.refused(["place-vpls", "nowhere", *out], "nowhere", "cornell")
        self.assertFalse(os.path.exists(self.path("never.json")))


class StaticVplTechnique(CommandLine):
    def test_placed_without_a_file(self):
        """What `static_vpl` places by itself is what `place-vpls` would: the same picture, to the bit, as with its file."""
        path = self.path("v.json")
        self.done("place-vpls", "cornell", "--cap", "20", "--out", path)
        with open(path, encoding="utf-8") as file:
            count = len(json.load(file)["vpls"])
        base = ["render", "cornell", "--technique", "static_vpl", *SIZE, "--warmup", "0", "--frames", "1", "--json"]
        given, placed = (self.json(*base, "--set", key) for key in ("vpls_file=" + path, "vpls_cap=20"))
        self.assertEqual(given["hash"], placed["hash"])
        self.assertEqual(placed["parameters"]["vpls_cap"], 20)
        self.assertNotIn("vpls_cap", given["parameters"])
        self.assertTrue(10 < count <= 20, count)
        self.assertNotEqual(self.json(*base, "--set", "vpls_cap=10")["hash"], placed["hash"])
        for key in ("0", "4097"):
            self.refused([*base, "--set", "vpls_cap=" + key], "vpls_cap", "1 to 4096")
        self.refused([*base, "--set", "vpls_cap=20", "vpls_file=" + path], "vpls_file", "vpls_cap", "both")
        self.refused(["render", "cornell", "--technique", "rsm", *SIZE, "--json", "--set", "vpls_cap=20"], "vpls_cap", "vpls")


class InstantRadiosity(CommandLine):
    def test_render_and_its_vpls(self):
        """One VPL is the lamp's axis; the VPLs of a picture, summed by the path tracer, make the picture again."""
        picture, vpls, again = self.path("ir.exr"), self.path("ir.txt"), self.path("again.exr")
        base = ["render", "cornell", "--technique", "instant_radiosity", *SIZE, "--warmup", "0", "--frames", "1", "--json"]
        report = self.json(*base, "--set", "vpls=1")
        self.assertEqual(report["counts"]["vpls"], 1)
        self.assertIsNone(report["device"])
        for shadows in ("on", "off"):
            report = self.json(*base, "--set", "vpls=60", "shadows=" + shadows, "--out", picture, "--vpls-out", vpls)
            self.assertEqual(report["parameters"], {"vpls": 60, "shadows": shadows == "on", "seed": 0})
            self.assertEqual([p["name"] for p in report["passes"]], ["instant_radiosity.trace", "instant_radiosity.gather"])
            self.assertEqual(report["counts"]["shadow_rays"] > 0, shadows == "on")
            unshadowed = [] if shadows == "on" else ["--unshadowed"]
            self.done("reference", "cornell", "--bounces", "1", "--vpls", vpls, *unshadowed, *SIZE, "--out", again)
            self.assertLess(self.json("compare", picture, again, "--json")["relMSE"], 1e3 * SUM_ROUNDING)
        self.refused([*base, "--set", "vpls=0"], "vpls", "1 to 1048576")
        self.refused([*base, "--set", "bounces=2"], "bounces", "vpls, shadows, seed")
        self.refused([*base, "--debug-view", "x=" + self.path("x.exr")], "'x'", "vpls")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
