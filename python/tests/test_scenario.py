"""Scenarios are read, changed, checked and refused with the line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import sphcut
from sphcut.scenario import literal


def test_values_are_read_as_written_and_in_si(cut: sphcut.Scenario) -> None:
    assert cut["process.cutting_speed"] == "150 m/min"
    assert cut.si("process.cutting_speed") == pytest.approx(2.5, rel=1e-15)  # 150 / 60 m/s
    assert cut["tool.friction"] == {"law": "shear_capped_coulomb", "friction_coefficient": 0.25}
    assert cut["output.snapshots"] == 4
    # A default is not in the text.
    assert "resolution.seed" in cut and cut["resolution.seed"] == "0"
    rows = cut.settings.set_index(["section", "key"])
    assert rows.loc[("process", "width_of_cut"), "number"] == pytest.approx(3e-3, rel=1e-15)


def test_a_change_keeps_the_rest_and_is_checked(cut: sphcut.Scenario) -> None:
    before = cut.text
    cut["process.cutting_speed"] = "200 m/min"
    assert cut.text == before.replace("150 m/min", "200 m/min")
    cut["tool.friction"] = {"law": "coulomb", "friction_coefficient": np.float64(0.3)}
    assert cut["tool.friction.friction_coefficient"] == 0.3
    cut.update({"process.uncut_chip_thickness": "0.12 mm", "output.snapshots": 2})
    assert (cut["process.uncut_chip_thickness"], cut["output.snapshots"]) == ("0.12 mm", 2)
    del cut["output.snapshots"]
    assert "snapshots" not in cut.text and "output.snapshots" in cut
    with pytest.raises(KeyError, match="not written"):
        del cut["output.snapshots"]
    # What has to be there stays.
    with pytest.raises(sphcut.ScenarioError, match="`edge_radius` is missing here"):
        del cut["tool.edge_radius"]
    assert cut["tool.edge_radius"] == "20 um"


def test_a_mistake_has_its_line_and_the_nearest_name(cut: sphcut.Scenario) -> None:
    before = cut.text
    with pytest.raises(sphcut.ScenarioError) as raised:
        cut["process.cutting_speed"] = "200 mm"
    problem = raised.value.problems[0]
    assert (Path(problem.file).name, problem.line, problem.column) == ("tiny.toml", 19, 17)
    assert "this is a length" in str(raised.value) and "m/min" in problem.help
    with pytest.raises(sphcut.ScenarioError, match="did you mean `cutting_speed`"):
        cut["process.cuting_speed"] = "200 m/min"
    with pytest.raises(sphcut.ScenarioError, match="names with dots"):
        cut["process..speed"] = 1
    with pytest.raises(sphcut.ScenarioError, match="cannot stand in a scenario"):
        cut["process.cutting_speed"] = object()
    with pytest.raises(KeyError, match="did you mean process.cutting_speed"):
        cut["process.cuting_speed"]
    assert cut.text == before


def test_a_file_with_mistakes_is_refused_whole(file: Path) -> None:
    file.write_text(file.read_text().replace("5 deg", "5 mm").replace("shear_capped", "shear"), encoding="utf-8")
    with pytest.raises(sphcut.ScenarioError) as raised:
        sphcut.Scenario.load(file)
    assert [problem.line for problem in raised.value.problems] == [10, 15]
    with pytest.raises(sphcut.ScenarioError, match="cannot use the file"):
        sphcut.Scenario.load(file.with_name("absent.toml"))


def test_values_are_written_as_toml() -> None:
    assert literal('a "b" \\ µ') == '"a \\"b\\" \\\\ µ"'
    assert literal([True, 1, np.int64(2), 1e-9]) == "[true, 1, 2, 1e-09]"
    assert literal({"law": "x", "two words": 0.5}) == '{ law = "x", "two words" = 0.5 }'
    with pytest.raises(sphcut.ScenarioError):
        literal(float("nan"))


def test_check_counts_particles(cut: sphcut.Scenario) -> None:
    found = cut.check()
    # 0.8 mm by 0.3 mm of particles of 25 um: 32 by 12.
    assert found.particles == pytest.approx(32 * 12, abs=40)
    assert found.particles_across_chip == pytest.approx(4.0)  # 0.1 mm / 25 um
    assert found.particles_across_edge == pytest.approx(0.8)  # 20 um / 25 um
    assert found.seconds is None and found.memory > 1e6
    assert any("across the edge radius" in warning for warning in found.warnings)
    low, high = cut.check(measure=True).seconds or (0.0, 0.0)
    assert 0.0 < low <= high
    assert "particles" in found._repr_html_()


def test_saved_and_shipped_scenarios(cut: sphcut.Scenario, tmp_path: Path) -> None:
    cut["process.cutting_speed"] = "200 m/min"
    cut.save(tmp_path / "fast.toml")
    assert (cut.name, cut.path) == ("fast", tmp_path / "fast.toml")
    assert sphcut.Scenario.load(tmp_path / "fast.toml").text == cut.text
    assert sphcut.Scenario.shipped("quickstart").si("process.width_of_cut") == pytest.approx(3e-3)
    with pytest.raises(sphcut.ScenarioError, match="did you mean `quickstart`"):
        sphcut.Scenario.shipped("quikstart")
