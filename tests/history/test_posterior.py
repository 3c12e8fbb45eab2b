# SPDX-License-Identifier: BSD-3-Clause
"""What the windows of a history have in common, and how a valve changes between them."""

import numpy as np
import pytest

from sklvalve.history.posterior import FromSheet, Information, expected


def sheet(begin=(0.0, 0.0)):
    reach = (np.array([-4.0, 0.0]), np.array([4.0, 5.0]))
    return FromSheet(None, np.zeros(2), np.array([1.0, 0.5]), np.array(begin), reach)


def window(informed, pull):
    return Information(np.diag(informed), np.array(pull), np.eye(2))


def test_what_no_row_tells_of_stays_finite_however_it_is_pulled():
    # at its bound a parameter may be pulled where no row tells of it
    windows = [window([100.0, 0.0], [0.0, -1.6])]
    mean, covariance = expected(windows, sheet((0.0, 3.5)), np.diag([1e-3, 1.0]))
    assert np.isfinite(mean).all()
    assert np.isfinite(covariance).all()
    assert (np.linalg.eigvalsh(covariance) > 0.0).all()
    # its spread is at most that of its bounds
    assert covariance[1, 1] < 5.0**2 + 5.0


def test_windows_that_agree_are_known_better_than_one():
    one = window([100.0, 10.0], [0.0, 0.0])
    few, many = (expected([one] * n, sheet(), np.diag([1e-3, 1e-3]))[1] for n in (1, 9))
    assert many[0, 0] < few[0, 0]


def test_windows_that_lie_apart_say_that_the_valve_changes():
    alike = [window([100.0, 10.0], [0.0, 0.0])] * 6
    apart = [window([100.0, 10.0], [pull, 0.0]) for pull in (50.0, -50.0) * 3]
    of_alike, of_apart = (expected(w, sheet(), np.diag([1e-3, 1e-3]))[1] for w in (alike, apart))
    assert of_apart[0, 0] > 10.0 * of_alike[0, 0]
    assert of_apart[1, 1] == pytest.approx(of_alike[1, 1], rel=1e-6)
