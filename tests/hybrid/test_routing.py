# SPDX-License-Identifier: BSD-3-Clause
"""Weights and metadata on their way to the models inside."""

import numpy as np
import pytest
from sklearn import config_context
from sklearn.linear_model import LinearRegression, Ridge
from sklearn.neighbors import KNeighborsRegressor
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from sklvalve.hybrid import SeriesHybridRegressor
from sklvalve.lssvm import LSSVMRegressor
from tests.hybrid.mechanisms import Gain, SensitiveGain


@pytest.mark.parametrize(
    "regressor", [None, LSSVMRegressor(), make_pipeline(StandardScaler(), LSSVMRegressor())]
)
def test_weights_act_the_same_with_routing_on_and_off(regressor):
    rng = np.random.default_rng(0)
    X = rng.normal(size=(50, 2))
    y = np.sin(X[:, 1]) + 3
    weight = rng.uniform(0.1, 2, 50)
    off = SeriesHybridRegressor(SensitiveGain(), regressor).fit(X, y, sample_weight=weight).predict(X)
    with config_context(enable_metadata_routing=True):
        if isinstance(regressor, LSSVMRegressor):
            regressor = LSSVMRegressor().set_fit_request(sample_weight=True)
        elif regressor is not None:
            regressor = make_pipeline(
                StandardScaler().set_fit_request(sample_weight=True),
                LSSVMRegressor().set_fit_request(sample_weight=True),
            )
        model = SeriesHybridRegressor(SensitiveGain(), regressor)
        on = model.fit(X, y, sample_weight=weight).predict(X)
        plain = model.fit(X, y).predict(X)
    np.testing.assert_allclose(on, off, rtol=1e-10)
    assert not np.allclose(on, plain, rtol=1e-6)


def test_routing_says_when_nobody_asked_for_the_weights():
    X, y = np.arange(20.0)[:, None], np.arange(20.0)
    with config_context(enable_metadata_routing=True):
        with pytest.raises(ValueError, match="sample_weight"):
            SeriesHybridRegressor(Gain(), LSSVMRegressor()).fit(X, y, sample_weight=np.ones(20))
        refusing = LSSVMRegressor().set_fit_request(sample_weight=False)
        with pytest.raises(TypeError, match="not routed to any object"):
            SeriesHybridRegressor(Gain(), refusing).fit(X, y, sample_weight=np.ones(20))


@pytest.mark.parametrize("pipeline", [False, True])
def test_routing_without_a_request_switches_sensitivity_off_and_says_so(pipeline):
    rng = np.random.default_rng(0)
    X = rng.normal(scale=10.0, size=(50, 1))
    y = np.sin(X[:, 0]) + 3
    unweighted = SeriesHybridRegressor(SensitiveGain(), Ridge(), sensitivity_weights=False).fit(X, y)
    with config_context(enable_metadata_routing=True):
        regressor = make_pipeline(Ridge()) if pipeline else Ridge().set_fit_request(sample_weight=False)
        with pytest.warns(UserWarning, match="does not ask for sample_weight"):
            model = SeriesHybridRegressor(SensitiveGain(), regressor).fit(X, y)
        asking = Ridge().set_fit_request(sample_weight=True)
        weighted = SeriesHybridRegressor(SensitiveGain(), make_pipeline(asking) if pipeline else asking)
        weighted.fit(X, y)
        # a regressor without weights can do nothing about it: no word
        SeriesHybridRegressor(SensitiveGain(), KNeighborsRegressor()).fit(X, y)
    np.testing.assert_allclose(model.predict(X), unweighted.predict(X), rtol=1e-10)
    assert not np.allclose(model.predict(X), weighted.predict(X), rtol=1e-6)


def test_unknown_metadata_is_refused_without_routing():
    with pytest.raises(ValueError, match="groups"):
        SeriesHybridRegressor(Gain(), LinearRegression()).fit(np.ones((3, 1)), np.ones(3), groups=[1, 2, 3])
