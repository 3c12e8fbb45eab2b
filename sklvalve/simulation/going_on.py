# SPDX-License-Identifier: BSD-3-Clause
"""Carry a drifting effect over into a later recording."""

import warnings

from sklvalve.mechanism import ValidityWarning
from sklvalve.simulation.chain import clock_of


def going_on(effects, onsets, seen, recording):
    """Onsets of effects in a recording, those that grow from the first row on included.

    A drift that was there from the first row of the recording it was found in has gathered something by the
    next one. It is followed for as long again as it was seen; beyond that, or on another clock, nobody knows
    what it has come to, and it is counted from the recording's own first row.

    Parameters
    ----------
    effects : sequence of Effect
    onsets : dict or None
        Effect key -> time from which on it acts [s, absolute].
    seen : tuple of float or None
        First and last time of the recording that the effects were fitted to [s, absolute].
    recording : Recording
        The one to be simulated.

    Returns
    -------
    onsets : dict

    Warns
    -----
    ValidityWarning
        Where something that grows is counted anew.
    """
    onsets = dict(onsets or {})
    growing = [e for e in effects if e.grows]
    if not growing or seen is None:
        return onsets
    first, last = seen
    begins = float(clock_of(recording)[0])
    if begins <= first:
        return onsets
    if begins <= last + (last - first):
        return onsets | {e.key: onsets.get(e.key, first) for e in growing}
    for effect in growing:
        # an onset before all rows of this recording is one before its first row
        onsets.pop(effect.key, None)
    names = ", ".join(e.name for e in growing)
    later, took = (begins - last) / 3600.0, (last - first) / 3600.0
    warnings.warn(
        f"{names}: this recording begins {later:.3g} h after the end of the one that showed it, which took "
        f"{took:.3g} h; what has grown by then is not known, and is counted from its first row",
        ValidityWarning,
        stacklevel=3,
    )
    return onsets
