"""`lightwell visibility`: pairs that a clustered technique misjudges, where their number is known without it.

Usage: visibility_test.py PROGRAM [unittest options]. Python's standard library only.
"""
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import exr  # noqa: E402
from cli_test import SIZE, CommandLine, png_size  # noqa: E402

# A room from -2 to 2, empty; with SHEET, a wall without thickness shuts the lamp out of the camera's half.
ROOM = """{"materials": {"wall": {"albedo": 0.5}},
 "meshes": [{"quad": [[-2, -1, -1], [2, -1, -1], [2, -1, 1], [-2, -1, 1]], "material": "wall"},
            {"quad": [[-2, 1, -1], [2, 1, -1], [2, 1, 1], [-2, 1, 1]], "material": "wall"},
            {"quad": [[-2, -1, -1], [2, -1, -1], [2, 1, -1], [-2, 1, -1]], "material": "wall"},
            {"quad": [[-2, -1, 1], [2, -1, 1], [2, 1, 1], [-2, 1, 1]], "material": "wall"},
            {"quad": [[-2, -1, -1], [-2, 1, -1], [-2, 1, 1], [-2, -1, 1]], "material": "wall"},
            {"quad": [[2, -1, -1], [2, 1, -1], [2, 1, 1], [2, -1, 1]], "material": "wall"}%s],
 "cameras": [{"name": "c", "position": [1.9, 0, 0.1], "target": [0, -0.2, 0], "vertical_fov_degrees": 70}],
 "lights": [{"name": "lamp", "kind": "point", "position": [-1, 0.3, 0.2], "intensity": 3}]}"""
SHEET = ', {"quad": [[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]], "material": "wall"}'
# Within a texel of the room's edges and of the sheet's rim a map sees the next wall: shares of its pairs, times the texels a
# side. Measured, of 64 to 256 texels: 0.46 to 0.58 of the empty room, 0.8 to 2.1 behind the sheet.
EDGES_OF_ROOM, RIM_OF_SHEET = 0.75, 2.6
# Half a million pairs summed by the host in double and by the device in float.
GATHER_ROUNDING = 1e-4


class Visibility(CommandLine):
    def judged(self, scene, *arguments):
        return self.json("visibility", scene, *SIZE, "--no-truth", "--judge-one-of", "1", "--json", *arguments)["points"]

    def room(self, wall):
        path = self.path("room.json")
        with open(path, "w", encoding="utf-8") as file:
            file.write(ROOM % wall)
        return path

    def test_keys_and_what_is_its_own_medoid(self):
        few, own = self.judged("cornell", "--sweep", "clusters=4,0")
        self.assertEqual((few["clusters"], own["clusters"]), (4, 256))
        self.assertEqual((few["vpls"], few["pairs"], few["lit"]), (own["vpls"], own["pairs"], own["lit"]))
        self.assertEqual(list(few["misjudged"]), ["none", "map", "medoid", "mean", "map_against_medoid"])
        for point in (few, own):
            self.assertAlmostEqual(point["misjudged"]["none"]["false_light"], 1.0 - point["lit"], delta=1e-9)
            self.assertEqual(point["misjudged"]["none"]["false_shadow"], 0.0)
            self.assertEqual((point["parameters"]["interleave"], point["parameters"]["bounces"]), (1, 1))
        self.assertEqual(set(own["misjudged"]["medoid"].values()), {0.0})
        self.assertEqual(own["misjudged"]["map"], own["misjudged"]["map_against_medoid"])
        self.assertGreater(few["misjudged"]["medoid"]["false_light"], 0.0)
        self.assertEqual(own["error_against_exact_rays"]["mean"]["relMSE"], 0.0)

    def test_its_sum_is_the_technique_s_picture(self):
        picture, judged = self.path("ssvp.exr"), self.path("judged.exr")
        for visibility in ("hard", "soft"):
            self.done("render", "cornell", "--technique", "ssvp", *SIZE, "--frames", "1", "--warmup", "0", "--out", picture, "--set",
                      "interleave=1", "bounces=1", "visibility=" + visibility)
            self.judged("cornell", "--set", "visibility=" + visibility, "--out", judged)
            ours, sums = exr.read(picture)[2]["R"], exr.read(judged)[2]["map.R"]
            self.assertGreater(sum(sums), 0.0)
            self.assertLess(max(abs(a - b) for a, b in zip(ours, sums)), GATHER_ROUNDING * max(sums))

    def test_an_empty_room_has_no_shadow(self):
        for point in self.judged(self.room(""), "--sweep", "clusters=8,0", "--sweep", "map_size=64,256"):
            self.assertGreater(point["pairs"], 100000)
            self.assertEqual(point["lit"], 1.0)
            self.assertEqual(point["misjudged"]["map"]["false_light"], 0.0)
            self.assertLess(point["misjudged"]["map"]["false_shadow"], EDGES_OF_ROOM / point["parameters"]["map_size"])

    def test_a_sheet_lets_nothing_through(self):
        for point in self.judged(self.room(SHEET), "--sweep", "clusters=8,0", "--sweep", "map_size=64,256"):
            self.assertEqual(point["lit"], 0.0)
            self.assertEqual(point["misjudged"]["none"]["false_light"], 1.0)
            self.assertEqual(point["misjudged"]["map"]["false_shadow"], 0.0)
            self.assertLess(point["misjudged"]["map"]["false_light"], RIM_OF_SHEET / point["parameters"]["map_size"])
            self.assertEqual(point["error_against_exact_rays"], None)

    def test_truth_and_picture(self):
        picture = self.path("wrong.png")
        report = self.json("visibility", "cornell", *SIZE, "--noise", "0.05", "--truth-cache", self.folder.name, "--out", picture, "--json")
        errors = report["points"][0]["error"]
        self.assertEqual(list(errors), ["none", "map", "medoid", "mean", "exact"])
        self.assertGreater(errors["none"]["relMSE"], 2.0 * errors["map"]["relMSE"])
        self.assertLessEqual(report["truth"]["noise"], 0.05)
        self.assertEqual(png_size(picture), (4 * 96, 54))
        self.assertIn("false shadow", self.done("visibility", "cornell", *SIZE, "--no-truth").stdout)

    def test_wrong_arguments(self):
        asked = ["visibility", "cornell", *SIZE, "--no-truth"]
        self.refused([*asked, "--technique", "rsm"], "vpl_clusters", "valid:")
        self.refused([*asked, "--technique", "nothing"], "nothing", "ssvp")
        self.refused([*asked, "--set", "interleave=4"], "--set", "interleave", "it is 1")
        self.refused([*asked, "--sweep", "bounces=1,2"], "--sweep", "bounces", "it is 1")
        self.refused([*asked, "--sweep", "clusters=8,99"], "clusters", "64")
        self.refused([*asked, "--sweep", "clusters="], "--sweep", "clusters=")
        self.refused([*asked, "--sweep", "clusters=4,8", "--out", self.path("a.png")], "--out", "one point")
        self.refused([*asked, "--out", self.path("a.jpg")], ".exr", ".png")
        self.refused([*asked, "--noise", "0"], "--noise")
        self.refused([*asked, "--judge-one-of", "8"], "--judge-one-of")
        self.refused(["visibility", "nowhere"], "nowhere")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
