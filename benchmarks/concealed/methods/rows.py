# SPDX-License-Identifier: BSD-3-Clause
"""Rows that a diagnosis speaks of, and how they overlap with those that are true."""

import numpy as np

from sklvalve.mismatch.describe.cells import direction_of_travel, rate_of_travel


def told_rows(content, recording, seconds, *, opening=None, pressure_ratio=None):
    """Rows of the regions that a diagnosis names, within its intervals; all of these where it names none.

    Parameters
    ----------
    content : dict
        As diagnosis.json; its ``location`` counts.
    recording : Recording
    seconds : ndarray of shape (n,)
        Times on the clock of the intervals [s].
    opening : ndarray of shape (n,), default=None
        Opening [1] where none was recorded.
    pressure_ratio : ndarray of shape (n,), default=None
        dp / (p1 - FF pv) [1], for regions that name it.

    Returns
    -------
    rows : ndarray of bool, shape (n,)
    """
    location = content["location"]
    opening = recording.get("opening", recording.get("command") if opening is None else opening)
    signals = _signals(recording, opening, pressure_ratio)
    way = direction_of_travel(opening) if opening is not None else np.zeros(len(recording))
    inside = np.zeros(len(recording), dtype=bool)
    for region in location["regions"]:
        box = np.ones(len(recording), dtype=bool)
        for bound in (region, region.get("and")):
            if bound is not None:
                values = signals[bound["signal"]]
                box &= (values >= bound["low"]) & (values <= bound["high"])
        if region.get("direction") is not None:
            box &= way > 0.0 if region["direction"] == "opening" else way < 0.0
        inside |= box
    if not location["regions"]:
        inside[:] = True
    during = np.zeros(len(recording), dtype=bool)
    for begin, end in location["intervals"]:
        during |= (seconds >= begin) & (seconds <= end)
    return inside & during


def _signals(recording, opening, pressure_ratio):
    signals = {role: recording[role] for role in ("flow", "temperature") if role in recording}
    if "p1" in recording and "p2" in recording:
        signals["dp"] = recording["p1"] - recording["p2"]
    if pressure_ratio is not None:
        signals["pressure_ratio"] = pressure_ratio
    if opening is not None:
        signals |= {"opening": opening, "rate": rate_of_travel(opening, recording.time)}
    return signals


def overlap(told, true):
    """Intersection over union."""
    return float(np.sum(told & true) / max(np.sum(told | true), 1))


def spans_of(rows):
    """Rows that are set, as a list of ``[first, behind the last]``."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], np.asarray(rows, dtype=np.int8), [0]])))
    return edges.reshape(-1, 2).tolist()
