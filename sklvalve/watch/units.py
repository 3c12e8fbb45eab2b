# SPDX-License-Identifier: BSD-3-Clause
"""A flow that comes in another unit from some day on: no fault of the valve, and not to be taken for one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording import Recording
from sklvalve.recording.units import UNITS, to_si

# how near to the ratio of two units a flow must be, relative; and how far from its own
_NEAR, _FAR = 0.05, 0.3
# rows with less of the largest simulated flow tell no ratio
_LEAST = 0.1


def other_unit(recording: Recording, simulated: NDArray) -> str:
    """Say that a flow is recorded in another unit than it was, where nothing else fits as well.

    Parameters
    ----------
    recording : Recording
    simulated : ndarray of shape (n,)
        Flow that the valve had by its history [SI].

    Returns
    -------
    sentence : str
        Empty where the unit is the one it was.
    """
    flow = recording["flow"]
    told = np.isfinite(flow) & (simulated > _LEAST * np.nanmax(simulated))
    if told.sum() < len(flow) // 10 or not (flow[told] > 0.0).all():
        return ""
    ratio = float(np.median(np.log(flow[told] / simulated[told])))
    if abs(ratio) < _FAR:
        return ""
    signal = recording.signal("flow")
    own = float(to_si(1.0, signal.unit, signal.quantity))
    for unit in UNITS[signal.quantity]:
        there = np.log(own / float(to_si(1.0, unit, signal.quantity)))
        if abs(ratio - there) < _NEAR:
            return (
                f"the flow reads {np.exp(ratio):.3g} times what the valve passed before, as values in {unit} "
                f"read in {signal.unit} do; export it in {signal.unit}"
            )
    return ""
