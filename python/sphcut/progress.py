"""How far something is, for people."""

from __future__ import annotations

import sys
import time
from typing import Any

_BETWEEN = 0.2
"""Time between two updates of a line that is written over, in s."""
_QUIET = 30.0
"""Time after which a line is printed where nothing can be written over, in s."""


class ProgressLine:
    """One line that is written over, on a terminal and in a notebook; elsewhere a line on standard error for every tenth."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._place = _notebook() or (_Terminal() if sys.stderr.isatty() else None)
        self._tenths = 0
        self._last = time.monotonic() - _BETWEEN

    def __call__(self, share: float, line: str) -> None:
        """Shows that a share between 0 and 1 is done, and what is known besides."""
        text = f"{self._title}: {100 * share:3.0f} %  {line}"
        now = time.monotonic()
        if self._place is not None:
            if now >= self._last + _BETWEEN or share >= 1.0:
                self._last = now
                self._place.show(text)
        elif int(10 * share) > self._tenths or now > self._last + _QUIET:
            self._tenths = int(10 * share)
            self._last = now
            print(text, file=sys.stderr, flush=True)

    def end(self, text: str = "") -> None:
        """Leaves the line as it is, or with `text` as the last that is said."""
        if self._place is not None:
            if text:
                self._place.show(f"{self._title}: {text}")
            self._place.end()
        elif text:
            print(f"{self._title}: {text}", file=sys.stderr, flush=True)


class _Terminal:
    """A line of a terminal."""

    def __init__(self) -> None:
        self._width = 0

    def show(self, text: str) -> None:
        sys.stderr.write("\r" + text.ljust(self._width))
        sys.stderr.flush()
        self._width = len(text)

    def end(self) -> None:
        if self._width:
            sys.stderr.write("\n")


class _Notebook:
    """An output of a cell."""

    def __init__(self, display: Any) -> None:
        self._display = display
        self._handle: Any = None

    def show(self, text: str) -> None:
        if self._handle is None:
            self._handle = self._display({"text/plain": text}, raw=True, display_id=True)
        else:
            self._handle.update({"text/plain": text}, raw=True)

    def end(self) -> None:
        pass


def _notebook() -> _Notebook | None:
    """The output of the present cell, in a notebook."""
    if "ipykernel" not in sys.modules:
        return None
    try:
        from IPython import get_ipython
        from IPython.display import display
    except ImportError:
        return None
    return _Notebook(display) if hasattr(get_ipython(), "kernel") else None
