"""The contract: errors by name, use after close, the order of garbage collection, threads, reports."""
import contextlib
import gc
import io
import math
import threading
import unittest
import weakref

import numpy as np

import lightwell as lw
import scenes
from lightwell import _handles


class Contract(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.device = lw.Device()
        cls.technique = cls.device.technique("rsm", vpls=64, interleave=2)
        cls.view = cls.device.view(scenes.N, scenes.N)

    @classmethod
    def tearDownClass(cls):
        cls.device.close()


class Errors(Contract):
    def refused(self, words, kind=lw.InvalidArgumentError):
        return self.assertRaisesRegex(kind, words)

    def test_settings(self):
        for settings, words in (({"vpl": 3}, r"expected settings among vpls, .*, got 'vpl' \(meant: vpls\?\)"), ({"vpls": -1}, "vpls: expected a whole number, 0"),
                                ({"vpls": 2.5}, "vpls: expected a whole number"), ({"vpls": "many"}, "vpls: expected a whole number"),
                                ({"vpls": True}, "vpls: expected a whole number"), ({"vpls": math.nan}, "vpls: expected"), ({"vpls": None}, "vpls: expected"),
                                ({"interleave": 3}, "interleave: expected one of 1, 2, 4, 8, got 3"),
                                ({"sampling": "fluxes"}, "sampling: expected one of flux, uniform, got 'fluxes'"), ({"sampling": 7}, "sampling: expected one of"),
                                ({"filter": 2}, "filter: expected True or False, got 2"), ({"filter": "on"}, "filter: expected True or False")):
            with self.subTest(settings), self.refused(words):
                self.device.technique("rsm", **settings)
        with self.refused("technique: expected one of rsm, .*, got 'rms'"):
            self.device.technique("rms")
        with self.refused("first: expected a Technique, got 'rsm'"):
            self.device.technique("fallback", first="rsm")
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


class Ends(unittest.TestCase):
    def test_use_after_close(self):
        device = lw.Device()
        view, technique = device.view(scenes.N, scenes.N), device.technique("rsm", vpls=64)
        technique.update(scenes.frame())
        view.close()
        view.close()
        self.assertTrue(view.closed)
        for use in (lambda: view.size, lambda: technique.render(view, scenes.floor()), view.__enter__):
            with self.assertRaisesRegex(lw.InvalidHandleError, "view: expected an open one, got one that was closed"):
                use()
        second = device.view(scenes.N, scenes.N)
        device.close()
        for use in (device.finish, lambda: technique.update(scenes.frame()), lambda: technique.render(second, scenes.floor()), technique.stats,
                    lambda: device.view(1, 1), lambda: device.info):
            with self.assertRaisesRegex(lw.InvalidHandleError, "device: expected an open one"):
                use()
        technique.close()
        with self.assertRaisesRegex(lw.InvalidHandleError, "technique|device"):
            technique.update(scenes.frame())

    def test_another_devices_handles(self):
        with lw.Device() as one, lw.Device() as other, one.technique("rsm", vpls=64) as technique, other.view(scenes.N, scenes.N) as view:
            technique.update(scenes.frame())
            with self.assertRaises(lw.InvalidHandleError):
                technique.render(view, scenes.floor())

    def test_collection_in_any_order_while_work_is_on_its_way(self):
        for order in (("device", "view", "technique", "output"), ("output", "technique", "view", "device"), ("view", "device", "output", "technique")):
            held = {"device": lw.Device()}
            held["view"], held["technique"] = held["device"].view(scenes.N, scenes.N), held["device"].technique("rsm", vpls=0)
            gone = [weakref.ref(each) for each in held.values()]
            for turn in range(3):
                held["technique"].update(scenes.frame())
                held["output"] = held["technique"].render(held["view"], scenes.floor(), wait=False)
            for name in order:
                del held[name]
                gc.collect()
            self.assertEqual([each() for each in gone], [None] * 3)

    def test_arrays_live_until_the_device_has_finished(self):
        with lw.Device() as device, device.technique("rsm", vpls=0, interleave=1) as technique:
            view, gbuffer = device.view(scenes.N, scenes.N), scenes.floor()
            technique.update(scenes.frame())
            truth = technique.render(view, gbuffer).irradiance.copy()
            position = gbuffer.position.copy()
            seen = weakref.ref(position)
            technique.update(scenes.frame())  # its arrays have no other owner
            output = technique.render(view, lw.GBuffer(position=position, normal=gbuffer.normal), wait=False)
            del position
            gc.collect()
            self.assertIsNotNone(seen())
            device.finish()
            self.assertEqual(output.irradiance.tobytes(), truth.tobytes())
            self.assertIsNotNone(seen())  # debug views may look into it
            technique.render(view, gbuffer)
            gc.collect()
            self.assertIsNone(seen())

    def test_a_technique_keeps_its_parts(self):
        with lw.Device() as device:
            first, second = (device.technique("rsm", vpls=32, seed=seed) for seed in (1, 2))
            both = device.technique("fallback", first=first, second=second)
            del first, second
            gc.collect()
            both.update(scenes.frame())
            self.assertGreater(float(both.render(device.view(scenes.N, scenes.N), scenes.floor()).irradiance.max()), 0)


class Reports(Contract):
    def test_stats_and_debug_views(self):
        frame = scenes.frame()
        frame.index = 7
        self.technique.update(frame)
        output = self.technique.render(self.view, scenes.floor(), validity=True)
        stats = self.technique.stats()
        self.assertEqual((stats["frame_index"], stats["counts"]["vpls"]), (7, 64))
        self.assertTrue(all(p["launches"] >= 1 and (p["ms"] is None or p["ms"] >= 0) for p in stats["passes"].values()), stats)
        self.assertGreater(stats["device_bytes"], 0)
        self.assertEqual(output.validity.shape, (scenes.N, scenes.N))
        for view in (None, self.view):
            views = self.technique.debug_views(view)
            self.assertTrue(views)
            for each in views:
                picture = self.technique.debug_view(each.name, view)
                self.assertEqual(picture.shape, (each.height, each.width, each.channels))
                self.assertTrue(each.description)
        with self.assertRaisesRegex(lw.InvalidArgumentError, "name: expected one of .*, got 'nothing'"):
            self.technique.debug_view("nothing")

    def test_inputs_are_checked(self):
        gbuffer = scenes.floor()
        self.assertEqual(self.view.check_inputs(scenes.frame(), gbuffer), [])
        gbuffer.normal = np.float32(0.5) * gbuffer.normal + np.float32(0.5)
        findings, overlay = self.view.check_inputs(scenes.frame(), gbuffer, overlay=True)
        self.assertEqual((findings[0].fault, findings[0].severity), (lw.InputFault.NORMAL_ENCODED, lw.Severity.ERROR))
        self.assertIn("normal", findings[0].argument)
        self.assertEqual(overlay.shape, (scenes.N, scenes.N, 3))
        np.testing.assert_allclose(overlay[5, 5] / overlay[5, 5].max(), np.array(findings[0].colour) / max(findings[0].colour), atol=0.5)
        self.assertEqual([fault for fault, _, _ in lw.input_faults()], list(lw.InputFault))

    def test_plans(self):
        gbuffer, frame = scenes.floor(), scenes.frame()
        gbuffer.camera = lw.Camera(lw.look_at((0.5, 2, 0.5), (0.5, 0, 0.5), (0, 0, -1)), lw.orthographic(1, 1, 0, 4))
        plan = self.view.plan(frame, gbuffer, budget_ms=100)
        self.assertTrue(plan.within_budget and 0 < plan.predicted_ms <= 100 and 0 < plan.confidence <= 1, plan)
        self.assertIn(plan.technique, plan.reason)
        self.assertTrue(0 <= plan.probes.facing <= 1)
        with self.device.technique_from_text(plan.technique, plan.parameters) as technique:
            self.assertEqual(technique.name, plan.technique)
        plans = self.view.plans(frame, gbuffer, budget_ms=100)
        times = [each.predicted_ms for each in plans]
        self.assertEqual(times, sorted(times))
        self.assertIn((plan.technique, plan.parameters), [(each.technique, each.parameters) for each in plans])
        with self.assertRaisesRegex(lw.InvalidArgumentError, "views"):
            self.view.plan(frame, gbuffer, views=65)

    def test_sizes_and_memory(self):
        with self.device.view(64, 48) as view:
            view.resize(20, 10)
            self.assertEqual(view.size, (20, 10))
            for size in ((65, 48), (0, 4), (-1, 4)):
                with self.assertRaises(lw.InvalidArgumentError):
                    view.resize(*size)
        for size in ((0, 4), (4, 99999), (-1, 4)):
            with self.assertRaises(lw.InvalidArgumentError):
                self.device.view(*size)
        small, large = (self.device.estimate_memory("rsm", side, side, vpls=64) for side in (64, 256))
        self.assertLess(small, large)
        self.assertGreater(self.device.estimate_memory("rsm", 64, 64, frame=scenes.frame(), vpls=64), 0)
        self.assertGreater(self.device.info.compute_units, 0)
        self.assertTrue(any(info.name == self.device.info.name for info in lw.devices()))

    def test_log(self):
        # A cache that cannot be written is told of. Inside the log function the library takes no calls: a view that is collected
        # there is given back later, and an exception does not cross the library.
        lines, held = [], {"view": self.device.view(8, 8)}

        def log(level, message):
            lines.append((level, message))
            with self.assertRaises(lw.ReentrantError):
                self.device.info
            held.clear()
            gc.collect()
            self.assertEqual(len(_handles._deferred), 1)
            raise RuntimeError("shown on stderr, and no more")

        with contextlib.redirect_stderr(io.StringIO()) as shown:
            with lw.Device(cache_directory="/dev/null/none", log=log) as device:
                with device.technique("rsm", vpls=64) as technique:
                    technique.update(scenes.frame())
                    technique.render(device.view(scenes.N, scenes.N), scenes.floor())
        self.assertIn("shown on stderr, and no more", shown.getvalue())
        self.assertEqual([level for level, _ in lines], [lw.LogLevel.WARNING])
        self.assertIn("/dev/null/none", lines[0][1])
        self.assertEqual(_handles._deferred, [])


class Threads(Contract):
    def test_threads_share_a_device(self):
        self.technique.update(scenes.frame())
        truth = self.technique.render(self.view, scenes.floor()).irradiance.tobytes()
        wrong = []

        def frames(number):
            try:
                technique, view = self.device.technique("rsm", vpls=64, interleave=2), self.device.view(scenes.N, scenes.N)
                for turn in range(4):
                    technique.update(scenes.frame())
                    output = technique.render(view, scenes.floor(), wait=bool(turn % 2))
                    self.device.finish()
                    if output.irradiance.tobytes() != truth:
                        wrong.append((number, turn, "other bits"))
                    with self.assertRaises(lw.InvalidArgumentError):
                        technique.render(view, lw.GBuffer())
                    technique.stats()
            except BaseException as error:  # shown by the test's own thread
                wrong.append((number, error))

        threads = [threading.Thread(target=frames, args=(number,)) for number in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


if __name__ == "__main__":
    unittest.main()
