# SPDX-License-Identifier: BSD-3-Clause
"""What might have gone unnoticed where nothing was found."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.decide.detection_limits import _sizes, _value
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.result.known_effects import forms_of
from sklvalve.simulation import Tolerance


@pytest.fixture(scope="module")
def limits(found_healthy):
    return {limit["form"]: limit for limit in found_healthy.diagnosis_.to_dict()["detection_limits"]}


def test_a_limit_lies_around_no_effect_at_all(limits):
    assert {"seat_leakage", "backlash", "flow_meter_gain", "stiction", "sensor_lag"} <= set(limits)
    # to first order they are too small
    assert not {"inlet_pressure_bias", "outlet_pressure_bias"} & set(limits)
    for limit in limits.values():
        form = next(form for form in forms_of(limit["name"]) if form.key == limit["form"])
        declared = [q for q in form.parameters if q.name == limit["parameter"]]
        low = -np.inf if limit["low"] is None else limit["low"]
        high = np.inf if limit["high"] is None else limit["high"]
        assert low < high
        for quantity in declared:
            if quantity.null is not None and not (quantity.log and quantity.null == 0.0):
                assert low <= quantity.null <= high


CHANGES = {
    "flow_meter_gain": lambda r, size: {"flow": r["flow"] * (1.0 + size)},
    "flow_meter_bias": lambda r, size: {"flow": r["flow"] + size},
}


@pytest.mark.parametrize(
    ("form", "end"),
    [
        ("flow_meter_gain", "low"),
        ("flow_meter_bias", "high"),
    ],
)
def test_a_sensor_that_reads_wrong_is_noticed_beyond_its_limit(healthy, limits, form, end):
    limit = limits[form][end]
    for share, noticed in ((0.4, False), (3.0, True)):
        signals = {**healthy.signals, **CHANGES[form](healthy, share * limit)}
        found = MissingPhysicsFinder().fit(replace(healthy, signals=signals)).diagnosis_
        assert (found.verdict != "no_mismatch") == noticed
        if not noticed:
            # what is there, unnoticed, is within what is said to go unnoticed
            again = {each["form"]: each for each in found.to_dict()["detection_limits"]}[form]
            assert again["low"] <= share * limit <= again["high"]


def test_what_a_data_sheet_leaves_open_is_never_noticed(limits):
    # and what a simulation gets wrong of an effect's size
    open_to_it = (1.0 + SHARE_WRONG) * Tolerance().capacity
    assert limits["capacity_error"]["low"] <= -open_to_it
    assert limits["capacity_error"]["high"] >= open_to_it
    assert limits["backlash"]["high"] >= (1.0 + SHARE_WRONG) * Tolerance().play


def test_where_something_is_found_nothing_is_said_of_limits(found_leaking):
    assert found_leaking.diagnosis_.to_dict()["detection_limits"] == []


def test_where_no_effect_is_looked_for_nothing_is_said_of_limits(healthy):
    found = MissingPhysicsFinder(max_effects=0).fit(healthy).diagnosis_.to_dict()
    assert (found["verdict"], found["detection_limits"]) == ("no_mismatch", [])


def test_sizes_lie_on_both_sides_of_no_effect():
    at, middle = _sizes(Quantity("bias", "1", -0.5, 2.0, (0.1,)))
    assert at[middle] == 0.0
    assert (np.diff(at) > 0.0).all()
    assert_allclose([at[0], at[-1]], [-0.5, 2.0])
    ratio = Quantity("ratio", "1", 0.5, 8.0, (1.2,), log=True, null=1.0)
    at, middle = _sizes(ratio)
    assert_allclose([_value(ratio, x) for x in (at[0], at[middle], at[-1])], [0.5, 1.0, 8.0])
    # a gap that closes at no size that a logarithm has
    at, middle = _sizes(Quantity("width", "1", 0.002, 0.4, (0.02,), log=True))
    assert middle == 0
    assert_allclose(np.exp(at[[0, -1]]), [0.002, 0.4])
    # a limit of speed has no size at which it vanishes
    assert _sizes(Quantity("speed", "1/s", 0.001, 1.0, (0.1,), log=True, null=None))[1] is None
