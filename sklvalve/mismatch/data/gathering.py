# SPDX-License-Identifier: BSD-3-Clause
"""What a finder is given, one recording or several of one valve, as one recording."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.recording import InputError, join_recordings
from sklvalve.simulation.given_columns import with_given
from sklvalve.simulation.simulation import as_recording

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from sklvalve.recording import Recording
    from sklvalve.simulation import ValveSimulation

# a stem and a lag forget within this time where they were before [s], and within as many rows
_FORGOTTEN, _FEWEST_FORGOTTEN = 40.0, 3
_CHANNELS = ("opening", "flow")


def gathered(
    X: Any, y: ArrayLike | None = None, *, simulation: ValveSimulation | None = None, external: Any = None
) -> Recording:
    """One recording of what a finder is given.

    Parameters
    ----------
    X : Recording, DataFrame with role names as columns, in SI, or list or tuple of these
    y : array-like of shape (n,) or None
        Flow [SI], where X is a single frame without it.
    simulation : ValveSimulation or None
        Whose sheet a frame takes.
    external : regressor or callable or None
        The user's own simulation.

    Returns
    -------
    recording : Recording
        Several are joined (`join_recordings`).

    Raises
    ------
    InputError
        If there is none, or several do not belong together.
    """
    valve = None if simulation is None else simulation.valve
    if not isinstance(X, (list, tuple)):
        return with_given(as_recording(X, y, valve), external)
    if y is not None:
        raise InputError("several recordings hold their own flow; give no y beside them")
    return join_recordings([with_given(as_recording(x, None, valve), external) for x in X])


def settled(recording: Recording) -> Recording:
    """A recording without the rows in which a simulation settles after each jump of the clock between pieces.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    recording : Recording
        The one given where it is in one piece.
    """
    starts = [low for low, _ in recording.spans]
    return recording if len(starts) == 1 else without_settling(recording, starts)


def without_settling(recording: Recording, starts: ArrayLike) -> Recording:
    """A recording whose opening and flow are gaps in the first rows from each start on, but the first.

    Parameters
    ----------
    recording : Recording
    starts : sequence of int
        Rising, the first of them 0.

    Returns
    -------
    recording : Recording
    """
    n = len(recording)
    starts = np.asarray(starts)
    begun = starts[np.searchsorted(starts, np.arange(n), side="right") - 1]
    early = recording.time - recording.time[begun] < _FORGOTTEN
    settling = (early | (np.arange(n) - begun < _FEWEST_FORGOTTEN)) & (begun > 0)
    signals = {
        role: np.where(settling, np.nan, values) if role in _CHANNELS else values
        for role, values in recording.signals.items()
    }
    return replace(recording, signals=signals)
