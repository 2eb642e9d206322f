"""Sweeps share the store of the command, and are checked before they start."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import sphcut
from cuts import command, under_way

SWEEP = """title = "Two speeds"
base = "tiny.toml"

[design]
kind = "full_factorial"

[[vary]]
key = "process.cutting_speed"
values = ["120 m/min", "180 m/min"]
"""


def test_the_store_is_that_of_the_command(cut: sphcut.Scenario, file: Path, tmp_path: Path) -> None:
    (tmp_path / "two.toml").write_text(SWEEP, encoding="utf-8")
    command("sweep", "two.toml", "--out", "cli", "--store", "store", "--quiet", cwd=tmp_path)
    stored = sorted((tmp_path / "store").rglob("run.h5"))
    times = [path.stat().st_mtime_ns for path in stored]
    assert len(stored) == 2
    values = {"process.cutting_speed": ["120 m/min", "3 m/s", "200 m/min"]}
    table = sphcut.sweep(cut, values, workers=2, store=tmp_path / "store", out=tmp_path / "own", progress=False)
    # 180 m/min is 3 m/s: the address is that of the resolved scenario.
    assert [path.stat().st_mtime_ns for path in stored] == times
    assert len(list((tmp_path / "store").rglob("run.h5"))) == 3
    assert list(table["v_c [m/min]"]) == [120.0, 180.0, 200.0]
    assert (table["state"] == "finished").all() and table.attrs["units"]["F_c [N]"] == "N"
    assert (tmp_path / "own" / "sweep.html").is_file()
    run = sphcut.Run.open(table["folder"][1])
    assert run.summary["forces"]["cutting"]["mean_n"] == pytest.approx(table["F_c [N]"][1], rel=1e-12)


def test_values_that_make_no_scenario_are_refused_first(cut: sphcut.Scenario, tmp_path: Path) -> None:
    values = {"process.cutting_speed": ["120 m/min", "180 mm"]}
    with pytest.raises(sphcut.ScenarioError, match="this is a length"):
        sphcut.sweep(cut, values, out=tmp_path / "own", progress=False)
    assert not list(tmp_path.rglob("run.h5"))


# Where the tests run in the background of a shell, SIGINT is ignored until it is asked for.
LONG = """
import signal, sphcut, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
cut = sphcut.Scenario.load(sys.argv[1])
cut.update({"workpiece.length": "6 mm", "stop.travel": "4 mm"})
print("begun", flush=True)
try:
    sphcut.sweep(cut, {"process.cutting_speed": ["120 m/min", "180 m/min"]}, out=sys.argv[2], progress=False)
except KeyboardInterrupt as error:
    print("interrupted", error, flush=True)
"""


def test_ctrl_c_stops_a_sweep(file: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-c", LONG, str(file), str(tmp_path / "own")]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    under_way(tmp_path, 2)
    process.send_signal(signal.SIGINT)
    sent = time.monotonic()
    assert process.stdout.readline().startswith("interrupted")
    assert process.wait() == 0 and time.monotonic() - sent < 10.0
    # Checkpoints of both runs, which the same call goes on with.
    assert len(list((tmp_path / "own" / "store").rglob("run.partial"))) == 2
