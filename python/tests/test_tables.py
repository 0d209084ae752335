"""Tables, gaits, the perceiver, statistics: what becomes of them in pandas, polars, pyarrow and PedPy."""

import tempfile
import unittest
from pathlib import Path

import numpy as np

import gaitway as gw
from common import SCENES, needs, program


def crossing(**names):
    return gw.Simulation("crossing", **{"agents": 60, "seed": 7, "backend": "cpu", **names})


class Tables(unittest.TestCase):
    @needs("pyarrow", "pandas", "polars")
    def test_pyarrow_pandas_and_polars_take_a_table_as_it_is(self):
        import pandas
        import polars
        import pyarrow

        run = crossing().run(1.0)
        arrow = pyarrow.table(run)
        arrow.validate(full=True)
        frame = pandas.DataFrame.from_arrow(run)
        other = polars.DataFrame(run)
        self.assertEqual(arrow.num_rows, len(run))
        self.assertEqual(arrow.column_names, run.columns)
        self.assertEqual(arrow.field("vx_m_s").metadata, {b"unit": b"m/s"})
        for name in run.columns:
            own = list(run[name])
            self.assertEqual(arrow[name].to_pylist(), own, name)
            self.assertEqual(frame[name].tolist(), own, name)
            self.assertEqual(other[name].to_list(), own, name)
        shares = frame.groupby("emotion", observed=True).size()
        self.assertEqual(shares.sum(), len(run))

    def test_columns_are_those_of_the_command_line(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "walk.csv"
            words = ("crossing", "--agents", 60, "--seed", 7, "--seconds", 1, "--backend", "cpu")
            program("simulate", *words, "--out", file)
            rows = [line.split(",") for line in file.read_text().splitlines()]
        run = crossing().run(1.0)
        self.assertEqual(rows[0], run.columns)
        self.assertEqual(len(rows) - 1, len(run))
        for at, name in enumerate(run.columns):
            own = run[name]
            if isinstance(own, list):
                self.assertEqual([row[at] for row in rows[1:]], own, name)
            else:
                read = np.array([row[at] for row in rows[1:]], dtype=own.dtype)
                np.testing.assert_allclose(own, read, atol=1e-6, err_msg=name)

    def test_who_is_absent_has_no_row(self):
        station = next(path for path in SCENES if path.stem == "station")
        sim = gw.Simulation(station, agents=40, seed=1, backend="cpu")
        run = sim.run(10.0, every=1.0)
        last = run["frame"] == run["frame"].max()
        self.assertEqual(int(last.sum()), int(sim.present.sum()))
        self.assertLess(len(run), 11 * 40)
        self.assertLess(np.abs(run["x_m"]).max(), 1000.0)

    def test_a_robot_feels_nothing(self):
        sim = crossing(set={"outsiders": [{"kind": "robot"}]})
        sim.lead("robot", (0, 0))
        sim.step()
        run = sim.run(0.1)
        robots = [emotion for kind, emotion in zip(run["kind"], run["emotion"]) if kind == "robot"]
        self.assertEqual(robots, [None, None])
        agents = sim.agents
        self.assertEqual((agents["kind"][-1], agents["emotion"][-1], bool(agents["led"][-1])), ("robot", None, True))
        self.assertTrue(np.isnan(agents["happy"][-1]))

    def test_the_table_of_agents_agrees_with_the_views(self):
        sim = crossing()
        weights = np.stack([sim.agents[name] for name in gw.EMOTIONS], axis=1)
        np.testing.assert_array_equal(weights, sim.emotions)
        strongest = [gw.EMOTIONS[index] for index in weights.argmax(axis=1)]
        self.assertEqual(sim.agents["emotion"], strongest)
        with self.assertRaisesRegex(KeyError, "the columns are id, kind"):
            sim.agents["nothing"]

    def test_large_recordings_keep_every_row(self):
        run = crossing(agents=2000).run(4.0, every=1 / 10)
        self.assertEqual(len(run), 41 * 2000)
        np.testing.assert_array_equal(run["frame"], np.repeat(np.arange(41), 2000))


class PedPy(unittest.TestCase):
    @needs("pedpy")
    def test_voronoi_polygons_of_all_scenes(self):
        import pedpy

        self.assertGreaterEqual(len(SCENES), 5)
        for scene in SCENES:
            with self.subTest(scene.stem):
                run = gw.Simulation(scene, agents=150, seed=7, backend="cpu").run(20.0, every=5.0)
                people = run.to_pedpy()
                cells = pedpy.compute_individual_voronoi_polygons(**people)
                crowded = people.data.groupby("frame").filter(lambda frame: len(frame) >= 4)
                found = cells.merge(crowded, on=["id", "frame"])
                self.assertEqual(len(found), len(crowded))
                self.assertGreater(len(crowded), 20)
                self.assertGreater(cells["density"].min(), 0.0)

    @needs("pedpy")
    def test_pedpy_gets_trajectories_in_its_own_plane(self):
        import pedpy
        import shapely

        sim = crossing(set={"outsiders": [{"kind": "robot"}]})
        sim.lead("robot", (0, 0))
        run = sim.run(1.0)
        people = run.to_pedpy()
        self.assertIsInstance(people, pedpy.TrajectoryData)
        self.assertAlmostEqual(people.frame_rate, 10.0)
        kind = np.array(run["kind"]) == "person"
        self.assertEqual(len(people.data), int(kind.sum()))
        np.testing.assert_allclose(people.data["y"], -run["z_m"][kind], atol=1e-6)
        self.assertTrue(shapely.is_valid(run.walkable_area.polygon))
        inside = shapely.contains_xy(sim.walkable_area.polygon, people.data["x"], people.data["y"])
        self.assertTrue(inside.all())
        speeds = pedpy.compute_individual_speed(traj_data=people, frame_step=3, speed_calculation=pedpy.SpeedCalculation.BORDER_SINGLE_SIDED)
        self.assertTrue(0.5 < speeds["speed"].mean() < 2.0)


class Gaits(unittest.TestCase):
    def test_gaits_are_measured_and_come_back_from_a_file(self):
        gaits = gw.gaits.built_in()
        self.assertEqual(len(gaits), 48)
        first = gaits[0]
        self.assertEqual(first.poses.shape[1:], (16, 3))
        self.assertEqual(len(gw.gaits.JOINTS), 16)
        self.assertAlmostEqual(first.cycle_time, len(first.poses) / first.frame_rate)
        features = gaits.features()
        self.assertEqual((len(features), len(features.columns)), (48, 31))
        self.assertEqual(features.units["stride_length"], "m")
        np.testing.assert_allclose(features["cycle_time"], [gait.cycle_time for gait in gaits], rtol=0.02)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "mine.glb"
            gaits.save(file)
            again = gw.gaits.load(file)
        np.testing.assert_array_equal(again[-1].poses, gaits[-1].poses)
        with self.assertRaises(IndexError):
            gaits[48]
        with self.assertRaisesRegex(gw.BadValue, "corrected"):
            gaits.features("best")

    def test_motion_files_become_gaits_and_errors_name_the_line(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "walk.bvh"
            file.write_text("HIERARCHY\nROOT Hips\n{\n")
            with self.assertRaisesRegex(gw.Error, r"walk.bvh:\d"):
                gw.gaits.load(file)

    def test_a_crowd_walks_with_gaits_of_ours(self):
        sad = gw.gaits.built_in(expression=3.0)
        one, other = crossing(library=sad), crossing()
        one.step(30)
        other.step(30)
        self.assertNotEqual(one.state_hash, other.state_hash)

    def test_people_would_see_what_the_labels_say_more_often_than_not(self):
        seen = gw.Perceiver().predict(gw.gaits.built_in())
        right = np.mean([own == label for own, label in zip(seen["emotion"], seen["label"])])
        self.assertGreater(right, 0.5)
        total = sum(seen[name] for name in gw.EMOTIONS)
        np.testing.assert_allclose(total, 1.0, atol=1e-9)
        with self.assertRaises(gw.Error):
            gw.Perceiver("none.json")


class Statistics(unittest.TestCase):
    def test_tests_of_studies_give_the_published_numbers(self):
        answers = [[2, 4, 6], [3, 3, 5], [1, 4, 4], [2, 5, 7], [4, 4, 5]]
        found = gw.statistics.friedman(answers)
        self.assertEqual((found["people"], found["conditions"]), (5, 3))
        self.assertLess(found["exact_p"], 0.05)
        pairs = gw.statistics.wilcoxon([1, 2, 3, 4, 5, 6])
        self.assertEqual((pairs["w_plus"], pairs["p"]), (21.0, 2 / 64))
        np.testing.assert_allclose(gw.statistics.adjust([0.01, 0.04, 0.03]), [0.03, 0.06, 0.06])
        self.assertEqual(gw.statistics.describe([1, 2, 3])["mean"], 2.0)
        # Shrout and Fleiss 1979, table 2
        ratings = [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]
        models = gw.statistics.icc(ratings)
        self.assertAlmostEqual(models["agreement"]["single"], 0.29, places=2)
        self.assertAlmostEqual(models["consistency"]["single"], 0.71, places=2)
        with self.assertRaises(gw.BadValue):
            gw.statistics.describe([])

    def test_data_of_studies_are_tables(self):
        with tempfile.TemporaryDirectory() as folder:
            data = Path(folder) / "run"
            program("study", "simulate", "eva-agents", "--participants", 8, "--out", data)
            answers, participants = gw.study.load(data)
            lines = (data / "answers.csv").read_text().splitlines()
            self.assertEqual(len(answers), len(lines) - 1)
            self.assertEqual(len(participants), 8)
            self.assertEqual(set(answers["front"]), {"simulated"})
            self.assertEqual(answers["participant"], [line.split(",")[0] for line in lines[1:]])
            self.assertGreater(np.isfinite(answers["value"]).sum(), 100)
            (data / "answers.csv").write_text("participant,front\n")
            with self.assertRaisesRegex(gw.Error, "answers"):
                gw.study.load(data)
            with self.assertRaisesRegex(gw.Error, "cannot read") as caught:
                gw.study.load(Path(folder) / "none")
            self.assertIn("study simulate", caught.exception.hint)


if __name__ == "__main__":
    unittest.main()
