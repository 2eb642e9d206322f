"""How far something is, for people."""

from __future__ import annotations

import sys
import time


def _is_live() -> bool:
    """Whether a line can be written over: on a terminal and in a notebook."""
    return sys.stderr.isatty() or "ipykernel" in sys.modules


class ProgressLine:
    """One line on standard error that is written over; where that cannot be, a line per tenth and per half minute."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._live = _is_live()
        self._tenths = 0
        self._last = time.monotonic()
        self._width = 0

    def __call__(self, share: float, line: str) -> None:
        """Shows that a share between 0 and 1 is done, and what is known besides."""
        text = f"{self._title}: {100 * share:3.0f} %  {line}"
        now = time.monotonic()
        if self._live:
            sys.stderr.write("\r" + text.ljust(self._width))
            self._width = len(text)
            sys.stderr.flush()
        elif int(10 * share) > self._tenths or now > self._last + 30.0:
            self._tenths = int(10 * share)
            self._last = now
            print(text, file=sys.stderr, flush=True)

    def end(self) -> None:
        """Leaves the line."""
        if self._live and self._width:
            sys.stderr.write("\n")
            sys.stderr.flush()
