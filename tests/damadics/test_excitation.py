# SPDX-License-Identifier: BSD-3-Clause
"""What drives the actuator: a gap or a wrong unit is told, and not marched on with."""

import numpy as np
import pytest

from sklvalve.damadics import ActuatorSimulator
from sklvalve.damadics.excitation import Recorded, standard

QUIET = ActuatorSimulator(noise=False)
HELD = {"CV": 0.5, "P1": 3.5e6, "P2": 2.6e6, "T1": 43.0}


@pytest.mark.parametrize("name", ["CV", "P1", "P2", "T1", "Pz"])
@pytest.mark.parametrize("gap", [np.nan, np.inf, -np.inf])
def test_a_gap_is_refused_with_its_time(name, gap):
    def drivers(t):
        return (
            HELD | {"Pz": 6e5} | {name: np.where((t >= 70.0) & (t < 71.0), gap, (HELD | {"Pz": 6e5})[name])}
        )

    with pytest.raises(ValueError, match=f"{name} must be finite everywhere, got .* at 70 s; fill its gaps"):
        QUIET.simulate(90.0, drivers)
    # nothing is wrong with what comes before
    QUIET.simulate(60.0, drivers)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"CV": 60.0}, r"CV must lie in \[-0\.1, 1\.1\], .*divide percents by 100, got 60 at 0 s"),
        ({"CV": 1.5}, r"CV must lie in \[-0\.1, 1\.1\]"),
        ({"CV": -0.2}, r"CV must lie in \[-0\.1, 1\.1\]"),
        ({"P1": 3.5e9}, r"P1 must lie in .* in pascals, got 3\.5e\+09"),
        ({"P2": -1e6}, "P2 must lie in .* in pascals"),
        ({"T1": 316.0}, "T1 must lie in .* in degrees Celsius, got 316"),
        ({"Pz": 6e8}, "Pz must lie in .* in pascals"),
    ],
)
def test_another_unit_is_refused(wrong, message):
    with pytest.raises(ValueError, match=message):
        QUIET.simulate(10.0, lambda t: HELD | wrong)
    with pytest.raises(ValueError, match=message):
        QUIET.simulate(10.0, Recorded(np.array([0.0, 10.0]), HELD | wrong))


@pytest.mark.parametrize(("command", "shown"), [(1.09, 1.0), (-0.05, 0.0), (0.4, 0.4)])
def test_a_command_is_shown_within_its_span(command, shown):
    run = QUIET.simulate(60.0, lambda t: HELD | {"CV": command})
    assert (run["CV"] == shown).all()


def test_what_is_no_excitation_is_told():
    for wrong in (None, 3, lambda t: 0.5):
        with pytest.raises(ValueError, match="excitation must be a function of times that returns a dict"):
            QUIET.simulate(10.0, wrong)


def test_the_standard_one_is_within_all_limits():
    run = QUIET.simulate(200.0, standard)
    np.testing.assert_allclose(run["CV"], standard(run["t"])["CV"], rtol=1e-12)
