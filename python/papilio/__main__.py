"""The program ``papilio``: ``papilio run FILE``, or ``python -m papilio run FILE``."""

from __future__ import annotations

import sys

from . import _papilio

__all__ = ["main"]


def main() -> int:
    """Runs the program with the arguments of this process, and returns the exit code."""
    return _papilio.program(["papilio", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
