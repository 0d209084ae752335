"""A robot among people, as an environment of Gymnasium: ``gymnasium.make("gaitway/RobotInCrowd-v0")``.

Importing this module registers it. It needs the package ``gymnasium``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from ._errors import Error
from ._simulation import Simulation

#: Name in Gymnasium's registry.
ID = "gaitway/RobotInCrowd-v0"


class RobotInCrowd(gymnasium.Env):
    """A robot that crosses a place among people, who make room for it.

    Action: the wanted velocity (x, z) as a part of ``max_speed``, ``(2,)`` in -1 to 1; longer ones are cut to 1.

    Observation, float32 ``(4 + 5 * nearest,)``, all relative to the robot: the goal (x, z), m; the robot's velocity (x, z), m/s; and
    for each of the ``nearest`` people, by rising distance, its place (x, z), m, its velocity (x, z), m/s, and 1. Places without
    a person within ``sight`` metres are zeros.

    Reward of a decision: the metres that the goal came nearer, less ``discomfort`` for each person in proportion to how deep it is
    within ``personal_space`` metres of the robot's edge, less ``collision`` for each person it touches, plus ``arrival`` at the goal.

    An episode ends at the goal (``terminated``) or after ``longest`` seconds (``truncated``). ``info`` has ``distance`` to the goal,
    ``nearest`` (m from the robot's edge to the nearest body), ``touches`` and ``is_success``.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}

    def __init__(
        self,
        scene: str = "crossing",
        *,
        agents: int | None = 60,
        start: tuple[float, float] = (-8.0, 0.0),
        goal: tuple[float, float] = (8.0, 0.0),
        radius: float = 0.4,
        max_speed: float = 1.2,
        max_acceleration: float = 2.0,
        nearest: int = 8,
        sight: float = 8.0,
        decision: float = 0.1,
        longest: float = 60.0,
        personal_space: float = 0.5,
        discomfort: float = 0.1,
        collision: float = 1.0,
        arrival: float = 10.0,
        set: Mapping[str, Any] | None = None,
        backend: str = "cpu",
        render_mode: str | None = None,
    ) -> None:
        self.scene, self.agents, self.backend, self.render_mode = scene, agents, backend, render_mode
        self.start, self.goal = np.asarray(start, float), np.asarray(goal, float)
        self.radius, self.max_speed, self.max_acceleration = radius, max_speed, max_acceleration
        self.nearest, self.sight, self.decision, self.longest = nearest, sight, decision, longest
        self.personal_space, self.discomfort = personal_space, discomfort
        self.collision, self.arrival = collision, arrival
        self.set = {**(set or {}), "outsiders": [{"kind": "robot", "radius": radius}]}
        self._sim: Simulation | None = None
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        most = [1e4, 1e4, max_speed, max_speed, *[sight, sight, 10.0, 10.0, 1.0] * nearest]
        high = np.asarray(most, np.float32)
        self.observation_space = spaces.Box(-high, high, dtype=np.float32)

    @property
    def sim(self) -> Simulation:
        """The crowd of this episode.

        Raises:
            Error: before the first ``reset``.
        """
        if self._sim is None:
            raise Error("there is no episode yet", "call reset() first")
        return self._sim

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode: a seed gives the same crowd and the same episode."""
        super().reset(seed=seed)
        crowd = int(self.np_random.integers(2**31))
        self._sim = Simulation(
            self.scene, agents=self.agents, seed=crowd, set=self.set, backend=self.backend
        )
        self.place, self.velocity = self.start.copy(), np.zeros(2)
        self.radii = np.nan_to_num(self.sim.agents["radius_m"])
        self.people = np.asarray([kind == "person" for kind in self.sim.agents["kind"]])
        self._walk(1)
        return self._observe(), self._info()

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Walk for ``decision`` seconds towards the wanted velocity."""
        wanted = np.asarray(action, float)
        wanted = self.max_speed * wanted / max(1.0, float(np.linalg.norm(wanted)))
        before = self._distance()
        self._walk(max(1, round(self.decision / self.sim.time_step)), wanted)
        info = self._info()
        gaps = self._gaps()
        depth = np.clip(1.0 - gaps / self.personal_space, 0.0, 1.0).sum() if self.personal_space > 0 else 0.0
        reward = before - self._distance() - self.discomfort * depth - self.collision * info["touches"]
        if info["is_success"]:
            reward += self.arrival
        truncated = not info["is_success"] and self.sim.time >= self.longest
        return self._observe(), float(reward), info["is_success"], truncated, info

    def render(self) -> np.ndarray | None:
        """The place from above, ``(height, width, 3)`` of uint8, with ``render_mode="rgb_array"``."""
        if self.render_mode != "rgb_array" or self._sim is None:
            return None
        return self.sim.picture("top").pixels[..., :3]

    def _walk(self, steps: int, wanted: np.ndarray | None = None) -> None:
        """Steps in which the robot's velocity nears the wanted one as fast as it can accelerate."""
        step = self.sim.time_step
        for _ in range(steps):
            if wanted is not None:
                change = wanted - self.velocity
                most = self.max_acceleration * step
                self.velocity += change * min(1.0, most / max(float(np.linalg.norm(change)), 1e-9))
                self.place += self.velocity * step
            self.sim.lead("robot", (self.place[0], self.place[1]), (self.velocity[0], self.velocity[1]))
            self.sim.step()

    def _others(self) -> np.ndarray:
        """Numbers of the people who are there."""
        return np.flatnonzero(np.asarray(self.sim.present) & self.people)

    def _gaps(self) -> np.ndarray:
        """Metres from the robot's edge to the edge of each person."""
        others = self._others()
        apart = np.linalg.norm(self.sim.positions[others] - self.place, axis=1)
        return apart - self.radii[others] - self.radius

    def _distance(self) -> float:
        return float(np.linalg.norm(self.goal - self.place))

    def _observe(self) -> np.ndarray:
        seen = np.zeros((self.nearest, 5), np.float32)
        others = self._others()
        places = self.sim.positions[others] - self.place
        apart = np.linalg.norm(places, axis=1)
        order = np.argsort(apart, kind="stable")[: self.nearest]
        order = order[apart[order] <= self.sight]
        seen[: len(order), :2] = places[order]
        seen[: len(order), 2:4] = self.sim.velocities[others][order]
        seen[: len(order), 4] = 1.0
        own = np.concatenate([self.goal - self.place, self.velocity])
        return np.concatenate([own, seen.ravel()]).astype(np.float32)

    def _info(self) -> dict[str, Any]:
        gaps = self._gaps()
        distance = self._distance()
        return {
            "distance": distance,
            "nearest": float(gaps.min()) if len(gaps) else float("inf"),
            "touches": int((gaps < 0).sum()),
            "is_success": distance < self.radius,
        }


if ID not in gymnasium.registry:
    gymnasium.register(ID, entry_point="gaitway.gymnasium:RobotInCrowd")
