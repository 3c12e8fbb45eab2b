# SPDX-License-Identifier: BSD-3-Clause
"""Dead bands of a historian: for how long one held a signal, and how far off a held value may be."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sklvalve.recording.recording import Recording


class DeadBand(NamedTuple):
    """A stretch of time in which a value was written only when the signal had left the last one by a band.

    Parameters
    ----------
    begins, ends : float
        First and last moment of it, on the recording's clock [s].
    size : float
        How far the signal may be from the value that stands, in the signal's SI unit.
    """

    begins: float
    ends: float
    size: float


def band_of(recording: "Recording", role: str) -> NDArray[np.float64]:
    """How far each row's true value may be from the one held.

    Parameters
    ----------
    recording : Recording
    role : str

    Returns
    -------
    band : ndarray of shape (n,)
        In the signal's SI unit; 0 where every value was written, or none was said to be left out.
    """
    band = np.zeros(len(recording))
    for begins, ends, size in recording.bands.get(role, ()):
        inside = (recording.time >= begins) & (recording.time <= ends)
        band[inside] = np.maximum(band[inside], size)
    return band


def step_of(recording: "Recording", role: str) -> float:
    """Step in which a signal is known: of its reading, or the largest band in which a historian held it.

    A value held within a band is known no better than one read in steps of it.

    Parameters
    ----------
    recording : Recording
    role : str

    Returns
    -------
    step : float
        In the signal's SI unit; 0 where all values are equal.
    """
    return max(recording.resolution(role), float(band_of(recording, role).max(initial=0.0)))


def flow_moved_by(recording: "Recording", change: float) -> float:
    """Share of the flow that a change of one pressure moves: half its share of the drop, as with its root.

    Parameters
    ----------
    recording : Recording
    change : float
        Of either pressure [Pa].

    Returns
    -------
    share : float
        Of the flow [1]; infinite where the drop is not known or none is left.
    """
    if "p1" not in recording or "p2" not in recording:
        return np.inf
    drops = np.abs(recording["p1"] - recording["p2"])
    drops = drops[np.isfinite(drops)]
    drop = float(np.median(drops)) if len(drops) else 0.0
    return 0.5 * change / drop if drop > 0.0 else np.inf
