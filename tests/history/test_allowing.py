# SPDX-License-Identifier: BSD-3-Clause
"""What may change without a fault can be set after the learning, and nothing is learnt again."""

import copy

import numpy as np
import pytest

from sklvalve.history import Allowance, ValveHistory
from sklvalve.recording import InputError


def test_an_allowance_widens_what_is_expected_as_if_it_had_been_given_first(learnt, before):
    wide = Allowance(capacity=0.05)
    other = copy.deepcopy(learnt).allowing(wide)
    at = other.prior_.names.index("capacity")
    assert other.prior_.covariance[at, at] > 4.0 * learnt.prior_.covariance[at, at]
    first = ValveHistory(allowance=wide).fit(before)
    np.testing.assert_allclose(other.prior_.mean, first.prior_.mean)
    np.testing.assert_allclose(other.prior_.covariance, first.prior_.covariance)
    again = other.allowing(None)
    np.testing.assert_allclose(again.prior_.covariance, learnt.prior_.covariance)


@pytest.mark.parametrize("wrong", [0.01, Allowance(trim=0.0)])
def test_what_is_no_allowance_changes_nothing(learnt, wrong):
    with pytest.raises(InputError, match="allowance"):
        learnt.allowing(wrong)
    assert learnt.allowance is None
