"""The class ``Simulation``."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _gaitway, _toml
from ._errors import BadValue, Error
from ._pictures import Picture, Video
from ._trajectories import Trajectories, walkable_area

if TYPE_CHECKING:
    from typing_extensions import Self

    from pedpy import WalkableArea

    from .gaits import Gaits


class Mask(np.ndarray):
    """An array of bool that is true as a whole while any of it is: ``while sim.present: ...``."""

    def __bool__(self) -> bool:
        return bool(np.asarray(self).any())


class Simulation(_gaitway.Simulation):
    """A crowd in motion.

    Args:
        scene: the name of a built-in scene (``gaitway.scenes()``), the path of a scenario file, or the text of one (TOML, with
            at least one line break).
        agents: how many people; built-in places grow with them. Default: as in the scenario.
        seed: of every random draw. Default: as in the scenario.
        condition: ``"baseline"``, ``"eva-o"`` or ``"eva-g"``. Default: as in the scenario.
        set: other values for keys of the scenario, such as ``{"navigation.patience": 1.0}``.
        library: the gaits to walk with. Default: the built-in ones.
        backend: ``"cpu"``, ``"vulkan"``, or ``"auto"``: the best GPU, or else the CPU. ``"reference"`` is the CPU with
            the plain kernels, which are slower and give the same bits.
        device: a part of the name of a Vulkan device, or its number.
        record: seconds between two frames that every step records, for ``trajectories``. Default: none is recorded.

    ``positions``, ``velocities``, ``headings``, ``elevations`` and ``emotions`` are views: read-only arrays over the crowd's own
    memory, made in less than a microsecond however large the crowd is. **A view is valid until the next step**, which writes
    into the same memory. After a step ask for it again. To keep a state, copy it: ``sim.positions.copy()``. A view stays
    safe to read after ``del sim``. Do not read one while another thread steps the same simulation.

    Agents who are not there (not yet, or no more) stand at 1e9 in these arrays; ``present`` masks them.

    The device is opened when it is first needed, so a simulation can be made before workers are forked and used in them.
    Steps and pictures let other Python threads run.

    Raises:
        BadValue: for a value that is not allowed, with file, line and key where it stands in a scenario.
        Error: when a file cannot be read.
    """

    def __new__(
        cls,
        scene: str | os.PathLike[str],
        *,
        agents: int | None = None,
        seed: int | None = None,
        condition: str | None = None,
        set: Mapping[str, Any] | None = None,
        library: Gaits | None = None,
        backend: str = "auto",
        device: str | int | None = None,
        record: float | None = None,
    ) -> Self:
        name = os.fspath(scene)
        if device is not None and backend == "cpu":
            raise BadValue(f"device = {device!r} names a Vulkan device, but backend is 'cpu'", "leave one of them out")
        return super().__new__(
            cls,
            name,
            isinstance(scene, str) and "\n" in name,
            _toml.settings(set),
            _whole("agents", agents, 1_000_000),
            _whole("seed", seed, 2**64 - 1),
            condition,
            library,
            backend,
            None if device is None else str(device),
            record,
        )

    def step(self, steps: int = 1) -> None:
        """Do ``steps`` steps of ``time_step`` seconds. Other threads run meanwhile, and Ctrl-C is heeded."""
        super().step(_whole("steps", steps, 2**32 - 1))

    def run(self, seconds: float, every: float = 0.1, until_empty: bool = False) -> Trajectories:
        """Walk for ``seconds`` and return who was where, in frames ``every`` seconds apart, the first of them now.

        Both are whole numbers of steps.

        With ``until_empty`` it ends as soon as no agent is present.
        """
        return self._trajectories(super()._walk(seconds, every, until_empty), every)

    @property
    def trajectories(self) -> Trajectories:
        """What has been recorded since the start, with ``record=``.

        Raises:
            Error: when nothing is recorded.
        """
        table = super()._recorded()
        if table is None:
            raise Error("this simulation records no trajectories", "make it with record=0.1, or use sim.run(...)")
        return self._trajectories(table, None)

    def _trajectories(self, table: _gaitway.Table, every: float | None) -> Trajectories:
        return Trajectories(table, every=every, wkt=super()._walkable_wkt(table))

    @property
    def present(self) -> Mask:
        """Who is there now: a new array ``(agents,)`` of bool; true as a whole while any agent is there."""
        return super()._mask().view(Mask)

    @property
    def positions_xy(self) -> np.ndarray:
        """Positions in PedPy's plane (x, y = -z), m: a new float32 array ``(agents, 2)``."""
        return super()._plane()

    @property
    def walkable_area(self) -> WalkableArea:
        """The free ground as a ``pedpy.WalkableArea``, in PedPy's plane (x, y = -z)."""
        return walkable_area(super()._walkable_wkt(None))

    def lead(
        self,
        who: int | str,
        position: tuple[float, float] | None,
        velocity: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Say where an agent that is led from outside is after the next step.

        Args:
            who: its number, or its kind (``"robot"``, ``"vehicle"``) where there is one of the kind. The scenario must have it
                among its ``outsiders``.
            position: (x, z), m; ``None`` makes it absent.
            velocity: (x, z), m/s, which the people take into account.
        """
        if isinstance(who, str):
            found = super()._numbers_of(who)
            if len(found) != 1:
                hint = "give its number" if found else 'add one: set={"outsiders": [{"kind": "robot"}]}'
                raise BadValue(f"lead: there are {len(found)} agents of the kind {who!r}: {found}", hint)
            who = found[0]
        target = None if position is None else [float(part) for part in position]
        super()._lead_agent(_whole("who", who, 2**32 - 1), target, [float(part) for part in velocity])

    def picture(self, camera: str = "orbit", size: tuple[int, int] = (960, 540)) -> Picture:
        """A picture of the crowd as it is now, which Jupyter shows.

        Args:
            camera: ``"eyes"`` (the user's; without one: from near the middle), ``"orbit"`` (the place at a glance, slowly going
                round in videos), ``"top"`` (a map), ``"follow"`` or ``"follow:AGENT"``.
            size: width and height in pixels.

        Raises:
            Error: when no Vulkan device can draw.
        """
        return Picture(super()._pixels(camera, _size(size)))

    def video(
        self,
        seconds: float = 5.0,
        camera: str = "orbit",
        size: tuple[int, int] = (960, 540),
        fps: float = 30.0,
    ) -> Video:
        """A video (H.264) of the next ``seconds``, which Jupyter shows. The crowd walks on meanwhile.

        Raises:
            Error: when no Vulkan device can draw.
        """
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "video.mp4"
            super()._film(path, seconds, camera, _size(size), fps)
            return Video(path.read_bytes(), _size(size))


def _whole(name: str, value: Any, most: int) -> Any:
    """A whole number that is in its range, or ``None``."""
    if value is None:
        return None
    if not hasattr(value, "__index__"):
        raise BadValue(f"{name} = {value!r}: must be a whole number from 0 to {most}", f"such as {name}=1")
    value = value.__index__()
    if not 0 <= value <= most:
        raise BadValue(f"{name} = {value}: must be 0 to {most}", f"such as {name}=1")
    return value


def _size(size: tuple[int, int]) -> tuple[int, int]:
    width, height = size
    return _pixels("width", width), _pixels("height", height)


def _pixels(name: str, value: Any) -> int:
    value = _whole(name, value, 16384)
    if value == 0:
        raise BadValue(f"{name} = 0: must be 1 to 16384", "such as size=(960, 540)")
    return value
