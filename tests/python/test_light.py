"""The light itself: closed forms, the sums of a script that shares no code with us, and the same bits as the C API's."""
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import lightwell as lw
import scenes
from lightwell._frame import frame_struct
from lightwell._images import Kept

ROOT = pathlib.Path(__file__).resolve().parents[2]


def all_texels(device):
    return device.technique("rsm", vpls=0, interleave=1)


class Light(unittest.TestCase):
    def setUp(self):
        self.device = lw.Device()
        self.addCleanup(self.device.close)

    def one_pixel(self, light, gbuffer):
        technique = all_texels(self.device)
        technique.update(lw.Frame(lights=[light]))
        output = technique.render(self.device.view(1, 1), gbuffer, validity=True)
        self.assertEqual(output.irradiance.shape, (1, 1, 3))
        self.assertEqual(output.irradiance.dtype, np.float32)
        return output.irradiance[0, 0].astype(np.float64)

    def test_a_disc_seen_on_its_axis(self):
        # E = pi L R^2 / (d^2 + R^2), L = flux / (pi A): exact for a disc that faces the receiver, also a near one.
        flux, side = 3.0, 0.5
        radius2 = side**2 / math.pi
        for distance in (0.1, 0.7, 5.0):
            truth = flux / math.pi / (distance**2 + radius2)
            got = self.one_pixel(scenes.texel(flux, side), scenes.receiver((0, distance, 0), (0, -1, 0)))
            np.testing.assert_allclose(got, truth, rtol=1e-5)  # a few roundings of 32-bit floats

    def test_a_point_off_the_axis(self):
        # E = flux / pi * cos(emitter) cos(receiver) / d^2 where the emitter is small: its area is 1e-8 of the distance squared.
        flux, side = 2.0, 1e-3
        at, normal = np.array([4.0, 6.0, 3.0]), np.array([-1.0, -1.0, 0.2])
        to_light = -at / np.linalg.norm(at)
        cosines = (-to_light[1]) * (to_light @ normal / np.linalg.norm(normal))
        truth = flux / math.pi * cosines / (at @ at)
        got = self.one_pixel(scenes.texel(flux, side), scenes.receiver(at, normal))
        np.testing.assert_allclose(got, truth, rtol=1e-5)

    def test_what_faces_away_is_dark(self):
        self.assertFalse(self.one_pixel(scenes.texel(1, 0.1), scenes.receiver((0, 1, 0), (0, 1, 0))).any())
        self.assertFalse(self.one_pixel(scenes.texel(1, 0.1), scenes.receiver((0, -1, 0), (0, 1, 0))).any())

    def test_the_form_factor_of_two_squares(self):
        # Two unit squares with a common edge: 0.20004. Midpoints of 24 x 24 texels, each bounded by its area (docs/conventions.md),
        # make 0.2006; every pixel is held against that sum in double precision.
        gbuffer, rsm = scenes.floor(), scenes.wall()
        technique = all_texels(self.device)
        technique.update(lw.Frame(lights=[scenes.sun([rsm])]))
        irradiance = technique.render(self.device.view(scenes.N, scenes.N), gbuffer).irradiance
        to_pixel = gbuffer.position.reshape(-1, 1, 3).astype(np.float64) - rsm.position.reshape(1, -1, 3)
        squared = (to_pixel**2).sum(-1)
        emitter, pixel = to_pixel[..., 0] / np.sqrt(squared), -to_pixel[..., 1] / np.sqrt(squared)
        bounded = emitter * pixel / math.pi / (squared + (1 + 3 * emitter**2) / 4 / math.pi / scenes.N**2)
        sums = (bounded[..., np.newaxis] * rsm.flux.reshape(1, -1, 3)).sum(1).reshape(scenes.N, scenes.N, 3)
        np.testing.assert_allclose(irradiance, sums, rtol=1e-5)
        self.assertAlmostEqual(float(irradiance[..., 0].mean()), 0.20004, delta=1e-3)

    def test_the_worlds_origin(self):
        # Three doubles, to the last bit; what is relative to another point gets the same light.
        origin = (1e9 + 0.125, -3.5, 2.0**-40)
        self.assertEqual(tuple(frame_struct(lw.Frame(world_origin=origin), Kept()).worldOrigin), origin)
        technique, pictures = self.device.technique("rsm", vpls=0, interleave=1), []
        for world_origin in ((0, 0, 0), np.array(origin)):
            frame = scenes.frame()
            frame.world_origin = world_origin
            technique.update(frame)
            pictures.append(technique.render(self.device.view(scenes.N, scenes.N), scenes.floor()).irradiance.tobytes())
        self.assertEqual(pictures[0], pictures[1])

    def test_a_map_that_says_that_it_has_not_changed(self):
        # Believed while its version stays, 0 and another number have it read.
        technique, gbuffer, rsm = all_texels(self.device), scenes.floor(), scenes.wall()
        view, means = self.device.view(scenes.N, scenes.N), []
        for version, flux in ((7, 1.0), (7, 2.0), (8, 2.0), (0, 3.0), (0, 4.0), (2**64 - 1, 4.0)):
            rsm.version = version
            rsm.flux[...] = scenes.wall().flux * np.float32(flux)
            technique.update(lw.Frame(lights=[scenes.sun([rsm])]))
            means.append(float(technique.render(view, gbuffer).irradiance.mean(dtype=np.float64)))
        np.testing.assert_allclose(np.divide(means, means[0]), (1, 1, 2, 3, 4, 4), rtol=1e-6)
        for version in (-1, 2**64, 1.5):
            rsm.version = version
            with self.assertRaisesRegex(lw.InvalidArgumentError, r"frame\.lights\[0\]\.rsms\[0\]\.version"):
                technique.update(lw.Frame(lights=[scenes.sun([rsm])]))

    def test_points_and_harmonics(self):
        technique = all_texels(self.device)
        technique.update(lw.Frame(lights=[scenes.texel(2.0, 1e-3)]))
        positions = np.array([[0, 2, 0], [0, 0, 0], [np.nan, 0, 0]], np.float32)
        normals = np.array([[0, -1, 0], [0, 1, 0], [0, 1, 0]], np.float32)
        points = technique.render_points(positions, normals, harmonics=True, validity=True)
        self.assertEqual((points.irradiance.shape, points.harmonics.shape, points.validity.shape), ((3, 3), (4, 3, 3), (3,)))
        np.testing.assert_allclose(points.irradiance[0], 2.0 / math.pi / 4.0, rtol=1e-5)
        self.assertEqual(points.irradiance[2].tolist(), [0, 0, 0])  # not finite: none, and counted
        self.assertEqual(technique.stats()["counts"]["rejected_points"], 1)
        # c0 = integral of L Y0 = E_facing * Y0; the first band's y part = E_facing * Y1 * (direction to the light).y = -1.
        facing = 2.0 / math.pi / 4.0
        np.testing.assert_allclose(points.harmonics[0, 0], facing / (2 * math.sqrt(math.pi)), rtol=1e-4)
        np.testing.assert_allclose(points.harmonics[2, 0], -facing * math.sqrt(3 / (4 * math.pi)), rtol=1e-4)

    def test_authored_and_static_vpls(self):
        technique = all_texels(self.device)
        vpls = lw.vpls([[0, 0, 0]], [[0, 1, 0]], [[1.0, 2.0, 3.0]])
        technique.update(lw.Frame(vpls=vpls))
        got = technique.render(self.device.view(1, 1), scenes.receiver((0, 2, 0), (0, -1, 0))).irradiance[0, 0]
        np.testing.assert_allclose(got, np.array([1, 2, 3]) / math.pi / 4, rtol=1e-5)
        static = self.device.technique("static_vpl", interleave=1)
        places = lw.static_vpls([[0, 0, 0]], [[0, 1, 0]], [[0.5, 0.25, 1.0]], weight=0.25)
        static.update(lw.Frame(static_vpls=places, lights=[lw.Light.directional((0, -1, 0), (4, 4, 4))]))
        lights = static.light_list()
        self.assertEqual(len(lights), 1)
        # Flux = irradiance * area * reflectance, the area being weight * unitArea (1 m^2).
        np.testing.assert_allclose(lights["flux"][0], [0.5, 0.25, 1.0], rtol=1e-5)
        np.testing.assert_allclose(lights["area"][0], 0.25, rtol=1e-6)


