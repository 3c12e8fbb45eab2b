# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a later recording, of the parts that the valve's history has it of."""

import numpy as np
import pytest

from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.inference.calibrating import calibrated

ROWS = 300


@pytest.fixture(scope="module")
def throttled(learnt, after):
    """The stretch of `after` with the least flow, its problem beside the history, and the calibration."""
    highest = [np.nanmax(after["flow"][k : k + ROWS]) for k in range(0, len(after) - ROWS, 20)]
    first = 20 * int(np.argmin(highest))
    recording = after.slice(first, first + ROWS)
    return calibrated(prepared_problem(recording, None, None, history=learnt))


def test_what_the_simulation_gets_wrong_is_that_of_the_history(throttled, learnt):
    problem, _ = throttled
    assert problem.spans["flow"] < 0.8 * learnt.spans_["flow"]
    assert problem.noise["flow"].parts.inadequacy == learnt.noise_parts("flow").inadequacy


def test_healthy_rows_are_as_noisy_as_the_history_however_small_their_flow(throttled):
    problem, nominal = throttled
    left = problem.residuals(nominal)["flow"]
    white = problem.noise["flow"].whiten(left)
    # louder than foreseen would be taken for an effect; a tenth of that hides one
    assert 0.3 < np.sqrt(np.mean(white**2)) < 1.2
