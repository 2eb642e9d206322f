"""Scenarios: what is cut, with which tool, how fast and how finely."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sphcut import _native
from sphcut.errors import ScenarioError
from sphcut.progress import ProgressLine
from sphcut.run import Run

if TYPE_CHECKING:
    import pandas as pd


def _key(name: str) -> str:
    """A key of a table in braces."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name)


def literal(value: Any) -> str:
    """`value` as a scenario file has it: text in quotes, numbers, truth values, lists, and tables in braces."""
    if hasattr(value, "item") and not isinstance(value, (list, tuple, Mapping)):
        value = value.item()  # numbers of numpy
    match value:
        case bool():
            return "true" if value else "false"
        case int():
            return str(value)
        case float() if math.isfinite(value):
            return repr(value)
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case list() | tuple():
            return "[" + ", ".join(literal(one) for one in value) + "]"
        case Mapping():
            return "{ " + ", ".join(f"{_key(str(k))} = {literal(v)}" for k, v in value.items()) + " }"
    raise ScenarioError(
        f"{value!r} cannot stand in a scenario: write text such as '200 m/min', a number, a list or a dict"
    )


@dataclass(frozen=True)
class Check:
    """What a scenario would do, without doing it."""

    particles: int
    """Number of particles at the start."""
    steps: int
    """Number of time steps at the start's size."""
    time_step: float
    """Time step at the start in s."""
    memory: int
    """Memory in bytes."""
    seconds: tuple[float, float] | None
    """Least and most wall-clock time in s on this machine; None where it was not measured."""
    particles_across_chip: float | None
    """Particles across the uncut chip thickness, of a cut."""
    particles_across_edge: float | None
    """Particles across the edge radius, where it is known."""
    warnings: list[str]
    """What to know before trusting the run."""
    data: dict[str, Any]
    """All of it, as `sphcut check --json` prints it."""

    def __str__(self) -> str:
        def number(value: float | None) -> str:
            return "-" if value is None else f"{value:.3g}"

        lines = [
            f"{self.data['title']}",
            f"{self.particles:,} particles, {self.steps:,} steps, {self.memory / 1e6:.0f} MB",
            f"{number(self.particles_across_chip)} particles across the uncut chip thickness, "
            f"{number(self.particles_across_edge)} across the edge radius",
        ]
        if self.seconds is not None:
            lines.append(f"{self.seconds[0]:.3g} to {self.seconds[1]:.3g} s on this machine")
        return "\n".join(lines + [f"warning: {warning}" for warning in self.warnings])

    def _repr_html_(self) -> str:
        return "<pre>" + escape(str(self)) + "</pre>"


