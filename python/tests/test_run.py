"""Runs: the numbers of the command, particles as arrays, pictures."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import sphcut
from cuts import TINY, command, under_way


def test_forces_are_those_of_the_command_bit_for_bit(run: sphcut.Run, file: Path, tmp_path: Path) -> None:
    command("run", file, "--out", tmp_path / "cli", "--threads", "1", "--quiet", cwd=tmp_path)
    head, *lines = (tmp_path / "cli" / "forces.csv").read_text().splitlines()
    numbers = [[float(cell) for cell in line.split(",")] for line in lines]
    pd.testing.assert_frame_equal(run.forces, pd.DataFrame(numbers, columns=head.split(",")), check_exact=True)
    assert (tmp_path / "cli" / "forces.csv").read_bytes() == (run.folder / "forces.csv").read_bytes()
    assert run.forces.attrs["units"]["cutting_force [N]"] == "N"
    # The channels hold N per metre of width, and the cut is 3 mm wide.
    channels = run.channels
    assert channels.attrs["units"]["cutting_force"] == "N/m"
    assert (channels["cutting_force"] * 3e-3 == run.forces["cutting_force [N]"]).all()


def test_summary_and_pages(run: sphcut.Run) -> None:
    assert run.outcome == "finished" and run.report.is_file()
    summary = run.summary
    force = summary["forces"]["cutting"]
    assert force["mean_n"] == pytest.approx(3.0 * force["mean_n_per_mm"])  # 3 mm
    assert not summary["steady"]["reached"]
    page = run._repr_html_()
    assert f"{force['mean_n']:.1f}" in page and "The cutting force is not steady" in page and "report.html" in page


def test_particles_are_arrays(run: sphcut.Run) -> None:
    assert len(run.snapshots) == 4 and run.snapshots.times == sorted(run.snapshots.times)
    first, last = run.snapshots[0], run.snapshots[-1]
    assert last.time == run.snapshots.times[-1] and last.step > 0
    assert last.position.shape == (len(last), 3) and last.stress.shape == (len(last), 6)
    assert last.id.dtype == np.uint64 and len(set(last.id)) == len(last)
    assert (first.temperature == pytest.approx(293.15)) and last.temperature.max() > 300.0
    # What the record has of the highest temperature is that of the last particles.
    assert last.temperature.max() == run.channels["max_temperature"].iloc[-1]
    # Pressure and von Mises stress follow from the stress.
    xx, yy, zz, xy, yz, xz = last.stress.T
    np.testing.assert_allclose(last.pressure, -(xx + yy + zz) / 3, rtol=1e-9, atol=1.0)
    mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy**2 + yz**2 + xz**2))
    np.testing.assert_allclose(last.von_mises_stress, mises, rtol=1e-6, atol=10.0)
    assert last.units["stress"] == "Pa" and "tension" in last.meanings["stress"]
    with pytest.raises(AttributeError, match="plastic_strain"):
        last.plasticity
    with pytest.raises(IndexError):
        run.snapshots[4]
    assert [one.step for one in run.snapshots[1:]] == [one.step for one in run.snapshots][1:]


def test_a_run_that_is_there_is_given_back(cut: sphcut.Scenario, tmp_path: Path) -> None:
    first = cut.run(tmp_path / "out", progress=False)
    start = first.forces
    written = (tmp_path / "out" / "run.h5").stat().st_mtime_ns
    again = cut.run(tmp_path / "out", progress=False)
    assert (tmp_path / "out" / "run.h5").stat().st_mtime_ns == written
    pd.testing.assert_frame_equal(again.forces, start, check_exact=True)
    cut["process.cutting_speed"] = "180 m/min"
    with pytest.raises(sphcut.ScenarioError, match="belongs to another run.*\n.*force=True"):
        cut.run(tmp_path / "out", progress=False)
    faster = cut.run(tmp_path / "out", force=True, progress=False)
    assert not faster.forces.equals(start)
    assert sphcut.Run.open(tmp_path / "out").outcome == "finished"
    with pytest.raises(sphcut.FileError):
        sphcut.Run.open(tmp_path / "nothing")


def test_progress_is_told(cut: sphcut.Scenario, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cut.run(tmp_path / "out", progress=True)
    told = capsys.readouterr().err
    assert "tiny:" in told and "100 %" in told and "F_c" in told


def test_a_run_that_diverges_is_an_exception(cut: sphcut.Scenario, tmp_path: Path) -> None:
    # Ten thousand times the inertia, a thousand metres per second, and a tool a hundred times as stiff.
    cut.update({"process.cutting_speed": "1000 m/s", "numerics.mass_scaling": 10000, "contact.stiffness": 100})
    with pytest.raises(sphcut.DivergedError, match="diverged in step"):
        cut.run(tmp_path / "out", progress=False)
    assert sphcut.Run.open(tmp_path / "out").outcome.startswith("diverged")


def test_other_threads_go_on_while_it_steps(cut: sphcut.Scenario, tmp_path: Path) -> None:
    counted, done = 0, threading.Event()

    def count() -> None:
        nonlocal counted
        while not done.is_set():
            counted += 1
            time.sleep(0.001)

    other = threading.Thread(target=count)
    other.start()
    begun = time.monotonic()
    cut.run(tmp_path / "out", progress=False)
    seconds = time.monotonic() - begun
    done.set()
    other.join()
    # With the lock held it would not count at all; a tenth of what it could leaves room for a busy machine.
    assert counted > 100 * seconds


# Where the tests run in the background of a shell, SIGINT is ignored until it is asked for.
LONG = """
import signal, sphcut, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
cut = sphcut.Scenario.load(sys.argv[1])
cut.update({"workpiece.length": "6 mm", "stop.travel": "4 mm"})
print("begun", flush=True)
try:
    cut.run(sys.argv[2], progress=False)
