# SPDX-License-Identifier: BSD-3-Clause
"""Inherent characteristic of the trim: relative capacity from opening, and opening from relative capacity."""

import numpy as np
from scipy.interpolate import PchipInterpolator

from sklvalve.mechanism.validity import warn_rows

CHARACTERISTICS = ("linear", "equal_percentage", "quick_opening", "parabolic", "hyperbolic")
"""Characteristics known by name; the other way is a table of pairs [opening, relative capacity]."""

# kind: (capacity from opening, opening from capacity) with a rangeability r
_RANGED = {
    "linear": (lambda h, r: (1.0 + (r - 1.0) * h) / r, lambda c, r: (r * c - 1.0) / (r - 1.0)),
    "equal_percentage": (lambda h, r: r ** (h - 1.0), lambda c, r: 1.0 + np.log(c) / np.log(r)),
    "quick_opening": (
        lambda h, r: np.sqrt(r**-2 + (1.0 - r**-2) * h),
        lambda c, r: (c * c - r**-2) / (1.0 - r**-2),
    ),
    "parabolic": (
        lambda h, r: (1.0 + (np.sqrt(r) - 1.0) * h) ** 2 / r,
        lambda c, r: (np.sqrt(r * c) - 1.0) / (np.sqrt(r) - 1.0),
    ),
    "hyperbolic": (lambda h, r: 1.0 / (r - (r - 1.0) * h), lambda c, r: (r - 1.0 / c) / (r - 1.0)),
}
# the limit of an unbounded rangeability, where there is one
_UNRANGED = {
    "linear": (lambda h, r: h, lambda c, r: c),
    "quick_opening": (lambda h, r: np.sqrt(h), lambda c, r: c * c),
    "parabolic": (lambda h, r: h * h, lambda c, r: np.sqrt(c)),
}
# allowed rounding of a capacity at the two ends of its range
_ROUNDING = 8.0 * np.finfo(float).eps


def relative_capacity(opening, characteristic, *, rangeability=None, shutoff=0.0, leakage=0.0, warn=True):
    r"""Relative flow coefficient phi = kv / kv_rated at an opening.

    Parameters
    ----------
    opening : float or array-like
        Relative travel, 0 shut, 1 open. [1]
    characteristic : str or array-like of shape (n_points, 2)
        ``"linear"``, ``"equal_percentage"``, ``"quick_opening"``, ``"parabolic"``, ``"hyperbolic"``, or a
        table of pairs opening, relative capacity: openings rising from 0 to 1, capacities nowhere falling.
    rangeability : float, default=None
        Inherent rangeability R, the ratio of the largest to the smallest controllable capacity. Needed for
        equal percentage and hyperbolic; the others take None for the form that begins at zero. [1]
    shutoff : float, default=0.0
        Opening below which the trim closes down, linearly, to nothing. [1]
    leakage : float, default=0.0
        Part of the rated capacity that passes beside the trim, at the seat. [1]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of openings outside [0, 1].

    Returns
    -------
    phi : float or ndarray
        Relative capacity. An opening outside [0, 1] gets the value of the nearer end. [1]

    Raises
    ------
    ValueError
        If the characteristic is unknown, its table is not monotone, the rangeability is missing or not
        above 1, the shutoff is outside [0, 1), or the leakage is outside [0, 1).

    See Also
    --------
    opening_for_capacity : The exact inverse.

    Notes
    -----
    =================  =================================================  ==============
    name               with R                                             without R
    =================  =================================================  ==============
    linear             :math:`(1 + (R-1) h) / R`                          :math:`h`
    equal_percentage   :math:`R^{h-1}`                                    needs R
    quick_opening      :math:`\sqrt{R^{-2} + (1 - R^{-2}) h}`             :math:`\sqrt h`
    parabolic          :math:`(1 + (\sqrt R - 1) h)^2 / R`                :math:`h^2`
    hyperbolic         :math:`1 / (R - (R-1) h)`                          needs R
    table              monotone cubic (PCHIP) through the points
    =================  =================================================  ==============

    Below :math:`h_0` = `shutoff` :math:`\varphi(h) = \varphi(h_0)\, h / h_0`. Without a shutoff a trim with a
    rangeability still passes 1/R when shut. A leakage l lifts the curve to
    :math:`l + (1 - l/\varphi(1))\,\varphi(h)`, so that the open valve keeps its capacity; the seat classes
    II, III and IV of [2]_ allow 0.005, 0.001 and 0.0001. Real trims lie within
    :math:`\pm 10\,(1/\varphi)^{0.2}` % of their stated curve.

    References
    ----------
    .. [1] IEC 60534-2-4, Industrial-process control valves: inherent flow characteristics and rangeability.
    .. [2] IEC 60534-4, Industrial-process control valves: inspection and routine testing.

    Examples
    --------
    >>> relative_capacity([0.0, 0.01, 0.5, 1.0], "equal_percentage", rangeability=50, shutoff=0.02).round(4)
    array([0.    , 0.0108, 0.1414, 1.    ])
    """
    trim = _trim(characteristic, rangeability, shutoff, leakage)
    opening = np.asarray(opening, dtype=float)
    if warn:
        outside = (opening < 0.0) | (opening > 1.0)
        what = "have an opening outside [0, 1]; the value at the nearer end is returned."
        warn_rows(outside, "relative_capacity", what)
    opening = np.clip(opening, 0.0, 1.0)
    phi = trim.capacity(opening)
    if shutoff > 0.0:
        phi = np.where(
            opening < shutoff, trim.capacity(shutoff) * np.minimum(opening, shutoff) / shutoff, phi
        )
    if leakage > 0.0:
        phi = leakage + (1.0 - leakage / trim.capacity(1.0)) * phi
    return phi[()]


