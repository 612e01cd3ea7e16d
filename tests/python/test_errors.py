"""What is refused, by name: settings, arrays, frames, numbers that do not fit."""
import math
import unittest

import numpy as np

import lightwell as lw
import scenes
from contract import Contract


class Errors(Contract):
    def refused(self, words, kind=lw.InvalidArgumentError):
        return self.assertRaisesRegex(kind, words)

    def test_settings(self):
        for settings, words in (({"vpl": 3}, r"expected settings among vpls, .*, got 'vpl' \(meant: vpls\?\)"), ({"vpls": -1}, "vpls: expected a whole number, 0"),
                                ({"vpls": 2.5}, "vpls: expected a whole number"), ({"vpls": "many"}, "vpls: expected a whole number"),
                                ({"vpls": True}, "vpls: expected a whole number"), ({"vpls": math.nan}, "vpls: expected"), ({"vpls": None}, "vpls: expected"),
                                ({"interleave": 3}, "interleave: expected one of 1, 2, 4, 8, got 3"),
                                ({"sampling": "fluxes"}, "sampling: expected one of flux, uniform, view, got 'fluxes'"), ({"sampling": 7}, "sampling: expected one of"),
                                ({"vpls": np.True_}, "vpls: expected"), ({"vpls": b"64"}, "vpls: expected"), ({"vpls": 10**400}, "vpls: expected"),
                                ({"sampling": True}, "sampling: expected one of"), ({"filter": np.ones(2)}, "filter: expected True or False"),
                                ({"filter": 2}, "filter: expected True or False, got 2"), ({"filter": "on"}, "filter: expected True or False")):
            with self.subTest(settings), self.refused(words):
                self.device.technique("rsm", **settings)
        with self.refused("technique: expected one of rsm, .*, got 'rms'"):
            self.device.technique("rms")
        with self.refused("first: expected a Technique, got 'rsm'"):
            self.device.technique("fallback", first="rsm")
        with self.refused("first: expected a Technique"):
            self.device.technique("fallback", first=self.view)
        with self.refused("vplz"):
            self.device.technique_from_text("rsm", "vplz=3")

    def test_settings_arrive(self):
        # By name, by number and by text: the same bits, other than the defaults'.
        ways = [dict(sampling="uniform", seed=5, filter=False), dict(sampling=1, seed=np.uint32(5), filter=0)]
        pictures = []
        for technique in [self.device.technique("rsm", **way) for way in ways] + [self.device.technique_from_text("rsm", "sampling=uniform seed=5 filter=off"),
                                                                                self.device.technique("rsm")]:
            technique.update(scenes.frame())
            pictures.append(technique.render(self.view, scenes.floor()).irradiance.tobytes())
        self.assertEqual(pictures[0], pictures[1])
        self.assertEqual(pictures[0], pictures[2])
        self.assertNotEqual(pictures[0], pictures[3])

    def test_a_switch_with_three_positions(self):
        parameter = lw.describe_techniques()["cone_tracing"].parameters["normal_aware"]
        self.assertEqual(parameter.choices, ("off", "on", "two_sided"))
        for value in (True, False, np.True_, "on", "off", "two_sided", 2, np.int64(1)):
            self.device.technique("cone_tracing", normal_aware=value).close()
        for value in (3, -1, "auto", 1.0, None):
            with self.subTest(value), self.refused("normal_aware: expected one of off, on, two_sided"):
                self.device.technique("cone_tracing", normal_aware=value)

    def test_arrays(self):
        gbuffer = scenes.floor()
        self.technique.update(scenes.frame())
        for field, value, words in (("normal", None, "gbuffer.normal"), ("normal", gbuffer.normal.astype(float), "gbuffer.normal: expected .*, got float64"),
                                    ("position", gbuffer.position[:-1], "gbuffer.position: expected 24 x 24 pixels, got 24 x 23"),
                                    ("normal", gbuffer.normal[..., :2], "gbuffer.normal.format: expected one of"), ("camera", lw.Camera(np.eye(3), np.eye(4)), "gbuffer.camera.view")):
            with self.subTest(field=field, words=words), self.refused(words):
                self.technique.render(self.view, scenes.floor(**{field: value}) if field not in ("position", "normal") else
                                      lw.GBuffer(**{"position": gbuffer.position, "normal": gbuffer.normal, field: value}))
        with self.refused("gbuffer: expected a GBuffer, got Frame"):
            self.technique.render(self.view, scenes.frame())
        with self.refused("output.*"):
            self.technique.render(self.view, gbuffer, irradiance=False)

    def test_frames(self):
        vpls = lw.vpls([[0, 0, 0]], [[0, 1, 0]], [[1, 1, 1]])
        bad = vpls.copy()
        bad["flux"] = np.nan
        triangles = np.zeros((6, 3), np.float32)
        for frame, words in ((lw.Frame(vpls=bad), r"frame.vpls\[0\].flux: expected 0"), (lw.Frame(vpls=[1.0]), "frame.vpls: expected"),
                             (lw.Frame(vpls=lw.blockers([[0, 0, 0]], 1)), "frame.vpls: expected a one-dimensional array of lightwell.vpls"),
                             (lw.Frame(environment=(math.inf, 0, 0)), "frame.environment: expected finite"), (lw.Frame(environment=(1, 0)), "three numbers"),
                             (lw.Frame(lights=[3]), r"frame.lights\[0\]: expected a Light, got int"),
                             (lw.Frame(lights=[lw.Light.point((0, 0, 0), (1, 1, 1), rsms=[None])]), r"rsms\[0\]: expected an Rsm"),
                             (lw.Frame(lights=[lw.Light.spot((0, 0, 0), (0, 0, 1), (1, 1, 1), 1, 0.5)]), r"frame.lights\[0\].outerConeAngle"),
                             (lw.Frame(geometry=lw.Geometry(vertices=triangles.astype(float))), "frame.geometry.vertices: expected float32"),
                             (lw.Frame(geometry=lw.Geometry(vertices=triangles, triangle_albedo=triangles)), "triangle_albedo: expected 2 rows"),
                             (lw.Frame(geometry=lw.Geometry(vertices=triangles, indices=np.zeros((2, 3), np.int64))), "indices: expected uint32")):
            with self.subTest(words), self.refused(words):
                self.technique.update(frame)
        with self.refused("normal: expected"):
            lw.vpls([[0, 0, 0], [1, 1, 1]], [[0, 1, 0]] * 3, [1, 1, 1])
        # NaN in pixels is no error: no light there, and counted. What was accepted last stays in force after refusals.
        gbuffer = scenes.floor()
        gbuffer.position[3, 4] = np.nan
        self.technique.update(scenes.frame())
        with self.refused("frame.vpls"):
            self.technique.update(lw.Frame(vpls=bad))
        irradiance = self.technique.render(self.view, gbuffer).irradiance
        self.assertTrue(np.isfinite(irradiance).all())
        self.assertEqual(irradiance[3, 4].tolist(), [0, 0, 0])
        self.assertEqual(self.technique.stats()["counts"]["rejected_pixels"], 1)

    def test_what_fits_no_field(self):
        sun, wall = scenes.sun([scenes.wall()]), scenes.wall()
        positions = np.zeros((3, 3), np.float32)
        for use, words in (
                (lambda: self.technique.update(lw.Frame(lights=sun)), "frame.lights: expected a list of Light, got Light"),
                (lambda: self.technique.update(lw.Frame(lights=[scenes.sun(wall)])), r"frame.lights\[0\].rsms: expected a list"),
                (lambda: self.technique.update(lw.Frame(index=-1)), "frame.index: expected a whole number, 0 .. 18446744073709551615, got -1"),
                (lambda: self.technique.update(lw.Frame(lights=[lw.Light.point((0, 0, 0), (1, 1, 1), mask=2**32)])), r"frame.lights\[0\].mask: expected"),
                (lambda: self.technique.update(lw.Frame(lights=[lw.Light(7)])), r"kind: expected one of DIRECTIONAL, POINT, SPOT, got 7"),
                (lambda: self.technique.update(lw.Frame(lights=[lw.Light.point("abc", (1, 1, 1))])), r"position: expected three numbers, got 'abc'"),
                (lambda: self.technique.update(lw.Frame(lights=[lw.Light.point((0, 0, 1j), (1, 1, 1))])), "position: expected three numbers"),
                (lambda: self.technique.update(lw.Frame(source_views=[self.view])), r"frame.source_views\[0\]: expected a pair"),
                (lambda: self.technique.update(lw.Frame(geometry=[1])), "frame.geometry: expected a Geometry, got list"),
                (lambda: self.technique.update(lw.Frame(world_origin=(1, 2))), "frame.world_origin: expected three numbers"),
                (lambda: self.technique.update(lw.Frame(world_origin=(math.nan, 0, 0))), "frame.worldOrigin: expected"),
                (lambda: self.technique.render(self.technique, scenes.floor()), "view: expected a View, got Technique"),
                (lambda: self.technique.render(self.view, scenes.floor(depth_kind="gl")), "gbuffer.depth_kind: expected one of ZERO_TO_ONE, GL"),
                (lambda: self.technique.render(self.view, scenes.floor(camera=(1, 2))), "gbuffer.camera: expected a Camera, got tuple"),
                (lambda: self.technique.render_points([[0, 0, 0]]), "positions: expected a NumPy array, got list"),
                (lambda: self.technique.render_points(positions[:0]), "positions: expected an array of one pixel or more"),
                (lambda: self.device.view("4", 4), "width: expected a whole number, 0 .. 4294967295, got '4'"),
                (lambda: self.view.resize(3.5, 4), "width: expected a whole number"),
                (lambda: self.device.estimate_memory("rsm", -1, 4), "width: expected a whole number"),
                (lambda: self.view.plan(scenes.frame(), scenes.floor(), budget_ms="3"), "budget_ms: expected a number, got '3'"),
                (lambda: lw.Device("cp\0u"), "selector: expected a string without NUL"), (lambda: lw.Device(3), "selector: expected a string"),
                (lambda: self.device.technique(["rsm"]), "technique: expected one of rsm"),
                (lambda: lw.vpls(positions, [0, 1, 0], [1j, 1, 1]), "flux: expected"), (lambda: lw.vpls([[0, 0, 0], [1]], [0, 1, 0], [1, 1, 1]), "position: expected")):
            with self.subTest(words), self.refused(words):
                use()

    def test_outputs_share_no_pixels(self):
        self.technique.update(scenes.frame())
        gbuffer, planes = scenes.floor(), lw.empty_image(scenes.N, scenes.N, 3)
        four = np.zeros((scenes.N, scenes.N, 4), np.float32)
        self.technique.render(self.view, gbuffer, irradiance=four[..., :3], validity=four[..., 3])  # side by side
        self.assertEqual(four[..., 3].min(), self.technique.render(self.view, gbuffer, validity=True).validity.min())
        with self.refused("output.validity: expected memory of its own, got some of output.irradiance"):
            self.technique.render(self.view, gbuffer, irradiance=planes, validity=planes[..., 1])
        with self.refused("output.irradiance: expected memory of its own, got some of an input"):
            self.technique.render(self.view, gbuffer, irradiance=gbuffer.normal)

    def test_exceptions_carry_status_and_message(self):
        with self.assertRaises(lw.NotUpdatedError) as caught:
            self.device.technique("rsm").render(self.view, scenes.floor())
        self.assertEqual(caught.exception.status, lw.Status.NOT_UPDATED)
        self.assertTrue(caught.exception.message)
        self.assertEqual(str(caught.exception), "LW_ERROR_NOT_UPDATED: " + caught.exception.message)
        with self.assertRaises(lw.NoDeviceError):
            lw.Device("no such device")
        with self.assertRaises(ValueError):
            lw.Device(width=3)
        with self.assertRaises(lw.UnsupportedError):
            self.technique.light_list()
        self.assertTrue(issubclass(lw.OutOfMemoryError, MemoryError))


if __name__ == "__main__":
    unittest.main()
