"""The viewer without a window: its rasterised inputs against the studio's ray-cast ones and against closed forms.

Usage: viewer_test.py VIEWER LIGHTWELL GL_SHARING_DOUBLE [unittest options]. Python's standard library only; exit code 77 (skipped) where
there is no EGL with OpenGL 3.3.
"""
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
import unittest

VIEWER = os.path.abspath(sys.argv[1]) if len(sys.argv) > 2 else ""
LIGHTWELL = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else ""
DOUBLE = os.path.abspath(sys.argv[3]) if len(sys.argv) > 3 else ""
SKIPPED = 77
TIMEOUT = 300
SIZE = ["--size", "192x108", "--rsm-size", "64"]
# relMSE of irradiance, rasterised inputs against ray-cast ones, all else alike. What differs: edges of surfaces in the
# RSM, 16-bit normals, half floats of direct radiance. Measured on llvmpipe: 6e-11 and 4.5e-4 (`horizon` lives on direct
# light, whose shadows have a map's edges). The limit of `rsm` leaves another driver a few texels at edges.
RASTER_LIMITS = {("rsm", "vpls=0 interleave=1"): 1e-6, ("horizon", ""): 1.5e-3}
# Sums over texels against integrals over directions: the edge of a cone runs through texels. Of a sun's plate: its edges.
CONE_ROUNDING, PLATE_ROUNDING = 3e-3, 1e-2
ALBEDO = 0.5
LAMPS = [  # name, kind, intensity, inner and outer half angles
    ("narrow", "spot", 3.0, 20.0, 50.0), ("wide", "spot", 2.0, 60.0, 88.0), ("bulb", "point", 1.5, 0.0, 180.0)]


def quad(corners):
    return {"quad": corners, "material": "grey"}


def scene_of(meshes, lights):
    camera = {"name": "c", "position": [0.1, 0.2, 0.8], "target": [0, 0, 0], "vertical_fov_degrees": 60}
    return {"materials": {"grey": {"albedo": ALBEDO}}, "meshes": meshes, "cameras": [camera], "lights": lights}


def lamp(name, kind, intensity, inner, outer):
    light = {"name": name, "kind": kind, "position": [0.05, 0.1, -0.1], "intensity": intensity}
    if kind == "spot":
        light.update({"direction": [0.3, -1, 0.2], "inner_cone_degrees": inner, "outer_cone_degrees": outer})
    return light


def emitted(intensity, inner, outer):
    """Flux of a lamp whose intensity falls with the square of the ramp in the cosine between its cones."""
    high, low = math.cos(math.radians(inner)), math.cos(math.radians(outer))
    return 2 * math.pi * intensity * ((1 - high) + (high - low) / 3)


