"""The program ``gaitway``, as the wheel brings it."""

from __future__ import annotations

import sys

from . import _gaitway


def main() -> int:
    """Do what the command line says; the exit code is that of the program."""
    return _gaitway.main(["gaitway", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
