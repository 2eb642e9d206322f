"""What can go wrong, as exceptions. All are a :class:`SphcutError`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """A mistake in a scenario, with its place."""

    file: str
    """Name of the file, or of what stands for it."""
    line: int
    """Line, from 1."""
    column: int
    """Column in characters, from 1."""
    message: str
    """What is wrong."""
    help: str
    """What would be right; may be empty."""


class SphcutError(Exception):
    """Anything that sphcut refuses or cannot do."""


class ScenarioError(SphcutError, ValueError):
    """Mistakes in a scenario, or in what is asked of one; the text shows the line, what is wrong and the nearest name."""

    def __init__(self, message: str, problems: Iterable[tuple[str, int, int, str, str]] = ()) -> None:
        super().__init__(message)
        self.problems: list[Problem] = [Problem(*one) for one in problems]
        """Each mistake with file, line and column; empty where there is no place."""


class DivergedError(SphcutError, ArithmeticError):
    """A run blew up; everything until then is in its folder."""


class FileError(SphcutError, OSError):
    """A file or folder could not be read or written."""


class CommandError(SphcutError):
    """A command of sphcut failed."""

    def __init__(self, message: str, exit_code: int) -> None:
        super().__init__(message)
        self.exit_code = exit_code
        """Exit code, as `sphcut --help` lists them."""
