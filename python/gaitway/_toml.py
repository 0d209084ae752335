"""Values of Python as TOML, for ``set``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from ._errors import BadValue


def settings(values: Mapping[str, Any] | None) -> list[str]:
    """Each key and its value as ``key=value``, as ``gaitway simulate --set`` takes them."""
    return [f"{key}={text(value)}" for key, value in (values or {}).items()]


def text(value: Any) -> str:
    """The value as TOML has it."""
    if hasattr(value, "tolist"):  # numpy's numbers and arrays
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else str(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(str(key))} = {text(own)}" for key, own in value.items()) + " }"
    if isinstance(value, Sequence):
        return "[" + ", ".join(text(own) for own in value) + "]"
    raise BadValue(
        f"set: {value!r} is a {type(value).__name__}",
        "use a number, True, False, a text, a list or a dictionary",
    )