def opening_for_capacity(phi, characteristic, *, rangeability=None, shutoff=0.0, leakage=0.0, warn=True):
    r"""Opening at which the trim has a given relative capacity: the inverse of `relative_capacity`.

    Parameters
    ----------
    phi : float or array-like
        Relative capacity kv / kv_rated. [1]
    characteristic, rangeability, shutoff, leakage
        As in `relative_capacity`.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of capacities that no opening has.

    Returns
    -------
    opening : float or ndarray
        Opening in [0, 1]; NaN where no opening has this capacity. Where a table is flat, the smallest. [1]

    Raises
    ------
    ValueError
        As `relative_capacity`.

    Notes
    -----
    Closed forms, but for a table: there each cubic is solved by Newton steps kept inside a shrinking bracket.
    Either way the opening comes back to rounding. Only where a table levels off at its end is less known of
    it: there the capacity itself, in double precision, tells openings apart to some 1e-9 or, at the very end,
    1e-8.

    Examples
    --------
    >>> phi = relative_capacity([0.01, 0.3, 0.9], "equal_percentage", rangeability=30, shutoff=0.05)
    >>> opening_for_capacity(phi, "equal_percentage", rangeability=30, shutoff=0.05).round(12)
    array([0.01, 0.3 , 0.9 ])
    """
    trim = _trim(characteristic, rangeability, shutoff, leakage)
    phi = np.asarray(phi, dtype=float)
    least = 0.0 if shutoff > 0.0 else float(trim.capacity(0.0))
    most = float(trim.capacity(1.0))
    through_trim = 1.0 - leakage / most
    slack = _ROUNDING * most
    lowest = leakage + through_trim * least
    reachable = (phi >= lowest - slack) & (phi <= most + slack)
    if warn:
        unreachable = ~reachable & ~np.isnan(phi)
        what = f"have a relative capacity outside [{lowest:.4g}, {most:.4g}], which no opening gives: NaN."
        warn_rows(unreachable, "opening_for_capacity", what)
    if leakage > 0.0:
        phi = (phi - leakage) / through_trim
    inside = np.where(reachable, np.clip(phi, least, most), np.nan)
    if shutoff > 0.0:
        knee = float(trim.capacity(shutoff))
        # at the knee too: a curve that is flat from there on has that capacity only here for the first time
        closing = inside <= knee
        # capacities under the knee may lie outside the range of the inherent curve
        opening = trim.opening(np.where(closing, knee, inside))
        opening = np.where(closing, inside * (shutoff / knee) if knee > 0.0 else 0.0, opening)
    else:
        opening = trim.opening(inside)
    return np.clip(opening, 0.0, 1.0)[()]


