# SPDX-License-Identifier: BSD-3-Clause
"""What the liquid functions take for data, and what for nonsense: that becomes NaN, and is counted."""

import numpy as np

from sklvalve.mechanism.validity import warn_rows

SENSELESS = (
    "hold what cannot be (a pressure below zero absolute, a p_vapour outside 0 to p_critical, or a bore, "
    "factor or kv_rated that is not positive) and give NaN."
)
BOILS = "have liquid at or below its vapour pressure before the valve; those at or below F_F p_v give NaN."


def positive(value):
    """The value as floats, NaN where it is not positive."""
    return _kept(value, lambda known: known > 0.0)


class Screen:
    """Turns the nonsense among the inputs of one call into NaN, and remembers in which rows it was."""

    def __init__(self, valve=None):
        self.senseless = False if valve is None else valve.senseless

    def pressures(self, *values):
        return tuple(self._take(value, lambda known: known >= 0.0) for value in values)

    def boiling(self, p_vapour, p_critical):
        """Vapour and critical pressure of what can be a liquid."""
        p_critical = self._take(p_critical, lambda known: known > 0.0)
        # a critical pressure that is missing says nothing against the vapour pressure
        return self._take(p_vapour, lambda known: (known >= 0.0) & ~(known > p_critical)), p_critical

    def warn(self, where, result, *, stacklevel=4):
        warn_rows(self.senseless & np.isnan(result), where, SENSELESS, stacklevel=stacklevel)

    def _take(self, value, sensible):
        kept = _kept(value, sensible)
        self.senseless = self.senseless | (np.isnan(kept) & ~np.isnan(np.asarray(value, dtype=float)))
        return kept


def complete(*values):
    """Rows in which nothing is NaN; a value that is None is not asked for."""
    rows = True
    for value in values:
        if value is not None:
            rows = rows & ~np.isnan(np.asarray(value, dtype=float))
    return rows


def _kept(value, sensible):
    value = np.asarray(value, dtype=float)
    good = sensible(value)
    return value if np.all(good) else np.where(good, value, np.nan)
