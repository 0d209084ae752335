"""The environment of Gymnasium."""

import unittest

import numpy as np

from common import needs


def episode(policy, seed=5, **names):
    import gymnasium

    import gaitway.gymnasium  # registers it

    env = gymnasium.make("gaitway/RobotInCrowd-v0", **{"agents": 40, "longest": 20.0, **names})
    seen, info = env.reset(seed=seed)
    total, ended = 0.0, False
    while not ended:
        seen, reward, is_there, is_late, info = env.step(policy(seen))
        total, ended = total + reward, is_there or is_late
    return total, is_there, info, seen


def straight(seen):
    goal = seen[:2]
    return (goal / max(np.linalg.norm(goal), 1e-9)).astype(np.float32)


@needs("gymnasium")
class Robot(unittest.TestCase):
    def test_gymnasium_finds_nothing_wrong(self):
        import gymnasium
        from gymnasium.utils.env_checker import check_env

        import gaitway.gymnasium

        env = gymnasium.make("gaitway/RobotInCrowd-v0", agents=20).unwrapped
        check_env(env, skip_render_check=True)

    def test_a_robot_that_walks_straight_on_arrives_and_one_that_stands_does_not(self):
        total, is_there, info, _ = episode(straight)
        self.assertTrue(is_there)
        self.assertLess(info["distance"], 0.4)
        idle, is_there, info, _ = episode(lambda seen: np.zeros(2, np.float32))
        self.assertFalse(is_there)
        self.assertAlmostEqual(info["distance"], 16.0, places=3)
        self.assertGreater(total, idle + 10.0)

    def test_a_seed_gives_the_same_episode(self):
        one, other, third = (episode(straight, seed=seed) for seed in (3, 3, 4))
        self.assertEqual(one[0], other[0])
        np.testing.assert_array_equal(one[3], other[3])
        self.assertNotEqual(one[0], third[0])


if __name__ == "__main__":
    unittest.main()
