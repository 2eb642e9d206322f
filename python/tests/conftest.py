"""What several tests need of the tiny cut."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import sphcut
from cuts import TINY

os.environ.setdefault("MPLBACKEND", "Agg")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """The file of the tiny cut."""
    path = tmp_path / "tiny.toml"
    path.write_text(TINY, encoding="utf-8")
    return path


@pytest.fixture
def cut(file: Path) -> sphcut.Scenario:
    """The tiny cut."""
    return sphcut.Scenario.load(file)


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> sphcut.Run:
    """The run of the tiny cut."""
    folder = tmp_path_factory.mktemp("run")
    return sphcut.Scenario.from_string(TINY, name="tiny").run(folder / "out", progress=False)
