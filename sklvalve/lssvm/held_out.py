# SPDX-License-Identifier: BSD-3-Clause
"""Errors of an LS-SVM on blocks that it is not fitted to, all from one inverse."""

import numpy as np
from scipy.linalg import cholesky, lu_factor, lu_solve
from scipy.linalg.lapack import dpotri

from sklvalve.lssvm.kernels import kernel_between


class BlockedErrors:
    r"""Errors that an LS-SVM with a free bias makes on rows that are left out, block by block.

    Parameters
    ----------
    X : ndarray of shape (n, d)
        A few thousand rows at most: an n by n matrix is inverted.
    C, gamma : float
        As in :class:`~sklvalve.lssvm.LSSVMRegressor`.
    blocks : sequence of slice
        Rows that count as held out together; they must not overlap.
    gap : int, default=0
        Rows on either side of a block that are left out with it and do not count.
    kernel : str or callable, default="rbf"

    Notes
    -----
    With :math:`H = K + I/C` and the bias eliminated,
    :math:`P = H^{-1} - H^{-1} 1 1^T H^{-1} / (1^T H^{-1} 1)` gives the dual weights
    :math:`\alpha = P y` of all rows, and the error of the machine fitted without the rows B is
    :math:`e_B = P_{BB}^{-1} \alpha_B`, exactly (Cawley and Talbot, Neural Networks 17, 2004). P does not
    depend on the targets, so further targets cost next to nothing.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.lssvm.held_out import BlockedErrors
    >>> X = np.linspace(0.0, 3.0, 40)[:, None]
    >>> errors = BlockedErrors(X, C=100.0, gamma=1.0, blocks=[slice(0, 20), slice(20, 40)])
    >>> errors(np.sin(X[:, 0])).shape
    (40,)
    """

    def __init__(self, X, *, C, gamma, blocks, gap=0, kernel="rbf"):
        n = len(X)
        gram = kernel_between(kernel, gamma=gamma)(X, X)
        gram[np.diag_indices(n)] += 1.0 / C
        factor = cholesky(gram, lower=True, overwrite_a=True, check_finite=False)
        # a third of what solving for every column of the unit matrix costs; one triangle comes back
        inverse = np.tril(dpotri(factor, lower=1, overwrite_c=1)[0])
        inverse += np.tril(inverse, -1).T
        ones = inverse.sum(axis=1)
        self._weights = inverse - np.outer(ones, ones) / ones.sum()
        self._blocks = []
        for block in blocks:
            out = slice(max(block.start - gap, 0), min(block.stop + gap, n))
            own = slice(block.start - out.start, block.stop - out.start)
            # a matrix of rank one less than its size where nothing at all would be left to fit
            if out.stop - out.start >= n - 1:
                raise ValueError("a held-out block with its gap leaves no row to fit; use more blocks")
            self._blocks.append((block, out, own, lu_factor(self._weights[out, out], check_finite=False)))

    def __call__(self, y):
        """Held-out errors, target less prediction.

        Parameters
        ----------
        y : ndarray of shape (n,) or (n, m)

        Returns
        -------
        errors : ndarray of the shape of y
            NaN in rows that belong to no block.
        """
        alpha = self._weights @ y
        errors = np.full(alpha.shape, np.nan)
        for block, out, own, factor in self._blocks:
            errors[block] = lu_solve(factor, alpha[out], check_finite=False)[own]
        return errors
