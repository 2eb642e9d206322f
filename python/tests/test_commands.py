"""Diagnosis and calibration: answers with sentences, numbers and pages."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

import sphcut
from cuts import REPOSITORY, under_way

SCENARIOS = REPOSITORY / "scenarios"


def test_a_diagnosis_names_what_was_concealed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = sphcut.diagnose(SCENARIOS / "diagnosis" / "example.toml", closed_form=True, out=tmp_path / "found")
    # crates/diagnose/examples/diagnosis_example.rs conceals friction that falls with speed.
    assert (found.verdict, found.named) == ("named", ["speed_dependent_friction"])
    assert found.effects["effect"][0] == "speed_dependent_friction" and found.effects["probability"][0] > 0.9
    assert "friction falls with the sliding speed" in str(found)
    assert found.patch is not None and "speed_dependent_friction" in found.patch.read_text()
    page = found._repr_html_()
    assert "data:text/html;base64," in page and "friction falls with the sliding speed" in page
    with pytest.raises(sphcut.ScenarioError, match="exists"):
        sphcut.diagnose(SCENARIOS / "diagnosis" / "example.toml", closed_form=True, out=tmp_path / "found", force=False)


def test_a_calibration_of_a_table(tmp_path: Path) -> None:
    cut = sphcut.Scenario.load(SCENARIOS / "calibration" / "cut.toml")
    measured = pd.read_csv(SCENARIOS / "calibration" / "cuts.csv", comment="#")
    found = sphcut.calibrate(cut, measured, fit=["A", "mu"], closed_form=True, out=tmp_path / "found", progress=False)
    table = found.constants
    assert list(table.index) == ["A", "mu"]
    assert (table["low"] < table["value"]).all() and (table["value"] < table["high"]).all()
    # Pa, of a titanium alloy.
    assert 5e8 < table.loc["A", "value"] < 2e9
    assert found.patch is not None and found.report.is_file() and str(found)
    more = sphcut.calibrate(
        cut, measured, fit=["A", "mu"], effects=["tanh_softening"], next=2, closed_form=True, out=tmp_path / "more", progress=False
    )
    assert list(more.effects) == ["tanh_softening"] and len(more.next) == 2
    assert (more.next["F_c open"] > 0).all() and "uncut_chip_thickness" in more.next
    assert len(found.next) == 0 and found.effects == {}
    cut["process.width_of_cut"] = "1 mm"
    with pytest.raises(sphcut.ScenarioError, match="save it first"):
        sphcut.calibrate(cut, measured, closed_form=True)


def test_a_mistake_in_a_file_is_told_with_its_line(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text('title = "x"\nsource = "y"\nscenari = "cut.toml"\n')
    with pytest.raises(sphcut.ScenarioError, match=r"(?s)case.toml:3:1.*did you mean `scenario`"):
        sphcut.diagnose(case, closed_form=True, progress=False)
    with pytest.raises(sphcut.FileError, match="absent.toml"):
        sphcut.diagnose(tmp_path / "absent.toml", closed_form=True, progress=False)


# Where the tests run in the background of a shell, SIGINT is ignored until it is asked for.
LONG = """
import signal, sphcut, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
print("begun", flush=True)
try:
    sphcut.calibrate(sys.argv[1], sys.argv[2], fit=["A"], out=sys.argv[3], threads=1, progress=False)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c_stops_a_calibration(tmp_path: Path) -> None:
    files = [SCENARIOS / "calibration" / name for name in ("cut.toml", "cuts.csv")]
    words = [sys.executable, "-c", LONG, *map(str, files), str(tmp_path / "found")]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    under_way(tmp_path, 1)
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "interrupted\n"
    assert process.wait() == 0
    assert list(tmp_path.rglob("run.partial"))
