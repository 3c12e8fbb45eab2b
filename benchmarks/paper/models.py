# SPDX-License-Identifier: BSD-3-Clause
"""The models that are compared, and their search: the same for all of them."""

import warnings
from contextlib import contextmanager

import numpy as np
from scipy.linalg import LinAlgWarning
from scipy.stats import loguniform
from sklearn.base import clone
from sklearn.compose import TransformedTargetRegressor
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.exceptions import ConvergenceWarning, FitFailedWarning
from sklearn.kernel_ridge import KernelRidge
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import KFold, RandomizedSearchCV
from sklearn.neural_network import MLPRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import FunctionTransformer, StandardScaler
from threadpoolctl import threadpool_limits

from benchmarks.paper.gaussian import GaussianProcess
from benchmarks.paper.valve import MechanismAlone
from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValidityWarning
from sklvalve.metrics import neg_rmse_scorer

HYBRIDS = ("series", "parallel", "mixed")
BLACK_BOXES = ("LS-SVM", "KernelRidge", "GaussianProcess", "HistGradientBoosting", "MLP")
#: Draws of every search, and contiguous blocks of rows that are left out in turn.
DRAWS, BLOCKS = 6, 3

_COST, _GAMMA = loguniform(10.0, 1e6), loguniform(3e-3, 1.0)
# of what a straight line or a series hybrid leaves over, which may be little but noise
_COST_OF_REST = loguniform(1e-2, 1e3)
_SPACES = {
    "LS-SVM": {"C": _COST, "gamma": _GAMMA},
    "KernelRidge": {"alpha": loguniform(1e-6, 0.1), "gamma": _GAMMA},
    "GaussianProcess": {
        "kernel": ["rbf", "matern", "rbf and linear", "matern and linear"],
        "learnt_from": [60, 100],
    },
    "HistGradientBoosting": {
        "learning_rate": loguniform(0.03, 0.3),
        "max_iter": [50, 100],
        "max_leaf_nodes": [4, 8, 16],
        "min_samples_leaf": [3, 6, 12],
        "l2_regularization": loguniform(1e-4, 1.0),
    },
    "MLP": {
        "hidden_layer_sizes": [(8,), (16,), (16, 8)],
        "activation": ["tanh", "relu"],
        "alpha": loguniform(1e-5, 1.0),
    },
}


def models(mechanism, seen, seed, *, link="log", log_target=True):
    """Estimators, and what their search draws from, by name.

    Parameters
    ----------
    mechanism : object
        As a hybrid wants it.
    seen : list of int
        Columns that the unknown parameter depends on.
    seed : int
    link : {"log", "identity"}
        Of the series hybrid.
    log_target : bool
        Whether a black box may learn the logarithm of the target, which it then tries both ways.
    """
    inner = make_pipeline(StandardScaler(), LSSVMRegressor())
    line_and_rest = ParallelHybridRegressor(LinearRegression(), inner)
    series = SeriesHybridRegressor(mechanism, line_and_rest, link=link, regressor_columns=seen)
    chosen = {
        "mechanism": (MechanismAlone(mechanism), {}),
        "series": (series, _of_rest("regressor__regressor__")),
        "parallel": (ParallelHybridRegressor(mechanism, inner), _of_lssvm("regressor__")),
        "mixed": (
            ParallelHybridRegressor(series, inner),
            _of_rest("mechanism__regressor__regressor__") | _of_rest("regressor__"),
        ),
    }
    plain = {
        "LS-SVM": LSSVMRegressor(),
        "KernelRidge": KernelRidge(kernel="rbf"),
        "GaussianProcess": GaussianProcess(),
        "HistGradientBoosting": HistGradientBoostingRegressor(random_state=seed),
        "MLP": MLPRegressor(solver="lbfgs", max_iter=300, random_state=seed),
    }
    targets = [StandardScaler()]
    if log_target:
        logarithm = FunctionTransformer(np.log, np.exp, check_inverse=False)
        targets.append(make_pipeline(logarithm, StandardScaler()))
    for name, regressor in plain.items():
        scaled = make_pipeline(StandardScaler(), regressor)
        space = {f"regressor__{scaled.steps[-1][0]}__{key}": draw for key, draw in _SPACES[name].items()}
        box = TransformedTargetRegressor(scaled, transformer=targets[0], check_inverse=False)
        chosen[name] = (box, space | {"transformer": targets})
    return chosen


def tuned(estimator, space, X, y, seed):
    """The estimator with the best of `DRAWS` draws, fitted to all rows, and its error on left-out blocks."""
    with quiet(), threadpool_limits(1):
        if not space:
            return clone(estimator).fit(X, y), np.nan
        search = RandomizedSearchCV(
            estimator,
            space,
            n_iter=DRAWS,
            cv=KFold(BLOCKS),
            scoring=neg_rmse_scorer,
            random_state=seed,
        ).fit(X, y)
    return search.best_estimator_, -search.best_score_


@contextmanager
def quiet():
    """No word of fits that did not converge or gave no number: what they predict is measured."""
    with warnings.catch_warnings():
        for kind in (ConvergenceWarning, FitFailedWarning, LinAlgWarning, ValidityWarning, RuntimeWarning):
            warnings.simplefilter("ignore", kind)
        yield


def _of_rest(prefix):
    return _of_lssvm(prefix, _COST_OF_REST)


def _of_lssvm(prefix, cost=_COST):
    return {f"{prefix}lssvmregressor__C": cost, f"{prefix}lssvmregressor__gamma": _GAMMA}
