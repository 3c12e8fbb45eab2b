# SPDX-License-Identifier: BSD-3-Clause
"""scikit-learn's estimator checks, without exclusions."""

import pytest
from sklearn.utils.estimator_checks import (
    check_dataframe_column_names_consistency,
    check_param_validation,
    parametrize_with_checks,
)

from sklvalve.lssvm import LSSVMRegressor, LSSVMRegressorCV
from sklvalve.lssvm.choice import SOLVERS

INSTANCES = [
    LSSVMRegressor(),
    LSSVMRegressor(bias="regularized"),
    LSSVMRegressor(bias="none"),
    LSSVMRegressor("linear"),
    LSSVMRegressor("poly", degree=2),
    LSSVMRegressor("polynomial", C=0.1, degree=1),
    LSSVMRegressor("laplacian", gamma=0.5),
    LSSVMRegressor("precomputed"),
    LSSVMRegressor("precomputed", solver="tiled"),
    LSSVMRegressorCV(),
    LSSVMRegressorCV("laplacian", cv=3, gammas=[0.1, 0.5]),
    LSSVMRegressorCV("linear", bias="regularized"),
    *(LSSVMRegressor(solver=solver) for solver in SOLVERS),
    *(LSSVMRegressor("laplacian", solver=solver, bias="regularized") for solver in SOLVERS),
    *(LSSVMRegressor("linear", solver=solver, bias="none") for solver in SOLVERS),
]


# The checks of a precomputed kernel pass matrices that are no kernel matrices; the estimator says so.
@pytest.mark.filterwarnings("ignore:The kernel matrix plus 1/C:scipy.linalg.LinAlgWarning")
@pytest.mark.filterwarnings("ignore:The LS-SVM equations are met only:scipy.linalg.LinAlgWarning")
@parametrize_with_checks(INSTANCES)
def test_estimator_checks(estimator, check):
    check(estimator)


@pytest.mark.parametrize("check", [check_dataframe_column_names_consistency, check_param_validation])
@pytest.mark.parametrize("estimator", [LSSVMRegressor(), LSSVMRegressorCV()])
def test_checks_outside_the_suite(check, estimator):
    check(type(estimator).__name__, estimator)
