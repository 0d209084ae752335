"""What the tests share."""

import importlib.util
import json
import os
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENES = sorted((ROOT / "assets" / "scenes").glob("*.toml"))

#: The long forms of some tests.
LONG = os.environ.get("GAITWAY_LONG") == "1"


def needs(*modules):
    """Skips a test where a package is not installed, and fails it where all are required."""
    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    if os.environ.get("GAITWAY_REQUIRE_PYTHON") == "1" or not missing:
        return lambda test: test
    return unittest.skip(f"without {', '.join(missing)}")


def program(*words, check=True):
    """What the program ``gaitway`` of this installation prints; the tests' own build where one is named."""
    named = os.environ.get("GAITWAY_PROGRAM")
    start = [named] if named else [sys.executable, "-m", "gaitway"]
    runner = os.environ.get("GAITWAY_RUNNER")
    start = [runner, *start] if runner else start
    return subprocess.run([*start, *map(str, words)], capture_output=True, text=True, check=check)


def state_hash(*words):
    """The state hash that ``gaitway simulate`` prints."""
    return json.loads(program("simulate", *words, "--json").stdout)["state_hash"]


def resident():
    """Bytes of memory that this process holds."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
