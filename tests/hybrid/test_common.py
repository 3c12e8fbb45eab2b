# SPDX-License-Identifier: BSD-3-Clause
"""scikit-learn's estimator checks, without exclusions."""

import numpy as np
import pytest
from sklearn.ensemble import HistGradientBoostingRegressor
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.utils.estimator_checks import (
    check_dataframe_column_names_consistency,
    check_param_validation,
    parametrize_with_checks,
)

from sklvalve.hybrid import ParallelHybridRegressor, SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor
from sklvalve.mechanism import ValveMechanismTransformer
from tests.hybrid.mechanisms import Gain, SensitiveGain


class ValveAboveZero(ValveMechanismTransformer):
    """The checks draw their data around zero, and no pressure is below zero absolute."""

    def _rows(self, X, warn=None):
        return super()._rows(np.abs(X), warn)


VALVE = ValveAboveZero(opening=0, p1=0, p2=0, kv_rated=1.0, warn=False)

INSTANCES = [
    SeriesHybridRegressor(Gain(), LSSVMRegressor()),
    SeriesHybridRegressor(Gain()),
    SeriesHybridRegressor(SensitiveGain(), LSSVMRegressor("linear"), sensitivity_weights=False),
    SeriesHybridRegressor(SensitiveGain()),
    SeriesHybridRegressor(SensitiveGain(), ParallelHybridRegressor(Ridge(), LSSVMRegressor())),
    ParallelHybridRegressor(Ridge(), LSSVMRegressor()),
    ParallelHybridRegressor(LinearRegression()),
    ParallelHybridRegressor(Gain(), LSSVMRegressor()),
    ParallelHybridRegressor(Gain(), LSSVMRegressor(), parameter=1.5),
    ParallelHybridRegressor(VALVE, LSSVMRegressor()),
    ParallelHybridRegressor(SeriesHybridRegressor(Gain(), Ridge()), LSSVMRegressor()),
]


@parametrize_with_checks(INSTANCES)
def test_estimator_checks(estimator, check):
    check(estimator)


@pytest.mark.parametrize("check", [check_dataframe_column_names_consistency, check_param_validation])
@pytest.mark.parametrize(
    "estimator",
    [
        SeriesHybridRegressor(SensitiveGain(0), LSSVMRegressor()),
        ParallelHybridRegressor(Ridge(), HistGradientBoostingRegressor(max_iter=2)),
    ],
)
def test_checks_outside_the_suite(estimator, check):
    check(type(estimator).__name__, estimator)