class Scenario:
    """A cut, or other bodies in motion, as a scenario file describes it.

    >>> cut = Scenario.load("cut.toml")
    >>> cut["process.cutting_speed"] = "200 m/min"
    >>> cut.check().particles

    A key is the path of names with dots, `process.cutting_speed` or `body[2].temperature`; `docs/scenario.md` lists them all. Every
    change is checked at once: a mistake is a :class:`sphcut.ScenarioError` and leaves the scenario as it was.
    """

    def __init__(self, native: _native.Scenario, *, in_file: bool) -> None:
        """Use :meth:`load`, :meth:`from_string` or :meth:`shipped`."""
        self._native = native
        self._in_file = in_file

    @classmethod
    def load(cls, path: str | PathLike[str], *, allow_outside: bool = False) -> Scenario:
        """The scenario in the file at `path`. It may name files outside its folder if `allow_outside`."""
        return cls(_native.Scenario.load(path, allow_outside), in_file=True)

    @classmethod
    def from_string(
        cls, text: str, *, name: str = "scenario", folder: str | PathLike[str] = ".", allow_outside: bool = False
    ) -> Scenario:
        """The scenario in `text`, which may name files in `folder`. Results go to `out/<name>` unless something else is said."""
        return cls(_native.Scenario.parse(text, Path(folder) / f"{name}.toml", allow_outside), in_file=False)

    @classmethod
    def shipped(cls, name: str) -> Scenario:
        """A scenario that comes with the package: `quickstart`, `aisi1045_orthogonal`, ..."""
        texts = dict(_native.Scenario.shipped())
        if name not in texts:
            near = _native.Scenario.nearest(name, list(texts))
            hint = f"did you mean `{near}`? " if near else ""
            raise ScenarioError(f"no scenario `{name}` is shipped; {hint}there are {', '.join(texts)}")
        return cls.from_string(texts[name], name=name)

    @property
    def text(self) -> str:
        """The text of the scenario, changes included."""
        return self._native.text

    @property
    def name(self) -> str:
        """Name of the file without its ending."""
        return self._native.name

    @property
    def title(self) -> str:
        """What is simulated, in one line."""
        return self._native.title

    @property
    def warnings(self) -> list[str]:
        """What to know before trusting a run."""
        return self._native.warnings

    @property
    def path(self) -> Path:
        """The file, or where it would lie."""
        return Path(self._native.path)

    @property
    def settings(self) -> pd.DataFrame:
        """Every key: as written, in SI, and whether it is given, a default or derived."""
        import pandas as pd

        columns = ["section", "key", "text", "value", "number", "unit", "origin"]
        return pd.DataFrame(self._native.entries, columns=columns).drop(columns="value")

    def _entry(self, key: str) -> tuple[str, str, str, str, float | None, str, str]:
        entries = {f"{one[0]}.{one[1]}".removeprefix("."): one for one in self._native.entries}
        if key in entries:
            return entries[key]
        near = _native.Scenario.nearest(key, list(entries))
        raise KeyError(f"{key}: not in this scenario" + (f"; did you mean {near}?" if near else ""))

    def __getitem__(self, key: str) -> Any:
        """The value of `key` as it is written: text with its unit, a number, a list or a dict; of a default its text."""
        found: Any = tomllib.loads(self.text)
        for part in re.findall(r"[^.\[\]]+", key):
            if isinstance(found, list) and part.isdigit() and 0 < int(part) <= len(found):
                found = found[int(part) - 1]
            elif isinstance(found, dict) and part in found:
                found = found[part]
            else:
                return self._entry(key)[2]
        return found

    def si(self, key: str) -> float:
        """The value of `key` in its SI unit."""
        number = self._entry(key)[4]
        if number is None:
            raise TypeError(f"{key} is no number")
        return number

    def __contains__(self, key: str) -> bool:
        try:
            self[key]
        except KeyError:
            return False
        return True

    def __setitem__(self, key: str, value: Any) -> None:
        self.update({key: value})

    def update(self, changes: Mapping[str, Any]) -> None:
        """Sets several keys together, which is checked when all are set: a law with its parameters, for example.

        A dict as a value replaces a whole table: `cut["tool.friction"] = {"law": "coulomb", "friction_coefficient": 0.3}`.
        """
        self._native = self._native.with_keys([(key, literal(value)) for key, value in changes.items()])
        self._in_file = False

    def __delitem__(self, key: str) -> None:
        self._native = self._native.without_key(key)
        self._in_file = False

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the text to a file, with its comments; from then on that is the file of this scenario."""
        Path(path).write_text(self.text, encoding="utf-8")
        self._native = _native.Scenario.load(path, allow_outside=True)
        self._in_file = True

    def copy(self) -> Scenario:
        """The same scenario, to be changed on its own."""
        return Scenario(self._native, in_file=self._in_file)

    def check(self, *, measure: bool = False) -> Check:
        """Particles, steps, memory, resolution and warnings; if `measure`, also the time that it takes on this machine (1.5 s)."""
        data = json.loads(self._native.check(measure))
        cost, resolution = data["cost"], data["resolution"]
        return Check(
            particles=cost["particles"],
            steps=cost["steps"],
            time_step=cost["time_step_s"],
            memory=cost["memory_bytes"],
            seconds=None if cost["seconds"] is None else (cost["seconds"][0], cost["seconds"][1]),
            particles_across_chip=resolution["across_uncut_chip_thickness"],
            particles_across_edge=resolution["across_edge_radius"],
            warnings=data["warnings"],
            data=data,
        )

    def run(
        self,
        out: str | PathLike[str] | None = None,
        *,
        progress: bool = True,
        force: bool = False,
        threads: int | None = None,
    ) -> Run:
        """Runs the scenario into the folder `out` (default: `out/<name>`) and writes what `sphcut run` writes.

        A complete result of the same scenario in that folder is given back at once, an unfinished one is gone on with, bit for bit.
        That of another scenario is refused unless `force`. Ctrl-C (in a notebook: interrupt) stops after the current step, writes
        a checkpoint and raises KeyboardInterrupt. Other threads of Python go on meanwhile.

        progress: show a line with share, forces and time left.
        threads: number of threads; default: all cores. The results are the same bits for any number.
        """
        folder = Path("out") / self.name if out is None else Path(out)
        line = ProgressLine(self.name) if progress else None
        try:
            native = self._native.run(folder, "replace" if force else "resume", threads, line)
        except ScenarioError as error:
            if "belongs to another run" not in str(error):
                raise
            raise ScenarioError(
                f"{error}\n  help: force=True starts again, out=... takes another folder"
            ) from None
        finally:
            if line is not None:
                line.end()
        return Run(native)

    def __repr__(self) -> str:
        return f"<sphcut.Scenario {self.name!r}: {self.title}>"

    def _repr_html_(self) -> str:
        return f"<b>{escape(self.title)}</b><pre>{escape(self.text)}</pre>"
