# SPDX-License-Identifier: BSD-3-Clause
"""scikit-learn's check suite over combinations of parameters, and over estimators of named signals.

Each folder's own tests run the suite on the usual parameters without exclusions. All that is excluded
anywhere is listed here, with its reason.
"""

import re
from itertools import product

import numpy as np
import pytest
from sklearn.base import clone
from sklearn.utils.estimator_checks import check_estimator

from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.lssvm.choice import SOLVERS
from sklvalve.lssvm.kernels import WITH_GAMMA
from tests.named_columns import FinderOfMatrix, SimulationOfMatrix

_MEMORY = "rows are moments, and a stem and a meter remember the one before"
#: Checks that an estimator of named signals does not pass.
EXCLUDED_CHECKS = {
    "SimulationOfMatrix": {
        "check_methods_sample_order_invariance": _MEMORY,
        "check_methods_subset_invariance": _MEMORY,
    },
    "FinderOfMatrix": {
        "check_methods_sample_order_invariance": _MEMORY,
        "check_methods_subset_invariance": _MEMORY,
    },
}
#: Parameters of LSSVMRegressor with which a check cannot pass, whatever the others are: a fit refuses them.
EXCLUDED_PARAMETERS = [
    ({"kernel": "precomputed", "solver": "pcg"}, "its preconditioner is made of rows, and a matrix has none"),
    ({"kernel": "precomputed", "solver": "nystrom"}, "its landmarks are rows, and a matrix has none"),
    ({"kernel": "precomputed", "uncertainty": True}, "its landmarks are rows, and a matrix has none"),
]
#: Parameters with which a check can pass, and does not with the numbers that are the defaults, or with any.
CONDITIONS = [
    (
        {"solver": "pcg", "robust_passes": 2},
        "weights by errors magnify what tol leaves of the equations, and a check compares to 1e-7: tol=1e-14",
    ),
    ({"gamma": [0.1, 0.2]}, "one gamma for each column, and the checks pass matrices of several widths"),
    ({"C": 1e-2}, "a function so flat that check_regressors_train finds no score above 0.5"),
    ({"gamma": 1e-6}, "likewise"),
    ({"solver": "nystrom", "n_landmarks": 5}, "likewise"),
    ({"kernel": "poly", "coef0": -1.0}, "no kernel: a part of the matrix is not positive semidefinite"),
]


def affine(a, b):
    # a quick one: it is called for every pair of rows
    return a @ b + 1.0


KERNELS = ("rbf", "linear", "poly", "laplacian", affine, "precomputed")
BIASES = ("free", "regularized", "none")
OPTIONS = (
    {},
    {"robust_passes": 2},
    {"uncertainty": True},
    {"gamma": "scale"},
    {"gamma": 0.3, "degree": 2, "C": 1.0},
)
#: Other numbers, and the machine that chooses its own.
OTHERS = (
    LSSVMRegressor(C=1e12),
    LSSVMRegressor(max_memory=1.0, robust_passes=10),
    LSSVMRegressor(solver="tiled", n_jobs=2),
    LSSVMRegressor(solver="pcg", n_jobs=2, max_iter=1),
    LSSVMRegressor(solver="nystrom", max_iter=1),
    LSSVMRegressor("polynomial", degree=5, coef0=0.0),
    LSSVMRegressor(gamma=1e3, tol=1e-2),
    LSSVMRegressor(uncertainty=True, n_landmarks=3),
    LSSVMRegressorCV("rbf", cv=3, gap=1),
    LSSVMRegressorCV("poly", degree=2, Cs=[1.0, 100.0]),
    # as in the first condition: at the large C that it chooses, tol=1e-6 leaves more than a check allows
    LSSVMRegressorCV("laplacian", gammas=[0.1], solver="pcg", tol=1e-9),
    LSSVMRegressorCV("linear", bias="regularized", solver="tiled"),
    LSSVMRegressorCV(bias="none", solver="nystrom"),
    LSSVMRegressorCV(robust_passes=1, uncertainty=True),
)


def _told(estimator):
    """An estimator's text without addresses: two processes name a test alike."""
    return re.sub(r" at 0x[0-9a-f]+", "", str(estimator))


