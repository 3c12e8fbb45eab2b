# SPDX-License-Identifier: BSD-3-Clause
"""The stem as a state that a positioner moves: the paper's equations 14 and 15 as a mechanism."""

import numpy as np
from sklearn.base import BaseEstimator

#: Time between two rows [s].
STEP = 1.0
# below which a stem that has arrived, and noise, look like one that is on its way [1]
_ARRIVED = 0.02


class SlewingStem(BaseEstimator):
    r"""Opening one step later, of a stem that goes to the command as fast as the air allows.

    Columns of X: opening now, command as an opening, both [1], further ones of no interest here.

    Notes
    -----
    .. math:: x(k+1) = x(k) + \mathrm{clip}(u(k) - x(k),\, -P\,\Delta t,\, P\,\Delta t)

    The positioner's gain is so high that its relay is fully open until the stem has nearly arrived; how fast
    the stem is then depends on supply, spring and direction, which is the unknown :math:`P` [1/s].
    """

    def forward(self, X, parameter):
        """Opening one step later for speeds [1/s]."""
        reach = STEP * np.maximum(parameter, 0.0)
        return X[:, 0] + np.clip(X[:, 1] - X[:, 0], -reach, reach)

    def invert(self, X, y):
        """Speeds [1/s]; NaN where the stem arrived, or went the other way."""
        way = X[:, 1] - X[:, 0]
        gone = np.sign(way) * (y - X[:, 0])
        on_its_way = (gone > 0.0) & (gone < np.abs(way) - _ARRIVED)
        return np.where(on_its_way, gone / STEP, np.nan)
