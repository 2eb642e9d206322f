"""The grey box: simulated forces corrected by measured ones, in the manner of scikit-learn."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sphcut import _native
from sphcut.progress import ProgressLine

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

try:
    from sklearn.base import BaseEstimator, RegressorMixin
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError as error:  # pragma: no cover
    raise ImportError("sphcut.GreyBox needs scikit-learn: pip install scikit-learn") from error

_NORMAL_95 = 1.959963984540054
"""Half width of a 95 % interval in standard deviations."""


class GreyBox(RegressorMixin, BaseEstimator):  # type: ignore[misc]
    """A white-box simulation, corrected by what measurements say about its error:

        y(x) = f_T(x) + f_D(x),   x = (v_c, h)

    with the measured force y, the simulated one f_T and a regressor f_D of what the simulation is wrong by.

    `X` has the columns v_c [m/s], h [m] and the simulated force f_T [N]; `y` is the measured force [N], row by row. For both forces
    at once `X` has v_c, h, F_c, F_f and `y` the two columns F_c, F_f: that is the fit of `sphcut greybox fit`, number for number.

    Parameters
    ----------
    regressors : list of str or None
        Which to compare: `linear`, `quadratic`, `quartic`, `support_vector`, `forest`, `boosting`, `network`, `gaussian_process`.
        The one with the smallest error on conditions left out is used (simpler ones within its uncertainty first). None: all,
        which takes a minute or two for a hundred rows.
    seed : int
        Of folds, resamples, forests and networks.
    progress : bool
        Show a line with the share that is done.

    Attributes
    ----------
    model_ : the fitted corrections; they can be pickled.
    chosen_ : str or list of str
        The regressor to use, of each force.
    mae_ : float or array
        Mean absolute error in N of the chosen regressor on conditions left out (10 folds).
    n_features_in_ : int
        Columns of `X`.
    """

    def __init__(self, regressors: list[str] | None = None, seed: int = 1, progress: bool = False) -> None:
        self.regressors = regressors
        self.seed = seed
        self.progress = progress

    _least_columns = 3

    def _rows(self, X: NDArray[np.float64]) -> NDArray[np.float64]:
        """Speed, thickness and simulated forces of checked `X`."""
        if X.shape[1] > 4:
            raise ValueError(
                f"X has {X.shape[1]} columns; it needs v_c [m/s], h [m] and the simulated force [N], or F_c and F_f [N]"
            )
        return X

    def fit(self, X: ArrayLike, y: ArrayLike) -> Self:
        """Learns the correction; needs ten different conditions. Ctrl-C is heeded when the fit is over."""
        table, targets = validate_data(
            self,
            X,
            y,
            dtype=np.float64,
            multi_output=True,
            y_numeric=True,
            ensure_min_samples=10,
            ensure_min_features=self._least_columns,
        )
        rows = self._rows(table)
        forces = np.asarray(targets, dtype=np.float64).reshape(len(table), -1)
        if forces.shape[1] != rows.shape[1] - 2:
            raise ValueError(f"y has {forces.shape[1]} columns of forces and X {rows.shape[1] - 2}: they have to be the same")
        # One force is fitted as if it were both.
        width = slice(0, 2) if forces.shape[1] == 2 else [0, 0]
        simulated = np.hstack([rows[:, :2], rows[:, 2:][:, width]])
        measured = np.hstack([rows[:, :2], forces[:, width]])
        line = ProgressLine("grey box") if self.progress else None
        regressors = _native.GreyBoxModel.regressors() if self.regressors is None else list(self.regressors)
        self.model_ = _native.GreyBoxModel.fit(simulated.tolist(), measured.tolist(), regressors, self.seed, line)
        if line is not None:
            line.end()
        self._take(forces.shape[1] == 2)
        return self

    def _take(self, both: bool) -> None:
        """Attributes of the model, of both forces or of one alone."""
        self.n_outputs_ = 2 if both else 1
        chosen = self.model_.chosen
        self.chosen_: str | list[str] = [key for key, _ in chosen] if both else chosen[0][0]
        self.mae_: Any = np.array([mae for _, mae in chosen]) if both else chosen[0][1]

    def predict(self, X: ArrayLike, return_std: bool = False) -> Any:
        """Corrected forces in N; with `return_std` also the standard deviation of a new measurement in N: the half width of the
        95 % interval of `sphcut greybox predict` over 1.96, wider outside the conditions of the fit."""
        forces, half, _ = self._predicted(X)
        if self.n_outputs_ == 1:
            forces, half = forces[:, 0], half[:, 0]
        return (forces, half / _NORMAL_95) if return_std else forces

    def is_inside(self, X: ArrayLike) -> NDArray[np.bool_]:
        """Whether each row lies within the hull of the conditions of the fit; outside, the correction extrapolates."""
        return self._predicted(X)[2]

    def _predicted(self, X: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        check_is_fitted(self)
        rows = self._rows(validate_data(self, X, dtype=np.float64, reset=False))
        answers = np.array(
            [
                self.model_.predict(force, rows[:, [0, 1, 2 + force]].tolist(), None)
                for force in range(self.n_outputs_)
            ]
        )
        return answers[:, :, 0].T, ((answers[:, :, 2] - answers[:, :, 1]) / 2).T, answers[0, :, 3] > 0.5

    def save(self, path: str | PathLike[str]) -> None:
        """Writes the file that `sphcut greybox predict --model FILE` reads."""
        check_is_fitted(self)
        Path(path).write_text(self.model_.to_json(), encoding="utf-8")

    @classmethod
    def load(cls, path: str | PathLike[str]) -> GreyBox:
        """The corrections of `model.json` of `sphcut greybox fit`, for both forces."""
        self = cls()
        self.model_ = _native.GreyBoxModel.from_json(Path(path).read_text(encoding="utf-8"))
        self.n_features_in_ = 4
        self._take(True)
        return self

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.target_tags.multi_output = True
        tags.target_tags.single_output = True
        tags.regressor_tags.poor_score = True
        return tags