def _made(**values):
    """The machine of such parameters; None where a fit refuses them."""
    if any(parameters.items() <= values.items() for parameters, _ in EXCLUDED_PARAMETERS):
        return None
    exact = {"tol": 1e-14} if values["solver"] == "pcg" and values.get("robust_passes") else {}
    return LSSVMRegressor(**values, **exact, n_jobs=1, random_state=0)


def _combinations():
    """Every kernel with every solver, and both with every bias and every option, in few combinations."""
    for (i, kernel), (j, solver) in product(enumerate(KERNELS), enumerate(("auto", *SOLVERS))):
        more = OPTIONS[(i + 2 * j) % len(OPTIONS)]
        estimator = _made(kernel=kernel, solver=solver, bias=BIASES[(i + j) % len(BIASES)], **more)
        if estimator is not None:
            # a kernel that is called for each pair of rows takes its time
            late = [pytest.mark.slow] if callable(kernel) and solver not in ("auto", "tiled") else []
            yield pytest.param(estimator, marks=late, id=_told(estimator))


def _every_combination(kernel, solver):
    """All of bias, robust_passes, uncertainty and gamma for a kernel and a solver."""
    gammas = (None, "scale", 0.3) if kernel in WITH_GAMMA else (None,)
    for bias, passes, uncertainty, gamma in product(BIASES, (0, 2), (False, True), gammas):
        more = {"robust_passes": passes, "uncertainty": uncertainty, "gamma": gamma}
        estimator = _made(kernel=kernel, solver=solver, bias=bias, **more)
        if estimator is not None:
            yield estimator


def _failures(estimator):
    expected = EXCLUDED_CHECKS.get(type(estimator).__name__, {})
    results = check_estimator(estimator, expected_failed_checks=expected, on_fail=None, on_skip=None)
    assert len(results) > 40
    # one that is excluded and passes is excluded without need
    idle = {r["check_name"] for r in results if r["check_name"] in expected and r["status"] == "passed"}
    return [(r["check_name"], str(r["exception"])) for r in results if r["status"] == "failed"] + sorted(idle)


# the checks of a precomputed kernel pass matrices that are no kernel matrices; the estimator says so
@pytest.mark.filterwarnings("ignore:The kernel matrix plus 1/C:scipy.linalg.LinAlgWarning")
@pytest.mark.filterwarnings("ignore:The LS-SVM equations are met only:scipy.linalg.LinAlgWarning")
@pytest.mark.filterwarnings("ignore:SCIPY_ARRAY_API is not set")
@pytest.mark.parametrize("estimator", _combinations())
def test_lssvm(estimator):
    assert _failures(estimator) == []


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("estimator", OTHERS, ids=str)
def test_other_numbers(estimator):
    assert _failures(clone(estimator).set_params(random_state=0)) == []


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("solver", ["auto", *SOLVERS])
@pytest.mark.parametrize("kernel", [kernel for kernel in KERNELS if not callable(kernel)])
def test_every_combination(kernel, solver):
    failed = {str(e): found for e in _every_combination(kernel, solver) if (found := _failures(e))}
    assert failed == {}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("parameters", "reason"), CONDITIONS[1:])
def test_conditions_are_no_pretext(parameters, reason):
    assert reason
    assert _failures(LSSVMRegressor(**parameters, random_state=0)) != []


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(("tol", "passes"), [(1e-6, False), (1e-14, True)])
def test_the_first_condition(tol, passes):
    more = {"bias": "none", "gamma": "scale", "random_state": 0}
    assert (_failures(LSSVMRegressor(**CONDITIONS[0][0], **more, tol=tol)) == []) is passes


@pytest.mark.parametrize(("parameters", "reason"), EXCLUDED_PARAMETERS)
def test_excluded_parameters_are_refused(parameters, reason):
    assert reason
    with pytest.raises(ValueError, match="precomputed kernel"):
        LSSVMRegressor(**parameters).fit(np.eye(9), np.arange(9.0))


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "estimator", [SimulationOfMatrix(), FinderOfMatrix(max_effects=0, n_jobs=1)], ids=str
)
def test_estimators_of_named_signals(estimator):
    assert _failures(estimator) == []