class ForeignFrame(unittest.TestCase):
    """tests/foreign's frame: left-handed, reversed depth, bottom-up rows, octahedral normals; tolerances as there."""

    FOLDER = ROOT / "tests/foreign/frame"

    def read(self):
        values, expected = {}, []
        for line in (self.FOLDER / "frame.txt").read_text().splitlines():
            words = line.split()
            if words and words[0][0].isalpha():
                values[words[0]] = [float(word) for word in words[1:]]
            elif len(words) == 5:
                expected.append([float(word) for word in words])
        return values, np.array(expected)

    def raw(self, name, dtype, size, channels):
        shape = (int(size[1]), int(size[0])) + ((channels,) if channels > 1 else ())
        return np.fromfile(self.FOLDER / name, dtype).reshape(shape)[::-1]  # top row first, by its strides alone

    def test_it_reaches_the_independent_sum(self):
        values, expected = self.read()
        camera = {end: lw.Camera(*(np.reshape(values[end + part], (4, 4)) for part in ("_view", "_projection"))) for end in ("view", "rsm")}
        size, texels = values["view_size"], values["rsm_size"]
        rsm = lw.Rsm(depth=self.raw("rsm_depth.f32", "f4", texels, 1), normal=self.raw("rsm_normal.f32x4", "f4", texels, 4),
                     flux=self.raw("rsm_flux.f32x3", "f4", texels, 3), camera=camera["rsm"])
        light = lw.Light.spot(values["spot_position"], values["spot_direction"], values["spot_intensity"], *values["spot_half_angles"],
                              rsms=[rsm])
        gbuffer = lw.GBuffer(depth=self.raw("view_depth.f32", "f4", size, 1), normal=self.raw("view_normal.oct16x2", "i2", size, 2),
                             camera=camera["view"], previous_camera=camera["view"])
        with lw.Device() as device, all_texels(device) as technique:
            frame = lw.Frame(lights=[light])
            view = device.view(int(size[0]), int(size[1]))
            technique.update(frame)
            irradiance = technique.render(view, gbuffer).irradiance[::-1]
            self.assertEqual(view.check_inputs(frame, gbuffer), [])
            self.assertEqual(device.copied_bytes, 0)
        got = irradiance[expected[:, 1].astype(int), expected[:, 0].astype(int)].astype(np.float64)
        errors = np.abs(got - expected[:, 2:]) / expected[:, 2:].mean()
        self.assertGreater(len(expected), 300)
        self.assertLessEqual(errors.mean(), 3e-6)
        self.assertLessEqual(errors.max(), 1e-4)


