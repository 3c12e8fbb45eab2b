# SPDX-License-Identifier: BSD-3-Clause
"""The p-value falls with the evidence and never claims more than is known."""

import numpy as np
import pytest

from sklvalve.mismatch.loop.stretch import evidence_of, p_value_of


@pytest.mark.parametrize("fast", [True, False])
def test_more_evidence_is_never_a_larger_p_value(fast):
    values = [p_value_of(evidence, fast) for evidence in np.linspace(-50.0, 100.0, 301)]
    assert (np.diff(values) <= 0.0).all()
    assert values[0] == pytest.approx(1.0)
    assert values[-1] == pytest.approx(1e-4)


def test_what_speaks_against_it_is_taken_off():
    assert evidence_of(30.0, 100.0) == 30.0
    assert evidence_of(30.0, -12.0) == 18.0
