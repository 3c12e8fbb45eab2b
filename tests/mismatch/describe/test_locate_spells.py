# SPDX-License-Identifier: BSD-3-Clause
"""When something acts: onsets, spells and growth, and the intervals of their moments."""

import numpy as np
import pytest

from sklvalve.mismatch.describe import episodes
from sklvalve.mismatch.describe.episodes import Evidence, growing_time_profile, time_profile_of
from sklvalve.simulation.noise import NoiseModel

ROWS = 1500
NOISE = NoiseModel(np.full(ROWS, 1.0), np.ones(ROWS), 5.0, 0.2, 300.0, 0.2)


def evidence(strength, size=3.0, seed=0):
    """A change whose own signal swings, with this strength in each row."""
    rng = np.random.default_rng(seed)
    change = size * np.abs(np.sin(np.arange(ROWS) / 25.0)) + 0.3 * size
    wander = 0.45 * np.cumsum(rng.standard_normal(ROWS)) / 30.0
    noise = rng.standard_normal(ROWS) + wander - wander.mean()
    left = noise + change * strength
    return Evidence({"flow": NOISE}, {"flow": left}, {"flow": left - change}, {"flow": noise})


def rows(*episodes, of=ROWS):
    acts = np.zeros(of)
    for begin, end in episodes:
        acts[begin:end] = 1.0
    return acts


def since(row):
    """Rows from one on, as the search has an effect act."""
    return np.arange(ROWS) >= row


def test_from_the_start_stays_from_the_start():
    time_profile = time_profile_of(evidence(rows((0, ROWS))), since(0))
    assert time_profile.kind == "throughout"
    assert time_profile.episodes == [(0, ROWS)]
    assert time_profile.ranges == [(None, None)]


@pytest.mark.parametrize("size", [0.7, 2.0, 6.0])
def test_interval_of_an_onset_covers(size):
    held, widths = 0, []
    for seed in range(30):
        onset = 200 + 37 * seed
        time_profile = time_profile_of(evidence(rows((onset, ROWS)), size, seed), since(onset))
        assert time_profile.kind == "from an onset on"
        low, high = time_profile.ranges[0][0]
        held += low <= onset <= high
        widths.append(high - low)
    # 95 % of 30; the chance of fewer than 25 is one in 500
    assert held >= 25
    # and a larger effect says more
    assert np.median(widths) < {0.7: 700, 2.0: 60, 6.0: 25}[size]


def test_end_and_spells_are_found_with_intervals():
    true = [(300, 600), (900, 1200)]
    time_profile = time_profile_of(evidence(rows(*true)), since(300))
    assert time_profile.kind == "in spells"
    assert len(time_profile.episodes) == 2
    for spell, ranges, told in zip(time_profile.episodes, time_profile.ranges, true, strict=True):
        for moment, (low, high), was in zip(spell, ranges, told, strict=True):
            assert low <= moment <= high
            assert abs(moment - was) <= 15


def test_the_cost_itself_has_the_last_word(monkeypatch):
    # to second order a change as large as this one may seem to act throughout
    made = evidence(rows((700, ROWS)))
    assert time_profile_of(made, since(700)).episodes == [(700, ROWS)]
    monkeypatch.setattr(
        episodes, "_switched", lambda square, pull, blocks, complexity_penalty: np.ones_like(blocks)
    )
    time_profile = time_profile_of(made, since(700))
    assert (time_profile.kind, time_profile.episodes) == ("from an onset on", [(700, ROWS)])
    low, high = time_profile.ranges[0][0]
    assert low <= 700 <= high
    # where the cost bears it out the quadratic is followed
    assert time_profile_of(evidence(rows((0, ROWS))), since(700)).kind == "throughout"


def test_a_strength_that_is_somewhat_wrong_makes_no_spells():
    # the model of an effect is right to some 15 %: half its size is not needed to be far from nought
    strength = 1.0 + 0.25 * np.sin(np.arange(ROWS) / 80.0)
    time_profile = time_profile_of(evidence(strength, 4.0), since(0))
    assert time_profile.kind == "throughout"


def test_growth_begins_within_its_interval():
    held = sized = 0
    for seed in range(12):
        onset = 300 + 40 * seed
        grown = np.maximum(np.arange(ROWS) - onset, 0.0)
        rng = np.random.default_rng(seed)
        noise = rng.standard_normal(ROWS)
        slope = 6.0 / ROWS
        left = noise + slope * grown
        made = Evidence(
            {"flow": NOISE},
            {"flow": left},
            {"flow": left - slope * np.arange(ROWS)},
            {"flow": noise},
            # the calibration may answer with the level
            NOISE.whiten(np.ones(ROWS))[:, None],
        )
        time_profile = growing_time_profile(
            made, np.arange(ROWS), since(onset + 60), np.linspace(0, 0.95 * ROWS, 61)
        )
        assert time_profile.kind == "growing"
        low, high = time_profile.ranges[0][0]
        held += low <= onset <= high
        assert high - low < 0.8 * ROWS
        # so do the rates that go with the interval, which are larger the later it began
        slow, fast = time_profile.sizes
        sized += slow <= 1.0 <= fast
        assert 0.5 < slow < fast < 2.0
    assert held >= 10
    assert sized >= 10


def test_spells_of_the_search_stay_however_short():
    many, length = 6000, 45
    true = [(begin, begin + length) for begin in (500, 1900, 3300, 4700)]
    noise = NoiseModel(np.full(many, 1.0), np.ones(many), 5.0, 0.2, 300.0, 0.2)
    quiet = np.random.default_rng(0).standard_normal(many)
    acts = rows(*true, of=many)
    left, change = quiet + 2.0 * acts, np.full(many, 2.0)
    made = Evidence({"flow": noise}, {"flow": left}, {"flow": left - change}, {"flow": quiet})
    time_profile = time_profile_of(made, acts > 0.0)
    assert (time_profile.kind, time_profile.episodes) == ("in spells", true)
    # each is half of a block of the record that is looked through
    assert length < many / 64


def test_growth_goes_by_the_clock_and_not_by_rows():
    """Two recordings a week apart: what grows went on growing between them."""
    clock = np.arange(ROWS) + np.where(np.arange(ROWS) >= 750, 6e5, 0.0)
    onset = 600
    noise = np.random.default_rng(1).standard_normal(ROWS)
    rate = 20.0 / clock[-1]
    left = noise + rate * np.maximum(clock - clock[onset], 0.0)
    made = Evidence({"flow": NOISE}, {"flow": left}, {"flow": left - rate * clock}, {"flow": noise})
    time_profile = growing_time_profile(made, clock, since(onset), np.linspace(0, 0.95 * ROWS, 61))
    # whenever in the first recording it began, the week between says how fast it grows
    assert time_profile.sizes == pytest.approx((1.0, 1.0), abs=0.05)
    low, high = time_profile.ranges[0][0]
    assert low <= onset <= high
