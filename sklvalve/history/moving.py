# SPDX-License-Identifier: BSD-3-Clause
"""By how much a parameter moves the signals, over as much as the data sheet leaves open of it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sklvalve.simulation.calibration import spans_of
from sklvalve.simulation.fitting import Misfit
from sklvalve.simulation.parameters import Parameter

# rms that a change must move, share of a span, before it says how far a parameter may go
_FELT = 0.005
# steps by which a parameter is moved until that is felt, shares of what the sheet leaves open
_STEPS = (1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0, 2.0, 3.0)


def open_to(parameter: Parameter) -> float:
    """Spread that a data sheet leaves open, or bounds alone, in the numbers that an optimiser moves."""
    return parameter.spread or reach_of(parameter)


def reach_of(parameter: Parameter) -> float:
    """Spread that bounds alone leave open."""
    if parameter.log:
        return 1.0
    width = parameter.high - parameter.low
    return 0.25 * width if np.isfinite(width) else max(abs(parameter.start), 1e-12)


def moved_by(misfit: Misfit, z: np.ndarray, here: dict[str, np.ndarray]) -> np.ndarray:
    """Change of the channels by each scaled parameter, as share of their spans.

    A difference over a step that is felt, to the side that is felt more: a filter of 0.03 s that doubles
    moves nothing, and one of 2 s does. Its derivative would let it become the other.

    Parameters
    ----------
    misfit : Misfit
    z : ndarray of shape (m,)
    here : dict of str to ndarray of shape (n,)
        Signals at z.

    Returns
    -------
    moves : ndarray of shape (m, c, n)
        Rows that a simulation leaves open are 0.
    """
    return np.array(
        [
            max((_on_one_side(misfit, z, i, side, here) for side in (1.0, -1.0)), key=_rms)
            for i in range(len(misfit.vector))
        ]
    )


def _on_one_side(
    misfit: Misfit, z: np.ndarray, i: int, side: float, here: dict[str, np.ndarray]
) -> np.ndarray:
    """The same of one parameter (c, n), over the first step to one side that is felt, or the last one."""
    spans = spans_of(misfit.chain.recording, misfit.channels)
    change, step = np.zeros((len(misfit.channels), len(here[misfit.channels[0]]))), 1.0
    for there in _farther(misfit, z, i, side):
        signals, step = misfit.predictions(there), there[i] - z[i]
        change = np.array([np.nan_to_num((signals[c] - here[c]) / spans[c]) for c in misfit.channels])
        if _rms(change) >= _FELT:
            break
    return misfit.vector.scale[i] / step * change


def _farther(misfit: Misfit, z: np.ndarray, i: int, side: float) -> Iterator[np.ndarray]:
    """Points ever farther from one in one parameter, inside its bounds."""
    vector, last = misfit.vector, z[i]
    for step in _STEPS:
        there = z.copy()
        there[i] = np.clip(z[i] + side * step * open_to(vector.parameters[i]), vector.low[i], vector.high[i])
        if there[i] != last:
            last = there[i]
            yield there


def _rms(change: np.ndarray) -> float:
    """Of the channel that is moved more."""
    return float(np.sqrt(np.max(np.mean(change**2, axis=1))))
