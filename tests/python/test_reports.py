"""Reports: stats, debug views, findings, plans, sizes, the log."""
import contextlib
import gc
import io
import unittest

import numpy as np

import lightwell as lw
import scenes
from contract import Contract
from lightwell import _handles


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
        with self.assertRaisesRegex(lw.InvalidArgumentError, "version: expected a version with desc.atRest"):
            self.view.plan(frame, gbuffer, at_rest=True)
        for rsm in frame.lights[0].rsms:
            rsm.version = 1
        resting = {(each.technique, each.parameters): each.predicted_ms for each in self.view.plans(frame, gbuffer, budget_ms=100, at_rest=True)}
        self.assertTrue(all(resting[each.technique, each.parameters] <= each.predicted_ms for each in plans))
        self.assertLessEqual(self.view.plan(frame, gbuffer, at_rest=True).predicted_ms, max(times))

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


if __name__ == "__main__":
    unittest.main()
