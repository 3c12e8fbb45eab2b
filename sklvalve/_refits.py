# SPDX-License-Identifier: BSD-3-Clause
"""Fits that change their estimator at the end and at once, so that one that fails changes nothing."""

from functools import wraps


def whole_or_nothing(fit):
    """Let a method that fits work on a copy of its estimator, and give the estimator the result at the end.

    A fit that is refused, or interrupted anywhere, leaves the estimator as it was: unfitted, or as the last
    fit left it. Another thread that predicts meanwhile uses the old fit or the new one, and no mixture.

    Parameters
    ----------
    fit : callable
        Method that sets attributes of its estimator and does not change what those hold already. What it
        returns is dropped.

    Returns
    -------
    method : callable
        Returns the estimator. It adds one frame to the stack, which counts for the `stacklevel` of warnings.

    Examples
    --------
    >>> class Mean:
    ...     @whole_or_nothing
    ...     def fit(self, y):
    ...         self.n_ = len(y)
    ...         self.mean_ = sum(y) / self.n_
    >>> mean = Mean().fit([1.0, 3.0])
    >>> try:
    ...     mean.fit([])
    ... except ZeroDivisionError:
    ...     print(mean.n_, mean.mean_)
    2 2.0
    """

    @wraps(fit)
    def method(self, *args, **kwargs):
        # not copy(), which asks the estimator how it wants to be pickled
        draft = object.__new__(type(self))
        draft.__dict__.update(self.__dict__)
        fit(draft, *args, **kwargs)
        # one assignment: no signal comes in the middle of it
        self.__dict__ = draft.__dict__
        return self

    return method
