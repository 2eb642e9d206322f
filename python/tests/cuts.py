"""A cut of a few hundred particles that takes a second, and what several tests need of it."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]

TINY = """title = "A tiny cut"

[workpiece]
material = "aisi1045_table5"
length = "0.8 mm"
height = "0.3 mm"
temperature = "20 degC"

[tool]
rake_angle = "5 deg"
clearance_angle = "7 deg"
edge_radius = "20 um"

[tool.friction]
law = "shear_capped_coulomb"
friction_coefficient = 0.25

[process]
cutting_speed = "150 m/min" # as measured
uncut_chip_thickness = "0.1 mm"
width_of_cut = "3 mm"

[resolution]
particle_spacing = "25 um"

[numerics]
mass_scaling = 1000

[output]
snapshots = 4

[stop]
travel = "0.1 mm"
"""


def command(*words: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    """The command line of the package: the same program as `sphcut`."""
    call = [sys.executable, "-P", "-m", "sphcut", *map(str, words)]
    return subprocess.run(call, cwd=cwd, capture_output=True, text=True, check=True)


def under_way(folder: Path, runs: int) -> None:
    """Waits until so many runs below `folder` have begun, and a second longer."""
    deadline = time.monotonic() + 60.0
    while len(list(folder.rglob("run.partial"))) < runs:
        assert time.monotonic() < deadline, "no run begins"
        time.sleep(0.1)
    time.sleep(1.0)
