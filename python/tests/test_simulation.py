"""The class ``Simulation``: steps, views, threads, forks, errors. Needs numpy alone."""

import gc
import multiprocessing
import os
import signal
import threading
import timeit
import unittest

import numpy as np

import gaitway as gw
from common import LONG, ROOT, resident, state_hash

LINE = """
name = "line"
bounds = [[-10, -3], [10, -3], [10, 3], [-10, 3]]

[[walkers]]
position = [-9, 0]
waypoints = [[9, 0]]

[[routes]]
name = "there"
waypoints = [[-9, 0], [9, 0]]

[population]
agents = 0
"""


def crossing(**names):
    return gw.Simulation("crossing", **{"agents": 60, "seed": 7, "backend": "cpu", **names})


def hash_after(seed, steps):
    sim = crossing(seed=seed)
    sim.step(steps)
    return sim.state_hash


class Steps(unittest.TestCase):
    def test_the_state_hash_is_that_of_the_command_line(self):
        sim = gw.Simulation("crossing", agents=300, seed=7, backend="cpu", set={"navigation.patience": 1.0})
        sim.step(90)
        words = ("crossing", "--agents", 300, "--seed", 7, "--seconds", 3, "--set", "navigation.patience=1.0")
        self.assertEqual(sim.state_hash, state_hash(*words, "--backend", "cpu"))
        self.assertEqual((sim.steps, sim.time), (90, 3.0))

    def test_steps_can_be_done_in_any_portions(self):
        one, other = crossing(), crossing()
        one.step(50)
        for steps in (1, 0, 17, 32):
            other.step(steps)
        self.assertEqual(one.state_hash, other.state_hash)
        one.step()
        self.assertNotEqual(one.state_hash, other.state_hash)

    def test_a_scene_is_a_name_a_path_or_a_text(self):
        path = ROOT / "assets" / "scenes" / "garden.toml"
        hashes = set()
        for scene in (path, str(path), path.read_text()):
            sim = gw.Simulation(scene, agents=20, seed=3, backend="cpu")
            sim.step(10)
            hashes.add(sim.state_hash)
        self.assertEqual(len(hashes), 1)
        self.assertEqual(gw.scenes(), ["crossing", "garden", "parking", "scifi"])
        patience = gw.scenario.schema()["properties"]["navigation"]["properties"]["patience"]
        self.assertEqual((patience["unit"], patience["maximum"]), ("s", 600))
        self.assertIn("line", repr(gw.Simulation(LINE)))
        told = gw.Simulation(LINE, set={"description": 'a "b"', "population.emotions": {"sad": 1.0}})
        self.assertIn("""description = 'a "b"'""", told.scenario)
        self.assertIn("sad = 1.0", told.scenario)

    def test_people_walk_and_stay_what_they_are(self):
        sim = crossing()
        before = sim.positions.copy()
        emotions = sim.emotions.copy()
        sim.step(60)
        moved = np.linalg.norm(sim.positions - before, axis=1)
        speeds = np.linalg.norm(sim.velocities, axis=1)
        self.assertGreater(np.median(moved), 1.0)
        self.assertTrue(((0.0 <= speeds) & (speeds < 3.0)).all())
        np.testing.assert_array_equal(sim.emotions, emotions)
        np.testing.assert_allclose(sim.emotions.sum(axis=1), 1.0, atol=1e-6)
        walking = speeds > 0.5
        ahead = np.stack([np.sin(sim.headings), np.cos(sim.headings)], axis=1)
        along = (ahead * sim.velocities).sum(axis=1)[walking] / speeds[walking]
        self.assertGreater(np.median(along), 0.9, "heading 0 faces +z, positive towards +x")

    def test_absent_agents_are_masked_and_the_mask_ends_a_loop(self):
        text = (ROOT / "assets" / "scenes" / "station.toml").read_text()
        sim = gw.Simulation(text, agents=40, seed=1, backend="cpu")
        sim.step(300)
        there = sim.present
        self.assertEqual((there.shape, there.dtype), ((41,), np.dtype(bool)))
        self.assertTrue(there.any() and not there.all() and bool(there))
        self.assertLess(np.abs(sim.positions[there]).max(), 100.0)
        self.assertGreaterEqual(sim.positions[~there].min(), 1e9)
        self.assertFalse(there[:0])
        self.assertEqual(sim.measures()["present"], int(there.sum()))

    def test_a_run_records_as_steps_do(self):
        one, other = crossing(), crossing(record=0.1)
        run = one.run(seconds=1.0, every=0.1)
        for _ in range(10):
            other.step(3)
        for name in run.columns:
            np.testing.assert_array_equal(run[name], other.trajectories[name], name)
        self.assertEqual(len(run), 11 * 60)
        self.assertAlmostEqual(run.frame_rate, 10.0)
        self.assertAlmostEqual(other.trajectories.frame_rate, 10.0)
        np.testing.assert_array_equal(run["x_m"][-60:], one.positions[:, 0])

    def test_frames_are_equally_far_apart(self):
        sim = crossing()
        run = sim.run(1.0, every=0.3)
        np.testing.assert_allclose(np.unique(run["time_s"]), [0.0, 0.3, 0.6, 0.9], atol=1e-9)
        self.assertEqual(sim.steps, 30)

    def test_a_run_until_the_place_is_empty_ends_there(self):
        empty = crossing(agents=0)
        empty.run(5.0, until_empty=True)
        somewhere = crossing()
        somewhere.run(1.0, until_empty=True)
        self.assertEqual((empty.steps, somewhere.steps), (3, 30))