class Viewer(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, document):
        with open(self.path(name), "w", encoding="utf-8") as file:
            json.dump(document, file)
        return self.path(name)

    def run_program(self, *arguments, environment=None):
        return subprocess.run(arguments, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=TIMEOUT, env=environment)

    def view(self, *arguments, environment=None):
        result = self.run_program(VIEWER, "--headless", "--json", "--warmup", "0", *arguments, environment=environment)
        self.assertEqual(result.returncode, 0, "%s: %s" % (arguments, result.stderr))
        return json.loads(result.stdout)

    def refused(self, arguments, *words, code=2, environment=None):
        with self.subTest(arguments=arguments):
            result = self.run_program(VIEWER, *arguments, environment=environment)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            for word in words:
                self.assertIn(word, result.stderr)

    def test_same_light_as_from_rays(self):
        """Irradiance of the shipped Cornell box, by the viewer and by `lightwell render`."""
        for (technique, settings), limit in RASTER_LIMITS.items():
            with self.subTest(technique=technique):
                common = ["--technique", technique, *SIZE] + (["--set", *settings.split()] if settings else [])
                ours, theirs = self.path("ours.exr"), self.path("theirs.exr")
                self.view("--scene", "cornell", "--no-panels", *common, "--out", ours)
                rays = self.run_program(LIGHTWELL, "render", "cornell", "--frames", "1", "--warmup", "0", *common, "--out", theirs)
                self.assertEqual(rays.returncode, 0, rays.stderr)
                compared = self.run_program(LIGHTWELL, "compare", ours, theirs, "--json")
                self.assertEqual(compared.returncode, 0, compared.stderr)
                error = json.loads(compared.stdout)["relMSE"]
                print("%s: relMSE %.2e" % (technique, error))
                self.assertLess(error, limit)

    def test_flux_of_lamps(self):
        """All that a lamp in a closed box sends is reflected once: albedo times its flux stands in its RSMs."""
        walls = [quad([[s, -1, -1], [s, 1, -1], [s, 1, 1], [s, -1, 1]]) for s in (-1, 1)]
        walls += [quad([[-1, s, -1], [1, s, -1], [1, s, 1], [-1, s, 1]]) for s in (-1, 1)]
        walls += [quad([[-1, -1, s], [1, -1, s], [1, 1, s], [-1, 1, s]]) for s in (-1, 1)]
        scene = self.write("lamps.json", scene_of(walls, [lamp(*words) for words in LAMPS]))
        report = self.view("--scene", scene, "--technique", "rsm", "--size", "64x36", "--rsm-size", "256", "--no-panels")
        for name, kind, intensity, inner, outer in LAMPS:
            expected = ALBEDO * (4 * math.pi * intensity if kind == "point" else emitted(intensity, inner, outer))
            for channel in range(3):
                flux = sum(rsm["flux"][channel] for rsm in report["rsms"] if rsm["light"] == name)
                self.assertAlmostEqual(flux / expected, 1.0, delta=CONE_ROUNDING, msg=name)

    def test_flux_of_a_sun(self):
        """A tilted plate: albedo * irradiance * area * cosine."""
        plate = quad([[-1, 0, -0.5], [1, 0, -0.5], [1, 0, 0.5], [-1, 0, 0.5]])
        sun = {"name": "sun", "kind": "sun", "direction": [1, -2, 0.5], "irradiance": [4, 2, 1]}
        scene = self.write("sun.json", scene_of([plate], [sun]))
        report = self.view("--scene", scene, "--technique", "rsm", "--size", "64x36", "--no-panels")
        cosine = 2 / math.sqrt(1 + 4 + 0.25)
        for channel, irradiance in enumerate(sun["irradiance"]):
            self.assertAlmostEqual(report["rsms"][0]["flux"][channel] / (ALBEDO * irradiance * 2 * cosine), 1.0, delta=PLATE_ROUNDING)

    def test_a_path_with_panels(self):
        """Frames along keys, a picture with panels, the truth beside it, the inputs checked, a time that splits in two."""
        path = self.write("path.json", {
            "name": "walk", "position": [0.278, 0.273, -0.8], "target": [0.278, 0.273, 0], "vertical_fov_degrees": 39,
            "keys": [{"time": 0}, {"time": 1, "position": [0.3, 0.3, -0.6]}]})
        truth, picture = self.path("truth.exr"), self.path("picture.png")
        self.view("--scene", "cornell", *SIZE, "--technique", "rsm", "--no-panels", "--out", truth)
        report = self.view("--scene", "cornell", *SIZE, "--technique", "horizon", "--path", path, "--frames", "3", "--truth", truth,
                           "--split", "0.5", "--check", "--screenshot", picture)
        with open(picture, "rb") as file:
            head = file.read(24)
        self.assertEqual(struct.unpack(">II", head[16:]), (192, 108))
        self.assertEqual(report["frames"], 3)
        self.assertEqual([finding for finding in report["findings"] if finding["severity"] == 2], [])
        self.assertGreater(report["lightwell_ms"], 0)
        self.assertGreaterEqual(report["host_ms"], report["stages_ms"]["gbuffer"])
        self.assertIn("panels", report["stages_ms"])

    def test_sharing(self):
        """Buffers shared by a driver's double give the bits of mapped ones; where they can't be shared, the viewer says why."""
        copied, shared = self.path("copied.exr"), self.path("shared.exr")
        common = ["--scene", "cornell", *SIZE, "--technique", "ssvp", "--no-panels", "--frames", "2"]
        with_double = dict(os.environ, LD_PRELOAD=DOUBLE, ASAN_OPTIONS="verify_asan_link_order=0")
        report = self.view(*common, "--out", shared, "--check", environment=with_double)
        self.assertTrue(report["lightwell"]["sharing"].startswith("shared by cl_khr_gl_sharing"), report["lightwell"]["sharing"])
        self.assertEqual([finding for finding in report["findings"] if finding["severity"] == 2], [])
        report = self.view(*common, "--out", copied, "--copies", environment=with_double)
        self.assertTrue(report["lightwell"]["sharing"].startswith("mapped copies: asked for by --copies"), report["lightwell"]["sharing"])
        with open(copied, "rb") as ours, open(shared, "rb") as theirs:
            self.assertEqual(ours.read(), theirs.read())
        refusing = dict(with_double, GL_SHARING_DOUBLE="refuse")
        for environment, reason in ((None, "does not offer cl_khr_gl_sharing"), (refusing, "not with this OpenGL context")):
            report = self.view("--scene", "cornell", "--size", "16x16", "--technique", "rsm", "--no-panels", environment=environment)
            self.assertTrue(report["lightwell"]["sharing"].startswith("mapped copies: the device"), report["lightwell"]["sharing"])
            self.assertIn(reason, report["lightwell"]["sharing"])

    def test_planes_cut_nothing(self):
        """A camera's near and far planes are no matter of rays: what they would cut is drawn."""
        room = [quad([[-1, -1, s], [1, -1, s], [1, 1, s], [-1, 1, s]]) for s in (-1, 1)]
        document = scene_of(room, [lamp("bulb", "point", 1.0, 0.0, 180.0)])
        pictures = []
        for near, far in ((0.01, 100.0), (1.0, 1.1)):
            document["cameras"][0].update({"near": near, "far": far})
            out = self.path("planes.exr")
            self.view("--scene", self.write("planes.json", document), "--technique", "rsm", "--size", "32x18", "--rsm-size", "32", "--no-panels",
                      "--out", out)
            with open(out, "rb") as file:
                pictures.append(file.read())
        self.assertEqual(pictures[0], pictures[1])

    def test_wrong_arguments(self):
        out = ["--headless", "--size", "64x36"]
        self.refused([*out, "--technique", "rms"], "rms", "rsm", "horizon")
        self.refused([*out, "--technique", "rsm", "--set", "vlps=4"], "vlps", "vpls")
        self.refused([*out, "--technique", "rsm", "--set", "vpls"], "'vpls'", "key=value")
        self.refused([*out, "--scene", "cornel"], "--scene", "cornel", "cornell")
        self.refused([*out, "--camera", "back"], "--camera", "back", "front")
        self.refused([*out, "--path", "/no/such.json"], "--path", "/no/such.json")
        self.refused([*out, "--truth", "/no/such.exr"], "--truth", "/no/such.exr")
        self.refused([*out, "--screenshot", "a.jpg"], "--screenshot", ".png")
        self.refused([*out, "--show", "picure"], "--show", "picure", "irradiance")
        self.refused(["--headless", "--size", "1280"], "'1280'", "WIDTHxHEIGHT")
        self.refused([*out, "--technique", "rsm", "--show", "debug", "--debug-view", "nothing"], "nothing", "there are")
        self.refused([*out, "--device", "no such device"], "no such device")
        for arguments in (["--time", "nan"], ["--step", "nan"], ["--frames", "0"], ["--size", "4294967376x45"]):
            self.refused([*out, *arguments], arguments[0])
        self.refused(["--json"], "--json", "--headless")
        self.refused([*out, "--technique", "rsm", "--screenshot", "/no/such/a.png"], "/no/such/a.png", code=1)
        bare = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self.refused(["--scene", "cornell"], "no window", "--headless", code=1, environment=bare)


if __name__ == "__main__":
    # A context is made before anything is loaded: 2 is the missing scene, 1 the missing driver.
    probe = subprocess.run([VIEWER, "--headless", "--scene", "no such scene"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                           timeout=TIMEOUT)
    if probe.returncode == 1:
        print("skipped: " + probe.stderr.strip())
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
