"""Arrays as images: any strides without a copy where LWImage has words for them, the same bits by every way, refusals by name."""
import unittest

import numpy as np

import lightwell as lw
import scenes
from lightwell._images import Kept, fill_image
from lightwell._library import ffi


def placed(array, **more):
    """The LWImage of an array, and what was copied for it."""
    target, kept = ffi.new("LWImage*"), Kept()
    fill_image(target, lw.Image(array, **more) if more else array, "image", kept)
    return target, kept


class Layouts(unittest.TestCase):
    def assert_pixels(self, array, planar=False):
        """Every element is where the struct says, without a copy."""
        image, kept = placed(array)
        self.assertEqual(kept.copied, 0)
        height, width = array.shape[:2]
        channels = array.shape[2] if array.ndim == 3 else 1
        size = array.dtype.itemsize
        self.assertEqual((image.width, image.height), (width, height))
        self.assertEqual(image.format in (lw.Format.PLANAR_FLOAT2, lw.Format.PLANAR_FLOAT3), planar)
        step = image.bytePlaneStride if planar else size
        first = int(ffi.cast("uintptr_t", image.host)) + image.byteOffset
        flat = np.atleast_3d(array)
        for y, x, c in np.ndindex(height, width, channels):
            at = first + y * image.byteRowStride + x * image.bytePixelStride + c * step
            self.assertEqual(at, flat[y:y + 1, x:x + 1, c:c + 1].ctypes.data)
        # The memory's start lies at or before all of it.
        self.assertGreaterEqual(image.byteOffset + min(0, (height - 1) * image.byteRowStride), 0)

    def test_layouts_without_a_copy(self):
        base = np.zeros((6, 7, 4), np.float32)
        for array in (base, base[..., :3], base[..., 1:3], base[..., 0], base[::2, ::3, :3], base[::-1], base[1:5, 2:6], base[:1], base[:, :1],
                      base.astype(np.float16), base.astype(np.uint8), base[..., :2].astype(np.int16), base[..., 0] > 0,
                      base[:3, :, 0][::-1], np.zeros((1, 1), np.float32), np.zeros((5, 4, 1), np.float32)):
            with self.subTest(shape=array.shape, strides=array.strides):
                self.assert_pixels(array)

    def test_planar_layouts(self):
        planes = np.zeros((3, 6, 16), np.float32)
        side_by_side = np.zeros((6, 3, 16), np.float32)
        for array in (planes.transpose(1, 2, 0), planes[:, ::-1, :5].transpose(1, 2, 0), planes[:, :, ::2].transpose(1, 2, 0),
                      planes[::2].transpose(1, 2, 0), side_by_side.transpose(0, 2, 1), lw.empty_image(5, 20, 3), lw.empty_image(5, 20, 2)):
            with self.subTest(shape=array.shape, strides=array.strides):
                self.assert_pixels(array, planar=True)

    def test_what_has_to_be_copied(self):
        base = np.arange(6 * 7 * 4, dtype=np.float32).reshape(6, 7, 4)
        odd = np.zeros(6 * 7 * 3 * 4 + 1, np.uint8)[1:].view(np.float32).reshape(6, 7, 3)
        for array in (base[:, ::-1, :3], base[..., 2::-1], base.transpose(1, 0, 2), np.broadcast_to(np.float32([0, 1, 0]), (4, 5, 3)), odd):
            with self.subTest(shape=array.shape, strides=array.strides):
                image, kept = placed(array)
                self.assertEqual(kept.copied, array.nbytes)
                copy = kept.objects[0]
                self.assertEqual(int(ffi.cast("uintptr_t", image.host)), copy.ctypes.data)
                np.testing.assert_array_equal(copy, array)

    def test_empty_images_are_used_in_place(self):
        for width in (1, 16, 24):
            image = lw.empty_image(4, width, 3)
            self.assertEqual(image.shape, (4, width, 3))
            self.assertEqual((image.ctypes.data % 64, image.strides[0] % 64, image.strides[2] % 64, image.strides[1]), (0, 0, 0, 4))
        self.assertEqual(lw.empty_image(4, 5).shape, (4, 5))
        for arguments in ((0, 4, 3), (4, 0, 3), (4, 4, 4), (4, 4, 0)):
            with self.assertRaisesRegex(lw.InvalidArgumentError, "empty_image: expected"):
                lw.empty_image(*arguments)

    def test_refusals(self):
        good = np.zeros((4, 4, 3), np.float32)
        for array in (good.astype(np.float64), good.astype(np.int32), good.astype(">f4"), good[0, 0], good[None], np.zeros((4, 4, 5), np.float32),
                      good.astype(np.float16), np.zeros((4, 4, 3), np.uint8), np.zeros((0, 4, 3), np.float32), np.zeros((4, 4), complex)):
            with self.subTest(dtype=array.dtype, shape=array.shape):
                with self.assertRaisesRegex(lw.InvalidArgumentError, r"image: expected .*, got \S+ \("):
                    placed(array)
        for other in ([[1, 2, 3]], np.float32(1), np.ma.masked_array(good, mask=good > 1)):  # a mask would be passed over
            with self.assertRaisesRegex(lw.InvalidArgumentError, "image: expected a NumPy array, got (list|float32|MaskedArray)"):
                placed(other)
        with self.assertRaisesRegex(lw.InvalidArgumentError, "image: expected an array of format OCT16X2, got one of FLOAT3"):
            placed(good, format=lw.Format.OCT16X2)
        with self.assertRaisesRegex(lw.InvalidArgumentError, "image: expected format, width and height beside cl_mem"):
            fill_image(ffi.new("LWImage*"), lw.Image(cl_mem=8), "image", Kept())
        self.assertEqual(placed(np.zeros((4, 4, 4), np.uint8), format=lw.Format.UNORM8X4_SRGB)[0].format, lw.Format.UNORM8X4_SRGB)


