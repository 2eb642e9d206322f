"""`python -m sphcut`, and the command `sphcut` that the package installs: the whole command line."""

from __future__ import annotations

import sys

from sphcut import _native


def main() -> int:
    """Does what the command line says; the exit code."""
    return _native.program(["sphcut", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