class Views(unittest.TestCase):
    def test_views_are_read_only_float32_over_the_same_memory(self):
        sim = crossing()
        shapes = {"positions": (60, 2), "velocities": (60, 2), "headings": (60,), "emotions": (60, 4), "elevations": (60,)}
        for name, shape in shapes.items():
            view = getattr(sim, name)
            self.assertEqual((view.shape, view.dtype), (shape, np.dtype(np.float32)), name)
            self.assertIs(view.base, sim, name)
            self.assertTrue(np.shares_memory(view, getattr(sim, name)), name)
            with self.assertRaises(ValueError):
                view[0] = 1.0
            with self.assertRaises(ValueError):
                view.flags.writeable = True

    def test_a_view_moves_with_the_crowd_and_a_copy_stays(self):
        sim = crossing()
        view, copy = sim.positions, sim.positions.copy()
        at = view.__array_interface__["data"]
        sim.step(30)
        self.assertFalse(np.array_equal(view, copy))
        np.testing.assert_array_equal(view, sim.positions)
        sim.run(1.0)
        self.assertEqual(sim.positions.__array_interface__["data"], at, "no buffer is made again")

    def test_a_view_is_safe_after_the_simulation_is_deleted(self):
        sim = crossing()
        sim.step(3)
        views = [sim.positions, sim.headings, sim.emotions]
        copies = [view.copy() for view in views]
        del sim
        gc.collect()
        others = [crossing(seed=seed).positions.copy() for seed in range(20)]
        for view, copy in zip(views, copies):
            np.testing.assert_array_equal(view, copy)
        self.assertEqual(len(others), 20)

    def test_a_view_takes_less_than_a_microsecond_at_any_size(self):
        for agents in (10, 20_000):
            sim = crossing(agents=agents)
            sim.step()
            for name in ("positions", "velocities", "headings", "emotions"):
                took = min(timeit.repeat(lambda: getattr(sim, name), number=2000, repeat=20)) / 2000
                self.assertLess(took, 1e-6, f"{name} of {agents}")
                if LONG:
                    print(f"a view of {name} of {agents}: {took * 1e6:.2f} us")

    def test_steps_and_views_take_no_memory(self):
        turns, views = (1_000_000, 1) if LONG else (2_000, 50)
        sim = crossing(agents=4)
        for _ in range(200):
            sim.step()
        before = resident()
        for _ in range(turns):
            sim.step()
            for _ in range(views):
                sim.positions, sim.headings, sim.present
        grown = resident() - before
        if LONG:
            print(f"{turns} steps and views: {grown / 1024:.0f} KiB more")
        self.assertLess(grown, 4 << 20)

    def test_the_two_planes_are_mirrored(self):
        sim = crossing()
        np.testing.assert_array_equal(sim.positions_xy[:, 0], sim.positions[:, 0])
        np.testing.assert_array_equal(sim.positions_xy[:, 1], 0.0 - sim.positions[:, 1])

    def test_an_empty_crowd_has_empty_views(self):
        sim = crossing(agents=0)
        sim.step(3)
        self.assertEqual((sim.positions.shape, sim.emotions.shape, len(sim)), ((0, 2), (0, 4), 0))
        self.assertFalse(sim.present)


