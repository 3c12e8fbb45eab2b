# SPDX-License-Identifier: BSD-3-Clause
"""A trim, and the moments at which effects begin, as plain data and back."""

import numpy as np

from sklvalve.simulation.given_trim import GivenTrim
from sklvalve.simulation.tolerance import Tolerance
from sklvalve.simulation.trim import LearntTrim, SheetTrim


def state_of_trim(trim):
    """A trim but for its sheet, as plain numbers and arrays.

    Parameters
    ----------
    trim : SheetTrim, LearntTrim or GivenTrim

    Returns
    -------
    state : dict
        ``knots`` [1] of a learnt curve, else None; ``rated`` [m3/h]; ``given``, whether the user's simulation
        gave it; ``curve`` of that, shape (401,) [m3/h], else None.
    """
    return {
        "knots": None if trim.known else trim.knots,
        "rated": float(trim.rated),
        "given": isinstance(trim, GivenTrim),
        "curve": getattr(trim, "curve", None),
    }


def trim_of_state(valve, state, tolerance=None):
    """Trim of what `state_of_trim` gave.

    Parameters
    ----------
    valve : Valve
        Its sheet.
    state : dict
    tolerance : Tolerance, default=None
        How far the trim may lie from the sheet; of use to fits only.

    Returns
    -------
    trim : SheetTrim, LearntTrim or GivenTrim
    """
    rated, knots = state["rated"], state["knots"]
    if state.get("given"):
        return GivenTrim(rated, state["curve"], tolerance)
    if knots is None:
        return SheetTrim(valve, tolerance or Tolerance(), rated)
    return LearntTrim(None, rated, knots=knots)


def onsets_of_state(onsets):
    """Onsets read back from a file; several times of one effect as a tuple, as free runs remember them.

    Parameters
    ----------
    onsets : dict
        Effect key -> time, or times, from which on it acts [s].

    Returns
    -------
    onsets : dict
    """
    return {
        key: tuple(times) if isinstance(times, list | np.ndarray) else times for key, times in onsets.items()
    }
