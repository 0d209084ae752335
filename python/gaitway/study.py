"""The data of studies with people, as tables. The command ``gaitway study`` plans, serves and analyses them."""

from __future__ import annotations

import os
from typing import NamedTuple

from . import _gaitway


class Tables(NamedTuple):
    """The data of a study."""

    #: The last answer to every question: ``participant``, ``front``, ``part``, ``page``, ``position``, ``role``, ``gait``,
    #: ``scene``, ``condition``, ``emotion``, ``body``, ``question``, ``value`` (numbers), ``text`` (free text), ``ms``.
    answers: _gaitway.Table
    #: Every participant who arrived: ``participant``, ``front``, ``state``, ``placed``.
    participants: _gaitway.Table


def load(folder: str | os.PathLike[str]) -> Tables:
    """The tables of a folder of data: ``answers.csv`` and ``participants.csv``.

    Raises:
        Error: when a file cannot be read, or is none of a study, with file and line.
    """
    return Tables(*_gaitway.study_tables(os.fspath(folder)))
