# SPDX-License-Identifier: BSD-3-Clause
"""scikit-learn's check suite over combinations of parameters, and over estimators of named signals.

Each folder's own tests run the suite on the usual parameters without exclusions. All that is excluded
anywhere is listed here, with its reason.
"""

from itertools import product

import numpy as np
import pytest
from sklearn.utils.estimator_checks import check_estimator

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.choice import SOLVERS
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


def _combinations():
    """Every kernel with every solver, and both with every bias and every option, in few combinations."""
    for (i, kernel), (j, solver) in product(enumerate(KERNELS), enumerate(("auto", *SOLVERS))):
        more = OPTIONS[(i + 2 * j) % len(OPTIONS)]
        values = {"kernel": kernel, "solver": solver, "bias": BIASES[(i + j) % len(BIASES)]} | more
        if not any(parameters.items() <= values.items() for parameters, _ in EXCLUDED_PARAMETERS):
            yield LSSVMRegressor(**values, n_jobs=1, random_state=0)


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
@pytest.mark.parametrize("estimator", _combinations(), ids=str)
def test_lssvm(estimator):
    assert _failures(estimator) == []


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