def _trim(characteristic, rangeability, shutoff, leakage):
    if not 0.0 <= shutoff < 1.0:
        raise ValueError(f"shutoff must be an opening in [0, 1); got {shutoff!r}.")
    if not 0.0 <= leakage < 1.0:
        raise ValueError(f"leakage must be a part of the rated capacity in [0, 1); got {leakage!r}.")
    if rangeability is not None and not rangeability > 1.0:
        raise ValueError(f"rangeability must be above 1; got {rangeability!r}.")
    if not isinstance(characteristic, str):
        trim = _TableTrim(characteristic)
        if leakage >= trim.capacity(1.0):
            last = f"{trim.capacity(1.0):.4g}"
            raise ValueError(f"leakage must be below the table's last capacity, {last}; got {leakage!r}.")
        return trim
    if characteristic not in CHARACTERISTICS:
        known = ", ".join(CHARACTERISTICS)
        raise ValueError(
            f"unknown characteristic {characteristic!r}: use one of {known}, or a table of pairs "
            "[opening, relative capacity]."
        )
    if rangeability is None and characteristic not in _UNRANGED:
        raise ValueError(f"the characteristic {characteristic!r} needs a rangeability, for example 50.")
    return _NamedTrim(characteristic, rangeability)


class _NamedTrim:
    def __init__(self, kind, rangeability):
        self._forward, self._inverse = (_UNRANGED if rangeability is None else _RANGED)[kind]
        self._rangeability = None if rangeability is None else float(rangeability)

    def capacity(self, opening):
        return np.asarray(self._forward(opening, self._rangeability))

    def opening(self, phi):
        return np.asarray(self._inverse(phi, self._rangeability))


class _TableTrim:
    def __init__(self, table):
        points = np.asarray(table, dtype=float)
        if points.ndim != 2 or points.shape[1] != 2 or len(points) < 2 or not np.all(np.isfinite(points)):
            raise ValueError("a characteristic table must be two or more pairs [opening, relative capacity].")
        opening, phi = points.T
        if opening[0] != 0.0 or opening[-1] != 1.0 or np.any(np.diff(opening) <= 0.0):
            raise ValueError("the openings of a characteristic table must rise from 0 to 1.")
        if phi[0] < 0.0 or np.any(np.diff(phi) < 0.0) or phi[-1] <= 0.0:
            raise ValueError(
                "the capacities of a characteristic table must start at 0 or above and never fall."
            )
        self._opening, self._phi = opening, phi
        self._curve = PchipInterpolator(opening, phi)

    def capacity(self, opening):
        return np.asarray(self._curve(opening))

    def opening(self, phi):
        phi = np.asarray(phi, dtype=float)
        known = np.atleast_1d(phi[~np.isnan(phi)])
        result = np.full(phi.shape, np.nan)
        result[~np.isnan(phi)] = self._solve(known)
        return result

    def _solve(self, phi):
        piece = np.clip(np.searchsorted(self._phi, phi, side="left") - 1, 0, len(self._phi) - 2)
        cubic, square, slope, constant = self._curve.c[:, piece]
        constant = constant - phi
        width = np.diff(self._opening)[piece]
        low, high = np.zeros_like(phi), width.copy()
        at = 0.5 * width
        # bisection alone would end in 60 rounds; Newton makes it five or six
        for _ in range(60):
            value = ((cubic * at + square) * at + slope) * at + constant
            low, high = np.where(value < 0.0, at, low), np.where(value < 0.0, high, at)
            steepness = (3.0 * cubic * at + 2.0 * square) * at + slope
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = at - value / steepness
            usable = (newton >= low) & (newton <= high)
            step_to = np.where(usable, newton, 0.5 * (low + high))
            settled = np.all(np.abs(step_to - at) <= 2.0 * np.finfo(float).eps * width)
            at = step_to
            if settled:
                break
        at = np.where(phi <= self._phi[piece], 0.0, np.where(phi >= self._phi[piece + 1], width, at))
        return self._opening[piece] + at