except KeyboardInterrupt:
    print("interrupted", flush=True)
    run = sphcut.Run.open(sys.argv[2])
    print(run.outcome, run.forces["travel [mm]"].iloc[-1])
"""


def test_ctrl_c_leaves_a_checkpoint(file: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-c", LONG, str(file), str(tmp_path / "out")]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None and process.stdout.readline() == "begun\n"
    under_way(tmp_path, 1)
    process.send_signal(signal.SIGINT)
    sent = time.monotonic()
    assert process.stdout.readline() == "interrupted\n"
    # A step takes milliseconds, writing record and checkpoint a second where the disk is busy.
    assert time.monotonic() - sent < 5.0
    outcome, travel = process.stdout.readline().split()
    assert process.wait() == 0
    assert outcome == "interrupted" and 0.0 < float(travel) < 4.0
    # The checkpoint is gone on with, here with an end that is near.
    cut = sphcut.Scenario.load(file)
    cut.update({"workpiece.length": "6 mm", "stop.travel": "4 mm"})
    lines: list[float] = []
    with pytest.raises(RuntimeError, match="enough"):
        cut._native.run(tmp_path / "out", "resume", None, lambda share, line: stop(lines, share))
    assert lines[0] >= 0.9 * float(travel) / 4.0


def stop(lines: list[float], share: float) -> None:
    """An exception of whoever listens stops a run as Ctrl-C does."""
    lines.append(share)
    raise RuntimeError("enough")


def test_a_plot_shows_the_forces(run: sphcut.Run) -> None:
    pytest.importorskip("matplotlib", reason="skipped: matplotlib is not installed")
    axes = run.plot()
    (line, *_) = axes.get_lines()
    assert (line.get_ydata() == run.forces["cutting_force [N]"].to_numpy()).all()
    assert axes.get_xlabel() == "travel [mm]"


def assert_drawn(pv: Any, particles: Any, scalars: str, tool: Any) -> None:
    """Particles in several colours and the grey tool are a picture, not an empty page; skips where nothing can be drawn."""
    try:
        plotter = pv.Plotter(off_screen=True, window_size=(300, 200))
        plotter.add_mesh(particles, scalars=scalars, point_size=6, show_scalar_bar=False)
        plotter.add_mesh(tool, color="grey")
        plotter.view_xy()
        picture = plotter.screenshot(return_img=True)
    except Exception as error:  # no graphics on this machine
        pytest.skip(f"skipped: pyvista cannot draw here: {error}")
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 20


def test_a_picture_of_the_particles(run: sphcut.Run, tmp_path: Path) -> None:
    pv = pytest.importorskip("pyvista", reason="skipped: pyvista is not installed")
    last = run.snapshots[-1]
    cloud, tool = last.to_pyvista(), last.tool_to_pyvista()
    assert cloud.n_points == len(last) and (cloud["temperature"] == last.temperature).all()
    assert tool.n_cells == 1 and tool.n_points == len(last.tool)
    assert_drawn(pv, cloud, "temperature", tool)


def test_the_files_for_paraview_are_a_picture(run: sphcut.Run) -> None:
    pv = pytest.importorskip("pyvista", reason="skipped: pyvista is not installed")
    particles, tool = (pv.read(run.folder / name) for name in ("snapshots.vtkhdf", "tool.vtkhdf"))
    first = run.snapshots[0]
    assert particles.n_points == len(first)
    # The tool conducts heat: triangles within its outline (0.1 um of it: round parts are chords), with their temperature.
    low, high = first.tool.min(axis=0), first.tool.max(axis=0)
    assert np.allclose(tool.bounds[::2], low, atol=2e-7) and np.allclose(tool.bounds[1::2], high, atol=2e-7)
    assert tool.is_all_triangles and (tool["temperature"] > 290.0).all()
    # Half the spacing of 25 um.
    assert np.allclose(particles["radius"], 12.5e-6)
    spheres = particles.glyph(scale="radius", orient=False, geom=pv.Sphere(radius=1.0))
    assert_drawn(pv, spheres, "pressure", tool)


def test_tiny_is_the_scenario_of_its_run(run: sphcut.Run) -> None:
    assert run.scenario_text == TINY and run.title == "A tiny cut"
