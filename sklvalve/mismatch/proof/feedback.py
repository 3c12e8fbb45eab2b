# SPDX-License-Identifier: BSD-3-Clause
"""Whether a controller answers the value: then its command holds the value's own past."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sklvalve.recording import Recording
from sklvalve.recording.gaps import filled

#: Log likelihood that the value must add to a forecast of the driver: seven coefficients that mean nothing
#: add 12 nats in one of a thousand recordings (chi-squared law).
ANSWERS_FROM = 12.0
_DRIVER_LAGS = 4
# rows over which the residual is averaged before it is held against the driver's next step
_WINDOWS = (1, 2, 4, 10, 30, 100)


def driver_of(recording: Recording, channel: str) -> str:
    """Role that drives a channel: the opening a flow where it is recorded, else the command."""
    return "command" if channel == "opening" or "opening" not in recording else "opening"


def answers(driver: np.ndarray, value: np.ndarray, simulated: np.ndarray) -> float:
    r"""Log likelihood that a value adds to a forecast of its driver's next step [nats].

    .. math:: \Delta u_t = \sum_k a_k \Delta u_{t-k} + b\, u_{t-1} + \sum_w c_w\, \bar r_{t-1, w}
              + \sum_{k \ge 1} d_k y_{t-k} - g\, y_t + e_t, \quad g \ge 0

    A driver that nobody moves because of the value has :math:`c = d = g = 0`. Where they add something there
    is feedback (Caines and Chan, IEEE Transactions on Automatic Control 20 (1975) 498, doi
    10.1109/TAC.1975.1101008), and a model that reads the driver backwards predicts the value by what the
    controller made of it. The value of the same row counts only with the sign of a controller: a valve that
    answers its command at once has the other one.

    Parameters
    ----------
    driver : ndarray of shape (n,)
        Command or opening.
    value : ndarray of shape (n,)
        It rises with its driver.
    simulated : ndarray of shape (n,)
        What is known of the value from the driver: the residual :math:`r` is what is left.

    Returns
    -------
    nats : float
        Compared with `ANSWERS_FROM`; zero for a driver at rest.
    """
    driver, residual, value = filled(driver), filled(value - simulated), filled(value)
    first = max(_WINDOWS) + 1
    if len(driver) < 2 * first or np.ptp(driver) == 0.0 or np.ptp(residual) == 0.0:
        return 0.0
    rows = np.arange(first, len(driver))
    steps = np.diff(driver, prepend=driver[0])
    moves = steps[rows]
    of_driver = [np.ones(len(rows)), driver[rows - 1], *(steps[rows - k] for k in range(1, _DRIVER_LAGS + 1))]
    sums = np.concatenate([[0.0], np.cumsum(residual)])
    past = [*of_driver, *((sums[rows] - sums[rows - w]) / w for w in _WINDOWS)]
    before = [*past, value[rows - 1], value[rows - 2]]
    nats = _gain(of_driver, past, moves)[0]
    now, slope = _gain(before, [*before, value[rows]], moves)
    return nats + (now if slope < 0.0 else 0.0)


def _gain(few: Sequence[np.ndarray], many: Sequence[np.ndarray], moves: np.ndarray) -> tuple[float, float]:
    """Log likelihood that more columns add, and the coefficient of the last of them."""
    left, _ = _fitted(few, moves)
    with_all, last = _fitted(many, moves)
    if with_all <= 1e-24 * (moves @ moves):
        with_all = 1e-24 * max(left, moves @ moves)
    return float(0.5 * len(moves) * np.log(left / with_all)) if left > with_all else 0.0, last


def _fitted(columns: Sequence[np.ndarray], moves: np.ndarray) -> tuple[float, float]:
    design = np.column_stack(columns)
    scale = np.sqrt((design**2).sum(axis=0))
    scale = np.where(scale > 0.0, scale, 1.0)
    weights = np.linalg.lstsq(design / scale, moves, rcond=1e-10)[0]
    left = moves - (design / scale) @ weights
    return float(left @ left), float(weights[-1])
