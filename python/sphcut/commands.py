"""Diagnosis and calibration: the commands of sphcut, their answers as dataclasses."""

from __future__ import annotations

import base64
import json
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

from sphcut.errors import CommandError, FileError, ScenarioError
from sphcut.scenario import Scenario

if TYPE_CHECKING:
    import pandas as pd

_Path = str | PathLike[str]


def _command(words: Sequence[str], progress: bool) -> list[str]:
    """Runs a command of sphcut in a process of its own; the lines of its answer. Ctrl-C is handed on, so that it writes checkpoints."""
    # A session of its own: the terminal would send Ctrl-C to it a second time, and that ends it at once.
    process = subprocess.Popen(
        [sys.executable, "-P", "-m", "sphcut", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        encoding="utf-8",
        start_new_session=True,
    )
    told: list[str] = []

    def listen() -> None:
        assert process.stderr is not None
        for line in process.stderr:
            told.append(line)
            if progress and not line.startswith("error"):
                sys.stderr.write(line)

    listener = threading.Thread(target=listen, daemon=True)
    listener.start()
    assert process.stdout is not None
    try:
        answer = process.stdout.read()
        code = process.wait()
    except KeyboardInterrupt:
        process.send_signal(signal.SIGINT)
        process.stdout.read()
        process.wait()
        raise
    listener.join()
    message = "".join(told).strip()
    match code:
        case 0:
            return answer.splitlines()
        case 130:
            raise KeyboardInterrupt(message)
        case 2:
            raise ScenarioError(message)
        case 4:
            raise FileError(message)
    raise CommandError(message, code)


def _sentences(answer: Sequence[str]) -> list[str]:
    """What the command says, without the places it names at the end."""
    return [line for line in answer if line.strip() and not line.startswith(("report  ", "next  "))]


def _options(**options: Any) -> list[str]:
    """Options of a command: `--name value`, `--name` where it is true."""
    words: list[str] = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        words.append("--" + name.replace("_", "-"))
        if value is not True:
            words.append(str(value))
    return words


@dataclass(frozen=True)
class _Answer:
    """An answer in its folder."""

    folder: Path
    """Where page, numbers and patch are."""
    words: list[str]
    """What was found, in sentences."""
    data: dict[str, Any]
    """All numbers, SI units."""

    _page: ClassVar[str]
    _numbers: ClassVar[str]

    @classmethod
    def _of(cls, folder: Path, words: list[str]) -> Self:
        data = json.loads((folder / cls._numbers).read_text(encoding="utf-8"))
        return cls(folder=folder, words=words, data=data)

    @property
    def report(self) -> Path:
        """The page to look at."""
        return self.folder / self._page

    @property
    def patch(self) -> Path | None:
        """A patch for the scenario (`sphcut run SCENARIO --patch FILE`), where there is one."""
        path = self.folder / "scenario.patch.toml"
        return path if path.is_file() else None

    def __str__(self) -> str:
        return "\n".join(self.words)

    def _repr_html_(self) -> str:
        words = "".join(f"<p>{escape(word)}</p>" for word in self.words)
        page = base64.b64encode(self.report.read_bytes()).decode("ascii")
        frame = f"<iframe src='data:text/html;base64,{page}' width='100%' height='600'></iframe>"
        return f"{words}<details><summary>{escape(str(self.report))}</summary>{frame}</details>"


@dataclass(frozen=True)
class Diagnosis(_Answer):
    """Which physics a simulation left out."""

    _page = "diagnosis.html"
    _numbers = "diagnosis.json"

    @property
    def verdict(self) -> str:
        """What may be claimed: `no_alarm`, `named`, `one_of` or `none_of_these`; empty for series alone."""
        return str(self.data.get("verdict", ""))

    @property
    def named(self) -> list[str]:
        """The effects that are named; empty where none may be."""
        return list(self.data.get("named") or [])

    @property
    def effects(self) -> pd.DataFrame:
        """Every effect with its posterior probability, the most probable first."""
        import pandas as pd

        return pd.DataFrame(self.data["effects"]).sort_values("probability", ascending=False, ignore_index=True)


@dataclass(frozen=True)
class Calibration(_Answer):
    """Constants of flow stress and friction found from measured cuts."""

    _page = "calibration.html"
    _numbers = "calibration.json"

    @property
    def constants(self) -> pd.DataFrame:
        """Each constant with its value and the ends of its 95 % interval, SI units."""
        import pandas as pd

        rows = [
            {
                "symbol": one["symbol"],
                "key": one["key"],
                "stated": one["stated"],
                "value": one["value"],
                "low": one["interval"][0],
                "high": one["interval"][1],
                "standing": one["standing"],
            }
            for one in self.data["constants"]
        ]
        return pd.DataFrame(rows).set_index("symbol")

    @property
    def effects(self) -> dict[str, float]:
        """Effects that were fitted, each with ln of the evidence with it over that without it: from 3 on the cuts want it."""
        return {one["effect"]: one["log_evidence"] for one in self.data.get("effects") or []}

    @property
    def next(self) -> pd.DataFrame:
        """The most telling further cuts, where they were asked for: conditions in SI units and what is open once each is made."""
        import pandas as pd

        cuts = (self.data.get("next") or {}).get("cuts", [])
        return pd.DataFrame([{**cut["condition"], **{f"{k} open": v for k, v in cut["open"].items()}} for cut in cuts])


def diagnose(
    case: _Path,
    *,
    closed_form: bool = False,
    confirm: bool = False,
    out: _Path | None = None,
    store: _Path | None = None,
    threads: int | None = None,
    force: bool = True,
    progress: bool = True,
) -> Diagnosis:
    """Which physics did the simulation leave out? `case` is the file of a diagnosis (`docs/diagnosis_keys.md`).

    closed_form: explain with the closed-form model (half a minute) instead of some two hundred runs of the particle solver.
    confirm: with closed_form, run the correction in the particle solver at some of the measured conditions.
    out: folder of page, numbers and patch; default: `out/<name>_diagnose`. An earlier answer there is replaced unless `force` is False.
    store: folder that keeps the runs of the particle solver, also for other diagnoses.
    """
    folder = Path("out") / f"{Path(case).stem}_diagnose" if out is None else Path(out)
    options = _options(out=folder, closed_form=closed_form, confirm=confirm, store=store, threads=threads, force=force)
    return Diagnosis._of(folder, _sentences(_command(["diagnose", str(case), *options], progress)))


def calibrate(
    cut: Scenario | _Path,
    measured: pd.DataFrame | _Path,
    *,
    fit: Sequence[str] | None = None,
    effects: Sequence[str] | None = None,
    material_tests: _Path | None = None,
    held_out: _Path | None = None,
    next: int | None = None,
    candidates: _Path | None = None,
    closed_form: bool = False,
    noise: float | None = None,
    published: str | None = None,
    travel: float | None = None,
    refreshes: int | None = None,
    out: _Path | None = None,
    store: _Path | None = None,
    threads: int | None = None,
    force: bool = True,
    progress: bool = True,
) -> Calibration:
    """Which constants of flow stress and friction make the simulation right at measured cuts, with which intervals?

    cut: a scenario in a file. One that was changed has to be saved first (:meth:`sphcut.Scenario.save`).
    measured: a table, or its file, with `v_c [m/min]`, `h [mm]` and any of `F_c [N]`, `F_f [N]`, `chip_thickness [mm]`,
        `contact_length [mm]`, `T_interface [degC]`.
    fit: symbols of the constants, of A, B, n, C, m, mu, m_s, r_n; default: A, B, n, C, m, mu.
    effects: effects of the catalogue whose strength is fitted as well, such as `tanh_softening`.
    material_tests: folder that `sphcut identify` has written of tests of the same material.
    next: how many further cuts are named, of `candidates` (a table of `v_c [m/min]`, `h [mm]`) or of a grid over those measured.
    closed_form: compute the cuts in closed form (seconds, right in trends only) instead of with the particle solver.
    noise: of a value without a standard deviation of its own, in %.
    travel: how far each run goes, in uncut chip thicknesses.
    out: folder of page, numbers, patch and material; default: `out/<name>_calibrate`. An earlier answer there is replaced unless
        `force` is False.
    """
    if isinstance(cut, Scenario):
        if not cut._in_file:
            raise ScenarioError("a calibration reads the scenario from its file: save it first, cut.save('cut.toml')")
        cut = cut.path
    folder = Path("out") / f"{Path(cut).stem}_calibrate" if out is None else Path(out)
    if not isinstance(measured, (str, PathLike)):
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / "measured.csv"
        measured.to_csv(path, index=False)
        measured = path
    options = _options(
        measured=measured,
        out=folder,
        fit=None if fit is None else ",".join(fit),
        effects=None if effects is None else ",".join(effects),
        material_tests=material_tests,
        held_out=held_out,
        next=next,
        candidates=candidates,
        model="closed-form" if closed_form else None,
        noise=noise,
        published=published,
        travel=travel,
        refreshes=refreshes,
        store=store,
        threads=threads,
        force=force,
    )
    return Calibration._of(folder, _sentences(_command(["calibrate", str(cut), *options], progress)))
