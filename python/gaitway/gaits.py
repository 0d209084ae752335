"""Gaits: walk cycles of 16 joints, from libraries, from motion capture, and the built-in ones."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import _gaitway

if TYPE_CHECKING:
    from typing_extensions import Self

#: Names of the 16 joints, in the order of ``Gait.poses``.
JOINTS: tuple[str, ...] = tuple(_gaitway.Gaits.joints())


@dataclass(frozen=True)
class Gait:
    """One walk cycle. Phase 0 is the foot strike of the left foot; the walker faces +z and walks on the spot."""

    #: Name, unique among its gaits.
    name: str
    #: The emotion that people see in it, if known.
    label: str | None
    #: Preferred speed, m/s.
    speed: float
    #: Frames a second of ``poses``, Hz.
    frame_rate: float
    #: Positions of the joints, m, y up: float32 ``(frames, 16, 3)``.
    poses: np.ndarray

    @property
    def cycle_time(self) -> float:
        """Seconds of a stride."""
        return len(self.poses) / self.frame_rate


class Gaits(_gaitway.Gaits):
    """A sequence of gaits. ``Simulation(library=...)`` walks with it, ``features`` measures it."""

    def __new__(cls, gaits: _gaitway.Gaits) -> Self:
        return super().__new__(cls, gaits)

    def __getitem__(self, index: int) -> Gait:
        if index < 0:
            index += len(self)
        name, label, speed, rate = super()._facts(index)
        return Gait(name, label, speed, rate, super()._poses(index))

    def __iter__(self) -> Iterator[Gait]:
        return (self[index] for index in range(len(self)))

    def features(self, variant: str = "corrected") -> _gaitway.Table:
        """The 29 expressive features of each gait, a row each, with the columns ``gait`` and ``label`` before them.

        Args:
            variant: ``"corrected"``, ``"paper"`` or ``"step-code"``. ``features().units`` has the units (m, m2, m3, deg, s and
                their rates).

        Raises:
            Error: for a gait some joints of which were not captured.
        """
        return super()._feature_table(variant)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write them as a library (``.glb``), which any glTF viewer plays."""
        super().save(os.fspath(path))

    def __repr__(self) -> str:
        return f"<gaitway.gaits.Gaits: {len(self)} gaits>"


def load(*paths: str | os.PathLike[str]) -> Gaits:
    """The gaits of libraries (``.glb``), of motion files (BVH, ASF/AMC, C3D, TRC, npz, CSV), and of folders of motion files.

    Of each take in a motion file it is the steadiest stride.

    Raises:
        Error: for a file that cannot be read, with file and line.
    """
    return Gaits(_gaitway.Gaits.load([os.fspath(path) for path in paths]))


def built_in(expression: float | None = None) -> Gaits:
    """The 48 built-in gaits, which are generated.

    Args:
        expression: how strongly they show their emotion: 0 not at all, 1 as people do, 2 as actors do (and crowds), 3 as on a
            stage.
    """
    return Gaits(_gaitway.Gaits.built_in(expression))
