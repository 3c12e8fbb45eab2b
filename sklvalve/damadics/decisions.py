# SPDX-License-Identifier: BSD-3-Clause
"""Decisions on faults as arrays: when they are high, for how long, and which diagnoses they point at."""

from typing import NamedTuple

import numpy as np

from sklvalve.damadics.faults import FAULTS

_THRESHOLD = 0.5


class Diagnoses(NamedTuple):
    """Which diagnoses are pointed at when, of shape (n, m), and which faults each of the m holds."""

    high: np.ndarray
    faults: tuple[tuple[str, ...], ...]

    @property
    def sizes(self):
        """Number of faults in each, of shape (m,)."""
        return np.array([len(faults) for faults in self.faults])


def pointed_at(isolation, diagnoses, n):
    """Diagnoses of a table of n rows, a column each; the columns are single faults without `diagnoses`.

    Raises
    ------
    ValueError
        If a diagnosis holds no fault or an unknown one, two hold the same, or the table has another shape or
        other values than it should.
    """
    if not np.size(list(isolation.keys()) if hasattr(isolation, "keys") else isolation):
        raise ValueError(
            "isolation must hold a column for each diagnosis, got none; leave it out where only detection is "
            "judged."
        )
    named = hasattr(isolation, "keys")
    columns = list(isolation.keys()) if named else list(FAULTS)
    table = np.column_stack([isolation[name] for name in columns]) if named else isolation
    faults = tuple((name,) for name in columns) if diagnoses is None else tuple(map(tuple, diagnoses))
    every = [name for group in faults for name in group]
    if unknown := [name for name in every if name not in FAULTS]:
        raise ValueError(f"A diagnosis must hold faults of f1 to f19, got {unknown[0]!r}.")
    if len(set(every)) < len(every) or not all(faults):
        raise ValueError("Each diagnosis must hold a fault, and no fault may stand in two of them.")
    return Diagnoses(is_high(table, (n, len(faults)), "isolation"), faults)


def is_high(values, shape, name):
    """Whether a decision is above one half; ValueError unless it has the shape and lies in [0, 1]."""
    values = finite(values, shape, name)
    if not (values.min() >= 0.0 and values.max() <= 1.0):
        raise ValueError(
            f"{name} must lie in [0, 1], 1 where there is a fault; got {values.min():g} to {values.max():g}."
        )
    return values > _THRESHOLD


def finite(values, shape, name):
    """Array of floats; ValueError unless it has the shape and no gap."""
    values = np.asarray(values, float)
    if values.shape != shape:
        raise ValueError(f"{name} must have the shape {shape}, got {values.shape}.")
    if not np.isfinite(values).all():
        raise ValueError(f"{name} must be finite everywhere; fill its gaps first.")
    return values


def covering_times(t, start, stop):
    """Array of times; ValueError unless they increase and their decisions cover `start` to `stop` [s]."""
    t = np.asarray(t, float)
    if t.ndim != 1 or len(t) < 2 or not (np.diff(t) > 0.0).all():
        raise ValueError("t must hold two times or more, each later than the one before.")
    if t[0] > start or _end(t) < stop - 1e-9 * stop:
        raise ValueError(
            f"The decisions must cover {start:g} s to {stop:g} s; they go from {t[0]:g} s to {_end(t):g} s."
        )
    return t


def integral(t, decision, start, stop):
    """Integral of a decision, held from each sample to the next, and the last as long as the one before.

    Parameters
    ----------
    t, decision : ndarray of shape (n,)
        Increasing times [s]; [1].
    start, stop : float
        [s].

    Returns
    -------
    time : float
        How long a decision of 0 and 1 is high [s].

    Examples
    --------
    >>> import numpy as np
    >>> integral(np.arange(4.0), np.array([0, 1, 1, 1]), 1.5, 9.0)
    2.5
    """
    inside = np.clip(np.append(t, _end(t)), start, stop)
    return float(np.diff(inside) @ decision)


def _end(t):
    return 2.0 * t[-1] - t[-2]
