# SPDX-License-Identifier: BSD-3-Clause
"""Sign of the process gain, by the controller."""

import numpy as np
import pytest

from benchmarks.loop_plant import draw_loop
from sklvalve.mismatch.loop.controller import process_gain_sign


@pytest.mark.parametrize("kind", ["flow", "pressure", "level"])
@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("seed", [5, 6, 7])
def test_a_controller_that_raises_the_command_needs_a_positive_process(kind, known, seed):
    drawn = draw_loop(seed, kind, "setpoint" if known else "upsets")
    setpoint = drawn.setpoint if known else None
    told = process_gain_sign(drawn.command, drawn.process_value, setpoint)
    assert told.sign == 1
    turned = process_gain_sign(-drawn.command, drawn.process_value, setpoint)
    assert (turned.sign, turned.sure) == (-1, told.sure)


def test_units_do_not_matter():
    drawn = draw_loop(5, "level", "upsets")
    told = process_gain_sign(drawn.command, drawn.process_value)
    assert told.sure
    assert process_gain_sign(drawn.command, 1e-7 * drawn.process_value + 40.0) == told
    assert process_gain_sign(drawn.command, 1e6 * drawn.process_value) == told


@pytest.mark.parametrize("kind", ["follows at once", "independent", "constant"])
def test_without_a_controller_nothing_is_sure(kind):
    rng = np.random.default_rng(0)
    command = 0.5 + 0.05 * np.cumsum(rng.standard_normal(800)) / 30.0
    values = {
        "follows at once": command + 1e-4 * rng.standard_normal(800),
        "independent": rng.standard_normal(800),
        "constant": np.ones(800),
    }
    assert not process_gain_sign(command, values[kind]).sure


def test_an_exact_controller_is_sure():
    rng = np.random.default_rng(1)
    error = np.cumsum(rng.standard_normal(500)) * 0.01
    command = 0.5 + 0.1 * error + 0.01 * (np.cumsum(error) - 0.5 * error)
    told = process_gain_sign(command, -error, np.zeros(500))
    assert told.sure
    assert told.sign == 1