class SameBits(unittest.TestCase):
    """The same arrays through tests/python/same_frame.c, a host in C: not a bit differs."""

    # Of one technique, whose kernels other suites compile as well: what is compared is the way to it.
    CASES = ["vpls=96 interleave=2", "vpls=0 interleave=1 resolution=half seed=3"]

    def test_techniques(self):
        program = os.environ["LIGHTWELL_SAME_FRAME"]
        gbuffer, rsm = scenes.floor(), scenes.wall()
        camera = lw.Camera(lw.look_at((0.5, 2, 0.5), (0.5, 0, 0.5), (0, 0, -1)), lw.orthographic(1, 1, 0, 4))
        gbuffer.camera = gbuffer.previous_camera = camera
        gbuffer.direct_radiance = scenes.image(0.25, 0.5, gbuffer.position[..., 0])
        arrays = [gbuffer.position, gbuffer.normal, gbuffer.direct_radiance, rsm.position, rsm.normal, rsm.flux]
        matrices = [camera.view, camera.projection, rsm.camera.view, rsm.camera.projection]
        with tempfile.TemporaryDirectory() as folder, lw.Device() as device:
            given, made = os.path.join(folder, "given"), os.path.join(folder, "made")
            with open(given, "wb") as file:
                for array in arrays + matrices:
                    file.write(np.ascontiguousarray(array, np.float32).tobytes())
            view = device.view(scenes.N, scenes.N)
            for settings in self.CASES:
                with self.subTest(settings), device.technique_from_text("rsm", settings) as technique:
                    frame = lw.Frame(lights=[scenes.sun([rsm])], source_views=[(view, gbuffer)])
                    technique.update(frame)
                    ours = technique.render(view, gbuffer).irradiance
                    subprocess.run([program, "rsm", settings, str(scenes.N), given, made], check=True)
                    theirs = np.fromfile(made, np.float32).reshape(scenes.N, scenes.N, 3)
                    self.assertGreater(float(theirs.max()), 0)
                    self.assertEqual(np.ascontiguousarray(ours).tobytes(), theirs.tobytes())


if __name__ == "__main__":
    unittest.main()
