"""Metal cutting by particles: scenarios, runs, sweeps, diagnosis and calibration.

>>> import sphcut
>>> cut = sphcut.Scenario.load("cut.toml")
>>> cut["process.cutting_speed"] = "200 m/min"
>>> run = cut.run()
>>> run.forces["cutting_force [N]"].mean()

Quantities go in as text with their unit, as in a scenario file. Numbers come out with their unit in the name of the column or in
`attrs["units"]`; without one they are in SI units.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from sphcut import _native
from sphcut.commands import Calibration, Diagnosis, calibrate, diagnose
from sphcut.errors import CommandError, DivergedError, FileError, Problem, ScenarioError, SphcutError
from sphcut.run import Run, Snapshot, Snapshots
from sphcut.scenario import Check, Scenario
from sphcut.sweep import sweep

if TYPE_CHECKING:
    from sphcut.greybox import GreyBox

__version__: str = _native.VERSION

__all__ = [
    "Calibration",
    "Check",
    "CommandError",
    "Diagnosis",
    "DivergedError",
    "FileError",
    "GreyBox",
    "Problem",
    "Run",
    "Scenario",
    "ScenarioError",
    "Snapshot",
    "Snapshots",
    "SphcutError",
    "calibrate",
    "diagnose",
    "sweep",
]

# Runs of a sweep are processes of their own. `-P`: a folder `sphcut` in the working directory is not this package.
_native.started_by([sys.executable, "-P", "-m", "sphcut"])


def __getattr__(name: str) -> Any:
    # scikit-learn takes a second to import, and the processes of a sweep do not need it.
    if name == "GreyBox":
        from sphcut.greybox import GreyBox

        return GreyBox
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
