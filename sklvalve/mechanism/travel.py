# SPDX-License-Identifier: BSD-3-Clause
"""Valve factors that change with travel: one number, or a table over the opening."""

import numpy as np
from scipy.interpolate import PchipInterpolator


def at_travel(factor, opening=None):
    """Valve factor (F_L, x_T, F_d) at an opening.

    Parameters
    ----------
    factor : float or array-like of shape (n_points, 2)
        The factor itself, or a table of pairs opening, factor with rising openings. [1]
    opening : float or array-like, default=None
        Relative travel; needed for a table. [1]

    Returns
    -------
    factor : float or ndarray
        The number, or the monotone cubic (PCHIP) through the table; beyond its first and last opening the
        table's own end values. NaN where the opening is NaN. [1]

    Raises
    ------
    ValueError
        If the table is malformed, or there is one and no opening.

    Examples
    --------
    >>> at_travel(0.9)
    0.9
    >>> at_travel([[0.1, 0.95], [1.0, 0.85]], [0.0, 0.55, 1.0]).round(3)
    array([0.95, 0.9 , 0.85])
    """
    if np.ndim(factor) == 0:
        return float(factor)
    table = np.asarray(factor, dtype=float)
    if table.ndim != 2 or table.shape[1] != 2 or len(table) < 2 or not np.all(np.isfinite(table)):
        raise ValueError("a factor over travel must be two or more pairs [opening, factor].")
    if np.any(np.diff(table[:, 0]) <= 0.0):
        raise ValueError("the openings of a factor over travel must rise.")
    if opening is None:
        raise ValueError("the factor is a table over travel: the opening is needed with it.")
    within = np.clip(np.asarray(opening, dtype=float), table[0, 0], table[-1, 0])
    return PchipInterpolator(*table.T)(within)[()]
