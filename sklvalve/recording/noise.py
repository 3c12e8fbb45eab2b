# SPDX-License-Identifier: BSD-3-Clause
"""How much a signal jitters, without a model of it."""

import numpy as np
from numpy.typing import ArrayLike

_MAD_TO_SIGMA = 1.482602218505602  # of a normal distribution


def noise_floor(signal: ArrayLike) -> float:
    r"""Standard deviation of a signal's white noise, from its second differences.

    A smooth signal leaves next to nothing in its second differences, white noise leaves six times its
    variance. The median keeps steps and outliers out of it.

    .. math:: \hat\sigma = 1.4826 \operatorname{median} |d - \operatorname{median} d| / \sqrt 6, \quad
              d_i = x_{i-1} - 2 x_i + x_{i+1}

    Valid for noise that is white from sample to sample: of slowly wandering noise it sees the fast part only.
    It is 0 where more than half of the second differences are equal, as in a held command, or in a sensor
    whose noise lies below its resolution; a sensor read in steps of q adds :math:`q^2 / 12` to the variance.

    Parameters
    ----------
    signal : array-like of shape (n,)
        Evenly sampled values in any unit; second differences that touch a gap (NaN) are left out.

    Returns
    -------
    sigma : float
        Standard deviation in the unit of the signal; NaN where fewer than five second differences are left.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.recording import noise_floor
    >>> time = np.arange(2000.0)
    >>> noise = np.random.default_rng(0).normal(0.0, 0.1, 2000)
    >>> round(noise_floor(np.sin(time / 50.0) + noise), 2)
    0.1
    """
    bend = np.diff(np.asarray(signal, dtype=np.float64), 2)
    bend = bend[np.isfinite(bend)]
    if len(bend) < 5:
        return float("nan")
    return float(_MAD_TO_SIGMA * np.median(np.abs(bend - np.median(bend))) / np.sqrt(6.0))
