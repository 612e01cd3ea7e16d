"""A device with a technique and a view, which suites share."""
import unittest

import lightwell as lw
import scenes


class Contract(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.device = lw.Device()
        cls.technique = cls.device.technique("rsm", vpls=64, interleave=2)
        cls.view = cls.device.view(scenes.N, scenes.N)

    @classmethod
    def tearDownClass(cls):
        cls.device.close()
