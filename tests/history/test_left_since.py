# SPDX-License-Identifier: BSD-3-Clause
"""What a simulation leaves over beyond the noise of the history, in blocks of the length that shows it."""

from copy import copy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.data.preparation import prepared_problem
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.residual.since_history import left_since
from tests.history.plant import changed


def _left(recording, history):
    problem, nominal = calibrated(prepared_problem(recording, None, None, history=history))
    left = left_since(problem, problem.least_squares(nominal))
    return left, left.strength


@pytest.fixture(scope="module")
def healthy(learnt, after):
    return _left(after, learnt)


def _pulses(rows):
    """Ten rows in every hundred."""
    return (np.arange(rows) % 100 < 10).astype(float)


def _beat(rows):
    """To and fro in 60 rows, with a strength that comes and goes."""
    t = np.arange(rows)
    return np.sin(2.0 * np.pi * t / 60.0) * (1.0 + 0.5 * np.sin(2.0 * np.pi * t / 500.0))


def _wander(rows):
    walk = np.random.default_rng(3).normal(size=rows).cumsum()
    return (walk - walk.mean()) / walk.std()


def test_little_of_a_healthy_valve(healthy):
    left, strength = healthy
    assert strength < 2.5
    assert left.times < 1.5


@pytest.mark.parametrize(
    ("shape", "size", "longest"), [(_pulses, 0.03, 32), (_beat, 0.01, 64), (_wander, 0.01, 256)]
)
def test_what_has_no_equation_stands_out_in_blocks_of_its_own_length(
    learnt, after, healthy, shape, size, longest
):
    rows = len(after)
    left, strength = _left(
        changed(after, flow=after["flow"] + size * np.nanmax(after["flow"]) * shape(rows)), learnt
    )
    assert left.channel == "flow"
    assert strength > 4.0 > 1.5 * healthy[1]
    assert rows / longest - 1.0 <= left.many
    # of the noise it is told apart: what is beyond it is about as large as what was added
    beyond = np.sqrt(left.size**2 - left.allowed**2)
    assert 0.3 * size * np.std(shape(rows)) < beyond < 1.5 * size * np.std(shape(rows))


def test_a_trifle_is_not_strong_however_clear(learnt, after):
    problem, _ = calibrated(prepared_problem(after, None, None, history=learnt))
    size = 0.1 * problem.least("flow") * problem.spans["flow"]
    _, strength = _left(changed(after, flow=after["flow"] + size * _beat(len(after))), learnt)
    assert strength < 2.5


def test_nothing_is_said_of_rows_where_the_history_has_not_been(learnt, after):
    elsewhere = copy(learnt)
    elsewhere.range_ = SimpleNamespace(met=lambda recording, _: np.zeros(len(recording), dtype=bool))
    problem, nominal = calibrated(prepared_problem(after, None, None, history=learnt))
    assert left_since(problem, nominal) is not None
    assert left_since(replace(problem, history=elsewhere), nominal) is None


def test_without_a_history_there_is_nothing_to_compare(after):
    problem, nominal = calibrated(prepared_problem(after, None, None))
    assert left_since(problem, nominal) is None
