"""The grey box is that of the command, in the manner of scikit-learn."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

pytest.importorskip("sklearn", reason="skipped: scikit-learn is not installed")

from sklearn.base import clone
from sklearn.utils.estimator_checks import check_estimator

import sphcut
from cuts import command

REGRESSORS = ["linear", "quadratic"]


def tables(folder: Path) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Simulated and measured forces of twelve cuts; the simulation lacks a third of the force at low speed."""
    speed, thickness = np.meshgrid([60.0, 100.0, 150.0, 200.0], [0.06, 0.1, 0.2])
    speed, thickness = speed.ravel(), thickness.ravel()
    simulated = pd.DataFrame({"v_c [m/min]": speed, "h [mm]": thickness})
    simulated["F_c [N]"] = 1500.0 * 3.0 * thickness + 90.0
    simulated["F_f [N]"] = 500.0 * 3.0 * thickness + 60.0
    measured = simulated.copy()
    error = 40.0 * (1.0 - speed / 300.0) + 200.0 * thickness
    wave = np.resize([3.0, -2.0, 1.0, -2.5, 0.5], len(speed))
    measured["F_c [N]"] += error + wave
    measured["F_f [N]"] += 0.5 * error - wave
    simulated.to_csv(folder / "simulated.csv", index=False)
    measured.to_csv(folder / "measured.csv", index=False)
    return simulated, measured


def rows(table: pd.DataFrame) -> np.ndarray:
    """v_c [m/s], h [m], F_c and F_f [N]."""
    return np.column_stack([table["v_c [m/min]"] / 60.0, table["h [mm]"] * 1e-3, table["F_c [N]"], table["F_f [N]"]])


def test_it_is_the_fit_of_the_command(tmp_path: Path) -> None:
    simulated, measured = tables(tmp_path)
    words = "--simulated simulated.csv --measured measured.csv --out cli --quiet --regressors linear,quadratic"
    command("greybox", "fit", *words.split(), cwd=tmp_path)
    own = sphcut.GreyBox(regressors=REGRESSORS).fit(rows(simulated), rows(measured)[:, 2:])
    of_command = json.loads((tmp_path / "cli" / "model.json").read_text())
    model = json.loads(own.model_.to_json())
    assert own.chosen_ == [one["chosen"] for one in of_command["corrections"]]
    found, deviation = own.predict(rows(simulated), return_std=True)
    command("greybox", "predict", "--model", "cli", "--simulated", "simulated.csv", "--out", "p.csv", cwd=tmp_path)
    predicted = pd.read_csv(tmp_path / "p.csv")
    # The file has ten digits.
    np.testing.assert_allclose(found, predicted[["F_c [N]", "F_f [N]"]], rtol=1e-9)
    half = (predicted["F_c high [N]"] - predicted["F_c low [N]"]) / 2
    np.testing.assert_allclose(1.959963984540054 * deviation[:, 0], half, rtol=1e-7)
    assert model["corrections"][0]["regressors"][0]["mae"] == pytest.approx(
        of_command["corrections"][0]["regressors"][0]["mae"], rel=1e-6
    )
    # It is stored as the command stores it, and the command's is read.
    own.save(tmp_path / "own.json")
    command("greybox", "predict", "--model", "own.json", "--simulated", "simulated.csv", "--out", "q.csv", cwd=tmp_path)
    read = sphcut.GreyBox.load(tmp_path / "cli" / "model.json")
    np.testing.assert_allclose(read.predict(rows(simulated)), found, rtol=1e-9)
    assert (deviation > 0).all() and own.is_inside(rows(simulated)).all()
    outside = rows(simulated) * [3.0, 1.0, 1.0, 1.0]
    assert not own.is_inside(outside)[3]


