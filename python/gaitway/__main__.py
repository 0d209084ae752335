"""``python -m gaitway``: the program."""

import sys

from ._command import main

sys.exit(main())
