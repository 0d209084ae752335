"""Pictures and the Vulkan backend: on a device, or the error that says what is missing."""

import multiprocessing
import os
import unittest

import numpy as np

import gaitway as gw
from common import state_hash

#: Set by scripts/test where a device must be there.
REQUIRED = os.environ.get("GAITWAY_REQUIRE_GPU") == "1"
DRAWS = not os.environ.get("GAITWAY_NO_LOADER")


def crossing(**names):
    return gw.Simulation("crossing", **{"agents": 60, "seed": 7, **names})


@unittest.skipUnless(REQUIRED, "without a Vulkan device that must be there")
class Pictures(unittest.TestCase):
    def test_the_state_hash_on_vulkan_is_that_of_the_command_line_and_of_the_cpu(self):
        sim = crossing(backend="vulkan", agents=200)
        sim.step(60)
        words = ("crossing", "--agents", 200, "--seed", 7, "--seconds", 2)
        self.assertEqual(sim.state_hash, state_hash(*words, "--backend", "vulkan"))
        cpu = crossing(backend="cpu", agents=200)
        cpu.step(60)
        self.assertEqual(sim.state_hash, cpu.state_hash)
        self.assertNotIn("CPU", sim.device)
        np.testing.assert_array_equal(sim.positions, cpu.positions)
        self.assertEqual(sim.positions.__array_interface__["data"], sim.positions.__array_interface__["data"])

    def test_a_picture_shows_people_and_changes_nothing(self):
        for backend in ("cpu", "vulkan"):
            drawn, other = crossing(backend=backend), crossing(backend=backend)
            drawn.step(30)
            view = drawn.positions
            at = view.__array_interface__["data"]
            picture = drawn.picture(size=(160, 90))
            self.assertEqual((picture.shape, picture.pixels.dtype), ((90, 160, 4), np.dtype(np.uint8)))
            self.assertEqual(np.asarray(picture).shape, (90, 160, 4))
            self.assertGreater(picture.pixels[..., :3].std(), 5.0)
            self.assertEqual(picture._repr_png_()[:8], b"\x89PNG\r\n\x1a\n")
            drawn.step(30)
            self.assertFalse(np.array_equal(drawn.picture(size=(160, 90)).pixels, picture.pixels))
            self.assertEqual(drawn.picture("follow:3", (64, 48)).shape, (48, 64, 4))
            other.step(60)
            self.assertEqual(drawn.state_hash, other.state_hash)
            self.assertEqual(drawn.positions.__array_interface__["data"], at, "the buffers stay where they are")

    def test_a_video_plays_in_jupyter(self):
        sim = crossing(backend="cpu")
        video = sim.video(seconds=0.2, size=(64, 48))
        self.assertEqual(video.data[4:8], b"ftyp")
        self.assertTrue(video._repr_html_().startswith("<video"))
        self.assertEqual(sim.steps, 5)
        with self.assertRaisesRegex(gw.BadValue, "fps"):
            sim.video(seconds=0.2, fps=7)

    def test_a_device_does_not_cross_a_fork(self):
        sim = crossing(backend="vulkan")
        sim.step(3)
        KEPT.append(sim)
        with multiprocessing.get_context("fork").Pool(1) as pool:
            for makes in (False, True):
                self.assertIn("fork", pool.apply_async(fault_of, (makes,)).get(timeout=60))
        KEPT.clear()


#: A simulation of the parent that its workers see.
KEPT = []


def fault_of(makes):
    """What a worker hears that uses its parent's device, or opens one after its parent."""
    try:
        (crossing(backend="vulkan") if makes else KEPT[0]).step(1)
    except gw.Error as error:
        return str(error)
    return "no error"


@unittest.skipIf(DRAWS, "with a Vulkan loader")
class WithoutLoader(unittest.TestCase):
    def test_pictures_say_what_is_missing(self):
        import ctypes

        with self.assertRaises(OSError):
            ctypes.CDLL("libvulkan.so.1")
        sim = crossing()
        sim.step(3)
        self.assertIn("CPU", sim.device)
        self.assertTrue(sim.fallback)
        for draw in (sim.picture, sim.video, lambda: crossing(backend="vulkan").step()):
            with self.assertRaisesRegex(gw.Error, "no Vulkan loader found") as caught:
                draw()
            self.assertTrue(caught.exception.hint)
        sim.step(3)
        self.assertEqual(sim.steps, 6, "the crowd walks on")


class Names(unittest.TestCase):
    def test_cameras_and_sizes_that_do_not_exist_are_named(self):
        sim = crossing(backend="cpu")
        with self.assertRaisesRegex(gw.BadValue, "eyes, orbit, top"):
            sim.picture("behind")
        with self.assertRaisesRegex(gw.BadValue, "must be 1 to 16384"):
            sim.picture(size=(0, 9))


if __name__ == "__main__":
    unittest.main()
