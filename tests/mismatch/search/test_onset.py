# SPDX-License-Identifier: BSD-3-Clause
"""What the times of an effect cost: each is summed over the rows at which it may lie."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import SWITCH_PENALTY, Term, complexity_penalty
from sklvalve.mismatch.search.onset import penalty_with_times
from sklvalve.simulation.noise import NoiseModel

N = 400
CLOGGING, DRIFT = (next(e for e in CATALOGUE if e.key == key) for key in ("clogging", "flow_meter_drift"))


class _Bench:
    """A flow that differs by `size` in the rows where `acts`, in white noise; so does the effect."""

    def __init__(self, acts, size=1.0, noise=None):
        self.recording = range(N)
        self.flow = size * np.asarray(acts, dtype=float)
        self.noise = {"flow": noise or SimpleNamespace(whiten=lambda left: left, pieces=[])}
        self.size = size

    def channels_touched(self, effect):
        return ("flow",)

    def simulate(self, terms, values):
        return SimpleNamespace(terms=tuple(terms))

    def residuals(self, model):
        return {"flow": self.flow - self.size * bool(model.terms)}


def price(bench, term):
    """Of the times of a term: what it must earn beyond what it would without them."""
    model = SimpleNamespace(terms=(term,), values={}, chain=SimpleNamespace(clock=np.arange(float(N))))
    return penalty_with_times(bench, model, term) - complexity_penalty(bench, Term(term.effect))


def acting(*rows):
    state = np.zeros(N, dtype=bool)
    for row in rows:
        state[row:] = ~state[row:]
    return state


def test_without_an_onset_there_is_nothing_to_sum_over():
    assert price(_Bench(acting(0)), Term(CLOGGING)) == 0.0


def test_what_grows_keeps_the_price_of_one_row():
    assert price(_Bench(acting(100)), Term(DRIFT, 100.0)) == SWITCH_PENALTY


def test_an_onset_that_every_row_tells_costs_one_of_all_rows():
    assert price(_Bench(acting(100), 30.0), Term(CLOGGING, 100.0)) == pytest.approx(np.log(N), abs=1e-6)


def test_an_onset_that_no_row_tells_costs_nothing():
    assert price(_Bench(acting(100), 1e-6), Term(CLOGGING, 100.0)) == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("size", [0.05, 0.2, 1.0])
def test_the_price_is_that_of_all_onsets_together(size):
    bench = _Bench(acting(150), size)
    left = [bench.flow - size * acting(k) for k in range(N + 1)]
    # the loss of a row, square near zero and linear beyond three deviations
    losses = np.array([np.sum(9.0 * (np.sqrt(1.0 + (each / 3.0) ** 2) - 1.0)) for each in left])
    together = np.log(N) - np.log(np.sum(np.exp(losses.min() - losses)))
    assert price(bench, Term(CLOGGING, 150.0)) == pytest.approx(together, abs=1e-9)


def test_a_stop_costs_what_an_onset_does():
    ends = _Bench(acting(250), 0.3)
    spell = price(_Bench(acting(100, 250), 0.3), Term(CLOGGING, 100.0, (250.0,)))
    alone = price(ends, Term(CLOGGING, 250.0))
    # each lies between its neighbours; those are too far to matter
    assert spell == pytest.approx(2.0 * alone, abs=0.01)


@given(st.integers(20, 380), st.floats(0.01, 5.0))
def test_it_never_costs_more_than_one_of_all_rows_nor_less_than_nothing(row, size):
    found = price(_Bench(acting(row), size), Term(CLOGGING, float(row)))
    assert -0.01 <= found <= SWITCH_PENALTY


@pytest.mark.parametrize("size", [0.8, 1.6])
def test_beside_a_wander_an_onset_and_a_stop_cost_what_all_rows_say(size):
    noise = NoiseModel(np.full(N, 0.05), np.ones(N), 1.0, 1e-9, 300.0, 10.0, sensor=0.05)
    bench = _Bench(acting(100, 250), size, noise)
    bench.flow += np.random.default_rng(5).normal(0.0, 0.2, N)

    def cost(*acts):
        """Of one time that lies at any of some rows, the effect acting so."""
        white = [noise.whiten(bench.flow - size * each) for each in acts]
        losses = np.array([np.sum(9.0 * (np.sqrt(1.0 + (each / 3.0) ** 2) - 1.0)) for each in white])
        return np.log(N) - np.log(np.sum(np.exp(losses.min() - losses)))

    rows = np.arange(N)
    begins = cost(*((rows >= k) & (rows < 250) for k in range(251)))
    stops = cost(*((rows >= 100) & (rows < k) for k in range(100, N + 1)))
    assert price(bench, Term(CLOGGING, 100.0, (250.0,))) == pytest.approx(begins + stops, abs=0.3)