class SameLight(unittest.TestCase):
    def test_every_layout_gives_the_same_bits(self):
        with lw.Device() as device, device.technique("rsm", vpls=0, interleave=1) as technique:
            technique.update(scenes.frame())
            view, gbuffer = device.view(scenes.N, scenes.N), scenes.floor()
            first = technique.render(view, gbuffer).irradiance.copy()
            self.assertGreater(float(first.min()), 0)
            wide = np.full((scenes.N, 2 * scenes.N, 4), np.nan, np.float32)
            wide[:, ::2, :3] = gbuffer.position
            in_place = lw.empty_image(scenes.N, scenes.N, 3)
            in_place[:] = gbuffer.position
            ways = {"pixel stride": wide[:, ::2, :3], "bottom-up": np.ascontiguousarray(gbuffer.position[::-1])[::-1],
                    "planes": np.ascontiguousarray(gbuffer.position.transpose(2, 0, 1)).transpose(1, 2, 0), "in place": in_place}
            for name, position in ways.items():
                with self.subTest(name):
                    out = np.full((scenes.N, scenes.N, 3), -1, np.float32)
                    self.assertIs(technique.render(view, lw.GBuffer(position=position, normal=gbuffer.normal), irradiance=out).irradiance, out)
                    self.assertEqual(out.tobytes(), first.tobytes())
            self.assertEqual(device.copied_bytes, 0)
            self.assertIn(("position", "planar, used in place"), technique.stats()["choices"])
            self.assertIn(("output.irradiance", "planar, written in place"), self.in_place_choices(technique, view, in_place, gbuffer))
            mirrored = lw.GBuffer(position=gbuffer.position[:, ::-1].copy()[:, ::-1], normal=gbuffer.normal)
            self.assertEqual(technique.render(view, mirrored).irradiance.tobytes(), first.tobytes())
            self.assertEqual(device.copied_bytes, gbuffer.position.nbytes)

    @staticmethod
    def in_place_choices(technique, view, position, gbuffer):
        technique.render(view, lw.GBuffer(position=position, normal=gbuffer.normal))
        return technique.stats()["choices"]

    def test_outputs_that_cannot_be_written(self):
        with lw.Device() as device, device.technique("rsm", vpls=64) as technique:
            technique.update(scenes.frame())
            view, gbuffer = device.view(scenes.N, scenes.N), scenes.floor()
            fixed = np.zeros((scenes.N, scenes.N, 3), np.float32)
            fixed.flags.writeable = False
            for out, words in ((fixed, "may be written, got a read-only one"), (np.zeros((scenes.N, scenes.N, 3)), "got float64"),
                               (np.zeros((scenes.N, scenes.N, 3), np.float32)[:, ::-1], "with strides"),
                               (np.zeros((scenes.N, 8, 3), np.float32), "expected 24 x 24 pixels, got 8 x 24")):
                with self.assertRaisesRegex(lw.InvalidArgumentError, "output.irradiance.*" + words):
                    technique.render(view, gbuffer, irradiance=out)


if __name__ == "__main__":
    unittest.main()