def test_one_force_alone(tmp_path: Path) -> None:
    simulated, measured = tables(tmp_path)
    both = sphcut.GreyBox(regressors=REGRESSORS).fit(rows(simulated), rows(measured)[:, 2:])
    one = sphcut.GreyBox(regressors=REGRESSORS).fit(rows(simulated)[:, :3], rows(measured)[:, 2])
    np.testing.assert_array_equal(one.predict(rows(simulated)[:, :3]), both.predict(rows(simulated))[:, 0])
    # 12 measured forces with noise of a few N, a simulation that is wrong by tens: the correction pays.
    wrong = np.abs(rows(simulated)[:, 2] - rows(measured)[:, 2]).mean()
    assert one.mae_ < 0.3 * wrong
    assert one.score(rows(simulated)[:, :3], rows(measured)[:, 2]) > 0.99
    again = pickle.loads(pickle.dumps(one))
    np.testing.assert_array_equal(again.predict(rows(simulated)[:, :3]), one.predict(rows(simulated)[:, :3]))
    assert clone(one).set_params(seed=3).get_params() == {"regressors": REGRESSORS, "seed": 3, "progress": False}


def test_what_it_refuses(tmp_path: Path) -> None:
    simulated, measured = tables(tmp_path)
    X, y = rows(simulated)[:, :3], rows(measured)[:, 2]
    with pytest.raises(ValueError, match="gaussian_process"):
        sphcut.GreyBox(regressors=["gaussian"]).fit(X, y)
    with pytest.raises(ValueError, match="minimum of 3"):
        sphcut.GreyBox().fit(X[:, :2], y)
    with pytest.raises(ValueError, match="needs v_c"):
        sphcut.GreyBox().fit(np.hstack([X, X]), y)
    with pytest.raises(ValueError, match="have to be the same"):
        sphcut.GreyBox().fit(X, rows(measured)[:, 2:])
    with pytest.raises(ValueError, match="9 different conditions"):
        sphcut.GreyBox().fit(X[[*range(9), 0, 1]], y[[*range(9), 0, 1]])


class AnyWidth(sphcut.GreyBox):
    """The same estimator with rows of any width: what scikit-learn checks with tables that are no cuts. The first column stands for
    v_c, the second for h, and the simulated force is 0."""

    _least_columns = 2

    def _rows(self, X: Any) -> Any:
        return np.column_stack([X[:, 0], X[:, 1], np.zeros(len(X))])


# Checks of scikit-learn that do not apply, and why.
NOT_CUTS = {
    "check_estimators_dtypes": "9 different conditions, and a correction needs ten",
    "check_regressor_multioutput": "five outputs; a cut has two forces",
}
WIDTH = "X has the columns v_c, h and one or two simulated forces, the check another number"
NOT_THREE_COLUMNS = NOT_CUTS | dict.fromkeys(
    [
        "check_dtype_object",
        "check_estimators_fit_returns_self",
        "check_estimators_overwrite_params",
        "check_fit_check_is_fitted",
        "check_fit_idempotent",
        "check_n_features_in",
        "check_n_features_in_after_fitting",
        "check_positive_only_tag_during_fit",
        "check_readonly_memmap_input",
        "check_regressor_data_not_an_array",
        "check_regressors_int",
        "check_regressors_no_decision_function",
        "check_regressors_train",
    ],
    WIDTH,
)


def checked(estimator: Any, expected: dict[str, str]) -> tuple[list[str], int]:
    """The checks that fail and are not expected to; how many pass."""
    results = check_estimator(estimator, on_fail=None, on_skip=None, expected_failed_checks=expected)
    failed = [f"{one['check_name']}: {one['exception']!r}" for one in results if one["status"] == "failed"]
    return failed, sum(one["status"] == "passed" for one in results)


def test_scikit_learn_checks_it() -> None:
    failed, passed = checked(sphcut.GreyBox(regressors=["linear"]), NOT_THREE_COLUMNS)
    assert failed == [] and passed >= 30
    # What fails for the width alone passes with rows of any width.
    failed, passed = checked(AnyWidth(regressors=["linear"]), NOT_CUTS)
    assert failed == [] and passed >= 45
