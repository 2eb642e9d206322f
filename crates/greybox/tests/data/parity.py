"""Makes four data sets with fixed folds, and the figures of scikit-learn and xgboost on them.

    python parity.py            (numpy, scikit-learn, xgboost)

Writes set_1.csv to set_4.csv (v_c in m/s, h in m, target in N, fold) and figures.json: for every regressor the mean
absolute error over the held-out rows of all folds. Settings are fixed and stand in figures.json;
tests/parity.rs fits the same settings. What depends on random numbers is averaged over seeds.
"""

import json
import warnings
from pathlib import Path

import numpy as np
import sklearn
import xgboost
from sklearn.compose import TransformedTargetRegressor
from sklearn.ensemble import RandomForestRegressor
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
from sklearn.linear_model import LinearRegression
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from sklearn.svm import SVR

HERE = Path(__file__).parent
SEEDS = 10


def plan():
    """The 11 x 10 plan: 100 to 200 m/min, 0.06 to 0.15 mm."""
    v, h = np.meshgrid(np.arange(100, 201, 10) / 60, np.arange(6, 16) * 1e-5, indexing="ij")
    return v.ravel(), h.ravel()


def sets():
    random = np.random.default_rng(1045)
    v, h = plan()
    x, y = (v * 60 - 100) / 100, (h * 1e3 - 0.06) / 0.09
    smooth = 270 - 90 * x + 60 * y + 45 * np.exp(-4 * x) * y**2 + 12 * np.sin(5 * x)
    yield v, h, smooth + random.normal(0, 4, v.size), np.arange(v.size)
    # A built-up edge that comes and goes: two plateaus with a step, and noise.
    step = 40 + 80 / (1 + np.exp((x - 0.45 - 0.2 * y) / 0.03)) + 30 * y
    yield v, h, step + random.normal(0, 6, v.size), np.arange(v.size)
    # Sixty scattered conditions, mostly plane.
    v, h = random.uniform(0.5, 5, 60), random.uniform(2e-5, 3e-4, 60)
    plane = 30 + 20 * v - 2.5e5 * h + 6e4 * (v - 2) * h
    yield v, h, plane + random.normal(0, 8, 60), np.arange(60)
    # Fifty conditions over decades, measured three times.
    v, h = np.exp(random.uniform(np.log(0.2), np.log(8), 50)), np.exp(random.uniform(np.log(1e-5), np.log(4e-4), 50))
    power = 60 * v**-0.3 + 9000 * h**0.6 * v**-0.1
    v, h, power = np.repeat(v, 3), np.repeat(h, 3), np.repeat(power, 3)
    yield v, h, power + random.normal(0, 5, 150), np.repeat(np.arange(50), 3)


def scaled(model):
    return TransformedTargetRegressor(make_pipeline(StandardScaler(), model), transformer=StandardScaler())


def regressors():
    """Name, settings and a maker of the model of a seed (None: no random numbers)."""
    for name, degree in (("linear", 1), ("quadratic", 2), ("quartic", 4)):
        yield name, {"degree": degree}, lambda seed, d=degree: scaled(
            make_pipeline(PolynomialFeatures(d, include_bias=False), LinearRegression())), 1
    yield "support_vector", {"C": 100, "epsilon": 0.05, "gamma": 0.3}, lambda seed: scaled(
        SVR(C=100, epsilon=0.05, gamma=0.3)), 1
    yield "forest", {"trees": 200, "min_leaf": 2}, lambda seed: RandomForestRegressor(
        n_estimators=200, min_samples_leaf=2, random_state=seed), SEEDS
    yield "boosting", {"trees": 200, "max_depth": 3, "learning_rate": 0.1, "lambda": 1}, lambda seed: xgboost.XGBRegressor(
        n_estimators=200, max_depth=3, learning_rate=0.1, reg_lambda=1, gamma=0, tree_method="exact", n_jobs=1), 1
    yield "network", {"neurons": [16, 16], "decay": 1e-4, "learning_rate": 0.01, "patience": 60, "epochs": 1500,
                      "validation_share": 0.15}, lambda seed: scaled(
        MLPRegressor(hidden_layer_sizes=(16, 16), alpha=1e-4, learning_rate_init=0.01, early_stopping=True, validation_fraction=0.15,
                     n_iter_no_change=60, max_iter=1500, tol=0.0, random_state=seed)), SEEDS
    kernel = ConstantKernel(1.0, (1e-4, 1e4)) * Matern([1.0, 1.0], (0.05, 100.0), nu=2.5) + WhiteKernel(0.1, (1e-6, 10.0))
    yield "gaussian_process", {"kernel": "Matern 5/2, one length per input, noise"}, lambda seed: scaled(
        GaussianProcessRegressor(kernel, n_restarts_optimizer=4, random_state=seed)), 1


def main():
    warnings.filterwarnings("ignore")
    figures = {"scikit-learn": sklearn.__version__, "xgboost": xgboost.__version__, "numpy": np.__version__, "settings": {}, "mae": []}
    for number, (v, h, target, group) in enumerate(sets(), 1):
        order = np.random.default_rng(number).permutation(group.max() + 1)
        fold = (np.argsort(order) % 10)[group]
        table = np.column_stack([v, h, target, fold])
        np.savetxt(HERE / f"set_{number}.csv", table, delimiter=",", fmt=["%.17g"] * 3 + ["%d"], header="cutting_speed,uncut_chip_thickness,target,fold", comments="")
        inputs, errors = np.column_stack([v, h]), {}
        for name, settings, make, seeds in regressors():
            figures["settings"][name] = settings
            found = []
            for seed in range(seeds):
                predicted = np.empty_like(target)
                for k in range(10):
                    model = make(seed).fit(inputs[fold != k], target[fold != k])
                    predicted[fold == k] = model.predict(inputs[fold == k])
                found.append(np.abs(predicted - target).mean())
            errors[name] = round(float(np.mean(found)), 5)
        figures["mae"].append(errors)
        print(number, errors)
    (HERE / "figures.json").write_text(json.dumps(figures, indent=1) + "\n")


main()
