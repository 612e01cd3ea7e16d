"""`lightwell probes`: light at a box of points, in a room whose light is known.

Usage: probes_test.py PROGRAM [unittest options]. Python's standard library only.
"""
import json
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from cli_test import SIZE, CommandLine, png_size  # noqa: E402

Y0, Y1 = 0.5 / math.sqrt(math.pi), math.sqrt(0.75 / math.pi)
# A square of side 1 at the bottom of a dark box, lit straight from above with 1 W/m^2: exitance 1/2.
ROOM = """{"materials": {"white": {"albedo": 0.5}, "dark": {"albedo": 0}},
 "meshes": [{"quad": [[-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, -0.5], [-0.5, 0, -0.5]], "material": "white"},
            {"quad": [[-0.5, 0, -0.5], [0.5, 0, -0.5], [0.5, 1, -0.5], [-0.5, 1, -0.5]], "material": "dark"}],
 "cameras": [{"name": "c", "position": [0, 0.5, 3], "target": [0, 0.5, 0], "vertical_fov_degrees": 40}],
 "lights": [{"name": "sun", "kind": "sun", "direction": [0, -1, 0], "irradiance": 1}]}"""


class Probes(CommandLine):
    def test_light_vector_of_a_square(self):
        room, out, png = self.path("room.json"), self.path("probes.json"), self.path("probes.png")
        with open(room, "w", encoding="utf-8") as file:
            file.write(ROOM)
        # Below: of VPLs; of sweeps through cells of 3 cm that begin their light half a cell early.
        for technique, most in ((["rsm", "--set", "vpls=0"], 0.01), (["lpv", "--set", "transport=sweep"], 0.05)):
            report = self.json("probes", room, "--technique", *technique, *SIZE, "--rsm-size", "256", "--grid", "1x2x1", "--out", out, "--png", png, "--json")
            self.assertEqual(report["counts"]["points"], 2)
            self.assertGreater(report["points_ms"], 0.0)
            self.assertEqual(png_size(png), (96, 54))
            with open(out, encoding="utf-8") as file:
                probes = json.load(file)["probes"]
            self.assertEqual([probe["position"] for probe in probes], [[0, 0.25, 0], [0, 0.75, 0]])
            for probe in probes:
                self.assertEqual(probe["validity"], 1.0)
                a = 0.5 / math.hypot(0.5, probe["position"][1])
                truth = 0.5 * 4.0 / math.pi * a * math.atan(a)  # irradiance from below; from above there is none
                for colour in range(3):
                    self.assertAlmostEqual(-probe["c1y"][colour] / Y1, truth, delta=most * truth)
                    self.assertLess(abs(probe["c1x"][colour]), most * truth * Y1)
                    self.assertGreater(probe["c0"][colour], 0.6 * truth * Y0)

    def test_wrong_arguments(self):
        out = ["--out", self.path("never.json")]
        self.refused(["probes", "cornell", "--grid", "8x8", *out], "--grid", "8x4x8")
        self.refused(["probes", "cornell", "--grid", "0x1x1", *out], "--grid", "1024")
        self.refused(["probes", "cornell", "--grid", "1024x1024x8", *out], "--grid", "4194240")
        self.refused(["probes", "cornell", "--surfaces", *out], "--surfaces", "--out")
        self.refused(["probes", "cornell"], "--out")
        self.refused(["probes", "cornell", "--out", self.path("never.png")], ".json")
        self.refused(["probes", "cornell", "--technique", "nothing", *out], "nothing", "lpv")
        self.refused(["probes", "cornell", "--technique", "horizon", *out], "horizon", "rsm, ssvp, lpv")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
