"""Who was where: the class ``Trajectories``, and its way into PedPy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import _gaitway
from ._errors import Error

if TYPE_CHECKING:
    from typing_extensions import Self

    from pedpy import TrajectoryData, WalkableArea


class Trajectories(_gaitway.Table):
    """Who was where in each frame, a row for each agent that was there.

    An Arrow table (pandas, polars, pyarrow and duckdb take it as it is) with the columns ``frame``, ``time_s``, ``id``, ``x_m``,
    ``z_m``, ``heading_rad``, ``vx_m_s``, ``vz_m_s``, ``emotion`` and ``kind``: those of ``gaitway simulate --out FILE.csv``.
    Agents that are absent have no row.
    """

    _every: float | None
    _wkt: str

    def __new__(cls, table: _gaitway.Table, *, every: float | None, wkt: str) -> Self:
        self = super().__new__(cls, table)
        self._every = every
        self._wkt = wkt
        return self

    @property
    def frame_rate(self) -> float:
        """Frames a second.

        Raises:
            Error: of a recording of one frame.
        """
        if self._every is not None:
            return 1.0 / self._every
        frames, times = self["frame"], self["time_s"]
        if not len(frames) or frames[-1] == frames[0]:
            raise Error("one frame has no frame rate", "walk on, then ask again")
        return float((frames[-1] - frames[0]) / (times[-1] - times[0]))

    @property
    def walkable_area(self) -> WalkableArea:
        """The free ground as a ``pedpy.WalkableArea``, in PedPy's plane (x, y = -z): the parts that people were in."""
        return walkable_area(self._wkt)

    def to_pedpy(self) -> TrajectoryData:
        """The people as ``pedpy.TrajectoryData``, in PedPy's plane (x, y = -z).

        It can also be unpacked into the functions of PedPy that take an area:
        ``pedpy.compute_individual_voronoi_polygons(**trajectories.to_pedpy())``. Robots and vehicles are left out.
        """
        import pandas

        person = np.asarray([kind == "person" for kind in self["kind"]], dtype=bool)
        data = pandas.DataFrame(
            {
                "id": self["id"][person].astype(np.int64),
                "frame": self["frame"][person].astype(np.int64),
                "x": self["x_m"][person].astype(np.float64),
                "y": 0.0 - self["z_m"][person].astype(np.float64),
            }
        )
        return _unpackable()(data=data, frame_rate=self.frame_rate, area=self.walkable_area)

    def __repr__(self) -> str:
        return "<gaitway.Trajectories" + super().__repr__().removeprefix("<gaitway.Table")


def walkable_area(wkt: str) -> WalkableArea:
    """PedPy's walkable area of a polygon."""
    return _pedpy().WalkableArea(wkt)


def _pedpy() -> Any:
    try:
        import pedpy
    except ImportError as error:
        raise Error(f"PedPy cannot be imported: {error}", "pip install pedpy") from error
    return pedpy


def _unpackable() -> type:
    """PedPy's class with an area, so that ``**`` gives both."""
    pedpy = _pedpy()

    class TrajectoryData(pedpy.TrajectoryData):  # type: ignore[name-defined]
        """``pedpy.TrajectoryData`` that unpacks into ``traj_data`` and ``walkable_area``."""

        def __init__(self, data: Any, frame_rate: float, area: Any) -> None:
            super().__init__(data=data, frame_rate=frame_rate)
            object.__setattr__(self, "_area", area)

        def keys(self) -> tuple[str, str]:
            return ("traj_data", "walkable_area")

        def __getitem__(self, name: str) -> Any:
            if name == "traj_data":
                return pedpy.TrajectoryData(data=self.data, frame_rate=self.frame_rate)
            if name == "walkable_area":
                return self._area
            return super().__getitem__(name)

    return TrajectoryData
