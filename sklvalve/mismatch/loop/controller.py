# SPDX-License-Identifier: BSD-3-Clause
"""Between what is measured and the command: a controller, which tells the sign of the process."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.mismatch.loop.constants import SURE_ACTION
from sklvalve.mismatch.loop.noise import FILTERS, whiten, whitened_level


@dataclass(frozen=True)
class GainSign:
    """Sign of a process gain.

    Parameters
    ----------
    sign : int
        1 where the controller raises the command when the value is too low, else -1.
    sure : bool
        Whether both actions of the controller are seen and tell the same sign.
    """

    sign: int
    sure: bool


def process_gain_sign(command: NDArray, value: NDArray, setpoint: NDArray | None = None) -> GainSign:
    r"""Sign of the process gain: that with which this controller can hold the loop.

    .. math:: u = K e + I \sum e + d, \quad e = w - y

    A controller with proportional and integral action has both of one sign, and a value that merely follows
    the command has not. The rest :math:`d` of the command is a wander under white noise, the likeliest of
    `FILTERS`: the law of a controller holds for levels whatever the rows, and for differences of rows only
    where it acts no faster than they come. Valid in closed loops: a value that answers a command and comes
    back by itself looks like a controller of the other sign.

    Parameters
    ----------
    command, value : ndarray of shape (n,)
        [fraction of travel; any unit]
    setpoint : ndarray of shape (n,), optional
        A constant one unless given [unit of the value].

    Returns
    -------
    gain_sign : GainSign
    """
    error = (value.mean() if setpoint is None else setpoint) - value
    # the sum at the middle of its last row, so that it has nothing of the proportional action
    columns = np.stack([error, np.cumsum(error) - 0.5 * error])
    columns /= np.maximum(columns.std(axis=1, keepdims=True), np.finfo(float).tiny)
    actions, scatter = min((_actions(command, columns, each) for each in FILTERS), key=lambda fit: fit[2])[:2]
    sure = bool(actions[0] * actions[1] > 0.0 and np.all(np.abs(actions) > SURE_ACTION * scatter))
    return GainSign(1 if actions[0] >= 0.0 else -1, sure)


def _actions(
    command: NDArray, columns: NDArray, noise_filter: tuple[float, float]
) -> tuple[NDArray, NDArray, float]:
    """Both actions of the controller under one noise, their standard errors, and the sum of squares left."""
    level = whitened_level(len(command), *noise_filter)[None]
    design = np.concatenate([whiten(columns, *noise_filter), level]).T
    target = whiten(command, *noise_filter)
    sizes = np.linalg.lstsq(design, target, rcond=None)[0]
    squares = float(np.sum((target - design @ sizes) ** 2))
    variances = np.diag(np.linalg.pinv(design.T @ design)) * squares / len(target)
    return sizes[:2], np.sqrt(variances[:2]), squares
