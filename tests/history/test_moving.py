# SPDX-License-Identifier: BSD-3-Clause
"""How far a parameter may go is asked over a step that is felt."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.history.moving import moved_by, open_to
from sklvalve.simulation.parameters import Parameter, ParameterVector

LAG = Parameter("lag", "s", 0.02, 3.0, 0.03, spread=1.5, log=True)
GAIN = Parameter("gain", "1", 0.0, 2.0, 1.0, spread=0.1)
NOTHING = Parameter("nothing", "1", -1.0, 1.0, 0.0, spread=0.1)
SHAPE = np.sin(np.linspace(0.0, 6.0, 200))


class Bench:
    """A flow of span 1 that a lag moves by 5 % a second, and a gain by all of itself."""

    chain = SimpleNamespace(recording={"flow": np.linspace(0.0, 1.0, 200)})
    channels = ("flow",)
    vector = ParameterVector([LAG, GAIN, NOTHING])

    def predictions(self, z):
        values = self.vector.values(z)
        return {"flow": SHAPE * (values["gain"] + 0.05 * values["lag"])}


@pytest.fixture
def moves():
    bench = Bench()
    z = bench.vector.pack({})
    return moved_by(bench, z, bench.predictions(z))[:, 0]


def _rms(signal):
    return float(np.sqrt(np.mean(signal**2)))


def test_a_lag_that_is_short_now_is_felt_where_it_gets_long(moves):
    # its logarithm moves the flow by 0.05 x 0.03 s at this point: by 0.1 % of the span in a spread
    by_slope = 0.05 * 0.03 * _rms(SHAPE)
    assert _rms(moves[0]) > 2.0 * by_slope
    # and one spread of 1.5 further the lag is at 0.13 s, three further at its bound
    step = np.log(3.0 / 0.03)
    assert _rms(moves[0]) <= 0.05 * (3.0 - 0.03) / step * _rms(SHAPE) * 1.01


def test_what_moves_in_proportion_has_the_same_slope_over_any_step(moves):
    np.testing.assert_allclose(moves[1], 0.1 * SHAPE, rtol=0.01, atol=1e-9)


def test_what_moves_nothing_has_none(moves):
    assert not moves[2].any()


def test_open_is_the_spread_of_the_sheet_or_the_bounds():
    assert open_to(LAG) == 1.5
    assert open_to(Parameter("free", "1", 0.0, 2.0, 1.0)) == pytest.approx(0.5)
    assert open_to(Parameter("rate", "1/s", 0.1, 9.0, 1.0, log=True)) == 1.0
