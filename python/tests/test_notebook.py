"""The example notebook does what it shows."""

from __future__ import annotations

from pathlib import Path

import pytest

from cuts import REPOSITORY

NOTEBOOK = REPOSITORY / "python" / "examples" / "first_cut.ipynb"


def test_the_example_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbformat = pytest.importorskip("nbformat", reason="skipped: nbconvert is not installed")
    preprocessors = pytest.importorskip("nbconvert.preprocessors", reason="skipped: nbconvert is not installed")
    pytest.importorskip("ipykernel", reason="skipped: ipykernel is not installed")
    pytest.importorskip("matplotlib", reason="skipped: matplotlib is not installed")
    # Pictures go into the notebook.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    assert all(not cell.get("outputs") for cell in notebook.cells), "the notebook is kept without its output"
    executor = preprocessors.ExecutePreprocessor(timeout=300, kernel_name="python3")
    executor.preprocess(notebook, {"metadata": {"path": str(tmp_path)}})
    shown = "\n".join(
        str(output.get("data", output.get("text", ""))) for cell in notebook.cells for output in cell.get("outputs", [])
    )
    assert shown.count("image/png") == 3
    assert "is 3.33" in shown and "F_c [N]" in shown
    assert (tmp_path / "out" / "quickstart" / "report.html").is_file()
    assert len(list((tmp_path / "out" / "quickstart_sweep" / "store").rglob("run.h5"))) == 4