class Threads(unittest.TestCase):
    def test_two_threads_step_two_simulations(self):
        alone = [hash_after(seed, 200) for seed in (1, 2)]
        found = {}
        threads = [threading.Thread(target=lambda s=s: found.update({s: hash_after(s, 200)})) for s in (1, 2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([found[1], found[2]], alone)

    def test_other_threads_run_while_a_crowd_steps(self):
        sim = crossing(agents=3000)
        sim.step()
        turns, ended = [0], threading.Event()

        def count():
            while not ended.is_set():
                turns[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        before = turns[0]
        sim.step(8)
        during = turns[0] - before
        ended.set()
        thread.join()
        self.assertGreater(during, 100)

    def test_two_threads_that_step_one_simulation_take_turns(self):
        sim = crossing()
        threads = [threading.Thread(target=lambda: [sim.step() for _ in range(50)]) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(sim.state_hash, hash_after(7, 100))

    @unittest.skipUnless(hasattr(os, "fork"), "without forks")
    def test_simulations_walk_in_forked_workers(self):
        expected = [hash_after(seed, 30) for seed in range(4)]  # the parent has threads by now
        with multiprocessing.get_context("fork").Pool(2) as pool:
            found = pool.starmap_async(hash_after, [(seed, 30) for seed in range(4)]).get(timeout=60)
        self.assertEqual(found, expected)

    @unittest.skipUnless(hasattr(os, "fork"), "without forks")
    def test_a_crowd_walks_on_in_a_fork(self):
        KEPT.append(crossing())
        KEPT[0].step(30)
        with multiprocessing.get_context("fork").Pool(1) as pool:
            found = pool.apply_async(hash_of_kept).get(timeout=60)
        KEPT[0].step(30)
        self.assertEqual(found, KEPT.pop().state_hash)

    def test_ctrl_c_ends_a_long_step_and_the_crowd_walks_on(self):
        def interrupt(*_):
            raise KeyboardInterrupt

        sim = crossing()
        before = signal.signal(signal.SIGALRM, interrupt)
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        try:
            with self.assertRaises(KeyboardInterrupt):
                sim.step(2**31)
        finally:
            signal.signal(signal.SIGALRM, before)
        done = sim.steps
        sim.step(3)
        self.assertEqual(sim.steps, done + 3)


#: A simulation of the parent that its workers see.
KEPT = []


def hash_of_kept():
    KEPT[0].step(30)
    return KEPT[0].state_hash


class Led(unittest.TestCase):
    def test_people_make_room_for_a_robot(self):
        robot = {"outsiders": [{"kind": "robot", "radius": 0.4}]}
        sim = crossing(agents=200, set=robot)
        self.assertEqual(len(sim), 201)
        self.assertFalse(sim.present[-1], "it is not there until it is led")
        place, nearest = np.array([-4.0, 0.0]), np.inf
        for step in range(300):
            place += np.array([0.8, 0.0]) / 30
            sim.lead("robot", place, velocity=(0.8, 0.0))
            sim.step()
            if step > 30:
                nearest = min(nearest, np.linalg.norm(sim.positions[:-1] - place, axis=1).min())
        np.testing.assert_allclose(sim.positions[200], place, atol=1e-4)
        self.assertGreater(nearest, 0.4)
        sim.lead(200, None)
        sim.step()
        self.assertFalse(sim.present[200])

    def test_who_cannot_be_led_is_named(self):
        with self.assertRaisesRegex(gw.BadValue, "no|0 agents of the kind 'robot'") as caught:
            crossing().lead("robot", (0, 0))
        self.assertIn("outsiders", caught.exception.hint)
        for who, words in ((3, "walks by itself"), (60, "0 to 59"), (-1, "must be 0"), (1.5, "whole number")):
            with self.assertRaisesRegex(gw.BadValue, words):
                crossing().lead(who, (0, 0))


class Errors(unittest.TestCase):
    def test_errors_say_what_where_and_what_to_do(self):
        wrong = LINE.replace("name", "nmae", 1)
        for scene, names, words in (
            ("crosing", {}, "did you mean crossing"),
            (wrong, {}, "scene text:2: .*nmae"),
            (LINE, {"set": {"navigation.patience": -1}}, "navigation.patience"),
            ("crossing", {"set": {"navigation.patienc": 1}}, "patience"),
            ("crossing", {"set": {"name": object()}}, "is a object"),
            ("crossing", {"agents": -1}, "agents = -1: must be 0 to 1000000"),
            ("crossing", {"agents": 2.5}, "agents = 2.5: must be a whole number"),
            ("crossing", {"backend": "gpu"}, "must be one of auto, vulkan, cpu"),
            ("crossing", {"condition": "eva"}, "baseline, eva-o, eva-g"),
            ("crossing", {"backend": "cpu", "device": 0}, "leave one of them out"),
            ("crossing", {"record": 0.05}, "whole number of steps"),
        ):
            with self.assertRaisesRegex(gw.BadValue, words) as caught:
                gw.Simulation(scene, **names)
            self.assertIsInstance(caught.exception, ValueError)
            self.assertIsInstance(caught.exception, gw.Error)
            self.assertTrue(caught.exception.message)
        with self.assertRaises(gw.Error) as caught:
            gw.Simulation("none.toml")
        self.assertIn("none.toml", str(caught.exception))
        with self.assertRaisesRegex(gw.Error, "record=0.1"):
            crossing().trajectories
        with self.assertRaisesRegex(gw.BadValue, "hint: "):
            crossing(backend="gpu")

    def test_a_hint_is_said_once(self):
        self.assertEqual(str(gw.Error("no; do this", "do this")), "no; do this")
        self.assertEqual(str(gw.Error("no", "do this")), "no\nhint: do this")
        self.assertIsNone(gw.Error("no").hint)


if __name__ == "__main__":
    unittest.main()
