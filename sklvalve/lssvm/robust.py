# SPDX-License-Identifier: BSD-3-Clause
"""Weights that downweight outliers."""

import numpy as np

# errors up to the first, in standard deviations, count in full; beyond the second next to nothing
_FULL, _NONE, _NEXT_TO_NOTHING = 2.5, 3.0, 1e-4
_TO_DEVIATION = 1.4826


def trust(errors, weight=None):
    r"""How far each row is trusted, by the size of its errors.

    Parameters
    ----------
    errors : ndarray of shape (n, n_targets)
    weight : ndarray of shape (n,), default=None
        Positive; a row of weight 2 counts in the medians as two equal rows.

    Returns
    -------
    weight : ndarray of shape (n,)
        1 up to 2.5 robust standard deviations, falling to 0.0001 at 3; of several targets the worst decides.

    Notes
    -----
    The standard deviation is 1.4826 times the median of :math:`|e - \mathrm{median}(e)|`; where that is zero
    every row is trusted.

    References
    ----------
    .. [1] Suykens et al., Weighted least squares support vector machines: robustness and sparse
       approximation, Neurocomputing 48 (2002) 85.

    Examples
    --------
    >>> import numpy as np
    >>> trust(np.array([[-1.0], [0.0], [1.0], [0.5], [40.0]]))
    array([1.e+00, 1.e+00, 1.e+00, 1.e+00, 1.e-04])
    """
    weight = np.ones(len(errors)) if weight is None else weight
    away = np.abs(errors - _median(errors, weight))
    deviation = _TO_DEVIATION * _median(away, weight)
    known = deviation > 0.0
    if not known.any():
        return np.ones(len(errors))
    worst = (np.abs(errors[:, known]) / deviation[known]).max(axis=1)
    return np.clip((_NONE - worst) / (_NONE - _FULL), _NEXT_TO_NOTHING, 1.0)


def _median(values, weight):
    """Median of each column, in which a row of weight k counts as k equal rows."""
    medians = []
    for column in values.T:
        order = np.argsort(column, kind="stable")
        below = np.cumsum(weight[order])
        half = 0.5 * below[-1]
        # the middle, or the two that it lies between; their sums are of whole numbers where weights are
        middle = [np.searchsorted(below, half, side=side) for side in ("left", "right")]
        medians.append(column[order][np.minimum(middle, len(order) - 1)].mean())
    return np.array(medians)
