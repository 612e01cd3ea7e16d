"""Ends of objects: use after close, the order of garbage collection, threads, forks, copies."""
import copy
import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import unittest
import weakref

import lightwell as lw
import scenes
from contract import Contract


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


class Processes(Contract):
    def test_no_copies(self):
        for handle in (self.device, self.view, self.technique):
            for way in (pickle.dumps, copy.copy, copy.deepcopy):
                with self.assertRaisesRegex(TypeError, "cannot be copied or pickled"):
                    way(handle)
        again = pickle.loads(pickle.dumps(scenes.frame()))  # what they are given can be
        self.technique.update(again)
        error = pickle.loads(pickle.dumps(lw.NoDeviceError("none")))
        self.assertEqual((type(error), error.message, error.status), (lw.NoDeviceError, "none", lw.Status.NO_DEVICE))

    def test_a_fork_leaves_the_device_alone(self):
        # The driver's threads do not come along: a child that waited for them would wait for ever, at its end too.
        program = ("import os, sys, lightwell, scenes\n"
                   "device = lightwell.Device(); view = device.view(24, 24); technique = device.technique('rsm', vpls=64)\n"
                   "technique.update(scenes.frame()); output = technique.render(view, scenes.floor(), wait=False)\n"
                   "child = os.fork()\n"
                   "if child == 0:\n"
                   "    try: device.finish()\n"
                   "    except lightwell.InvalidHandleError as error: sys.exit(7 if 'before a fork' in str(error) else 8)\n"
                   "status = os.waitpid(child, 0)[1]\n"
                   "device.finish()\n"
                   "sys.exit(os.WEXITSTATUS(status) if output.irradiance.max() > 0 else 9)\n")
        environment = dict(os.environ, PYTHONPATH=os.pathsep.join(os.path.abspath(os.path.join(os.path.dirname(file), up))
                                                                             for file, up in ((lw.__file__, ".."), (scenes.__file__, "."))))
        with subprocess.Popen([sys.executable, "-c", program], env=environment, start_new_session=True) as run:
            try:
                self.assertEqual(run.wait(60), 7)
            except subprocess.TimeoutExpired:
                os.killpg(run.pid, signal.SIGKILL)
                raise


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
