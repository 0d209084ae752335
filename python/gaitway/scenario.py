"""What a scenario file may say."""

from __future__ import annotations

import json
from typing import Any

from . import _gaitway


def schema() -> dict[str, Any]:
    """The JSON Schema (draft 2020-12) of a scenario file: of every key the description, unit, default and range.

    >>> import gaitway as gw
    >>> gw.scenario.schema()["properties"]["navigation"]["properties"]["patience"]["unit"]
    's'
    """
    return json.loads(_gaitway.scenario_schema())
