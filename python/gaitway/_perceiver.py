"""What people would see in a walk."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from . import _gaitway
from .gaits import Gaits

if TYPE_CHECKING:
    from typing_extensions import Self


class Perceiver(_gaitway.Perceiver):
    """A classifier that learned what people see in walks.

    Args:
        path: a model of ``gaitway gait train``. Default: the one that ships, which learned from 232 walks of E-Gait.
    """

    def __new__(cls, path: str | os.PathLike[str] | None = None) -> Self:
        return super().__new__(cls, None if path is None else os.fspath(path))

    def predict(self, gaits: Gaits) -> _gaitway.Table:
        """What people would see, a row for each gait.

        Columns: ``gait``, ``label``, ``emotion`` (the most probable one), the probabilities ``happy``, ``angry``, ``sad`` and
        ``neutral``, ``margin`` to the next one, ``novelty`` (above 1 the gait is unlike those that the model learned from), and
        ``unlike``.
        """
        return super()._judge(gaits)

    def __repr__(self) -> str:
        return f"<gaitway.Perceiver: {self.description}>"
