# SPDX-License-Identifier: BSD-3-Clause
"""Which C and gamma err least on rows left out: a grid of pairs, then each column's gamma by itself."""

import numpy as np
from sklearn.utils import check_random_state

from sklvalve.lssvm.kernels import gamma_and_scale, kernel_between
from sklvalve.lssvm.left_out import LeftOut, score_of

# rows on which values of gamma are compared, C is chosen on all; and columns, which takes many comparisons
_COMPARED, _COMPARED_BY_COLUMN = 2000, 600
# so many values of C are compared again on all of them
_NEAR = 5
# factors by which the gamma of a column is changed, the next where none helps any more
_FACTORS = (4.0, 2.0, 1.4)
# a share of the score by which a change must lower it to be worth one more gamma that differs
_WORTH = 2e-3


class Search:
    """Scores of C and gamma on rows left out.

    Parameters
    ----------
    X : ndarray of shape (n, d)
    y : ndarray of shape (n, n_targets)
    weight : ndarray of shape (n,)
        Positive.
    blocks : list or None
        Of `left_out.LeftOut`.
    Cs : ndarray of shape (n_Cs,)
    options : dict
        ``kernel``, ``degree``, ``coef0``, ``kernel_params``, ``bias``, ``random_state``, ``n_jobs``.
    """

    def __init__(self, X, y, weight, blocks, Cs, options):
        self._data, self._blocks, self._Cs, self._options = (X, y, weight), blocks, Cs, options
        self._last, self._known = (None, None), {}

    def grid(self, gammas):
        """Scores of all pairs, of shape (n_gammas, n_Cs), NaN where C is too large for the kernel."""
        some = self._some(_COMPARED) if len(gammas) > 1 else self
        return np.array([some.path(gamma) for gamma in gammas])

    def path(self, gamma):
        """Scores of every C, of shape (n_Cs,)."""
        left_out = self._left_out(gamma)
        return np.array([self._scored(left_out, C) for C in self._Cs])

    def by_column(self, gamma):
        """A gamma for each column, from one for all.

        Returns
        -------
        gammas : ndarray of shape (d,)
        C : float
            That goes with them.
        """
        some, d = self._some(_COMPARED_BY_COLUMN), self._data[0].shape[1]
        gammas, path = np.full(d, gamma), some.path(gamma)
        for factor in _FACTORS:
            changed = True
            while changed:
                changed = False
                for k in range(d):
                    for times in (factor, 1.0 / factor):
                        tried = gammas.copy()
                        tried[k] *= times
                        now = some.path(tried)
                        if np.nanmin(now) < (1.0 - _WORTH) * np.nanmin(path):
                            gammas, path, changed = tried, now, True
                            break
        return gammas, float(self._Cs[int(np.nanargmin(path))])

    def errors(self, gamma, C):
        """Errors on left-out rows among all, and the C near to one that is best among all."""
        left_out = self._left_out(gamma)
        if len(self._data[0]) > _COMPARED_BY_COLUMN:
            near = self._Cs[np.argsort(np.abs(np.log(self._Cs / C)))[:_NEAR]]
            scores = [self._scored(left_out, c) for c in near]
            if np.isfinite(scores).any():
                C = float(near[int(np.nanargmin(scores))])
        return self._errors(left_out, C), C

    def _some(self, most):
        n = len(self._data[0])
        if n <= most:
            return self
        rows = np.sort(check_random_state(self._options["random_state"]).permutation(n)[:most])
        data = [column[rows] for column in self._data]
        return Search(*data, _thinned(self._blocks, rows, n), self._Cs, self._options)

    def _left_out(self, gamma):
        """Decomposition for a gamma; the last one is kept, for the best is often asked for again."""
        if self._last[1] is None or not np.array_equal(self._last[0], gamma):
            self._last, self._known = (gamma, self._decomposed(gamma)), {}
        return self._last[1]

    def _decomposed(self, gamma):
        options, (X, _, weight) = self._options, self._data
        gamma, scale = gamma_and_scale(options["kernel"], gamma, X.shape[1])
        more = {name: options[name] for name in ("degree", "coef0", "kernel_params")}
        return LeftOut(
            kernel_between(options["kernel"], gamma=gamma, **more),
            X if scale is None else X * scale,
            weight,
            largest_C=self._Cs.max(),
            bias=options["bias"],
            blocks=self._blocks,
            random_state=check_random_state(options["random_state"]),
            n_jobs=options["n_jobs"],
        )

    def _errors(self, left_out, C):
        """Errors on left-out rows; those of the last decomposition are kept as well."""
        if C not in self._known:
            self._known[C] = left_out.errors(C, self._data[1])
        return self._known[C]

    def _scored(self, left_out, C):
        weight = self._data[2]
        try:
            errors = self._errors(left_out, C)
        except ValueError:
            return np.nan
        known = np.isfinite(errors[:, 0])
        return score_of(errors[known], weight[known]) if known.any() else np.nan


def _thinned(blocks, some, n):
    """Blocks of which only some rows are left, as places among these."""
    if blocks is None:
        return None
    place = np.full(n, -1)
    place[some] = np.arange(len(some))
    thin = [tuple(place[rows][place[rows] >= 0] for rows in block) for block in blocks]
    return [block for block in thin if len(block[0])]
