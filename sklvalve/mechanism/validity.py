# SPDX-License-Identifier: BSD-3-Clause
"""How the physics says that it was asked for something outside its validity."""

import warnings

import numpy as np


class ValidityWarning(UserWarning):
    """Physics was used outside the range in which it is known to hold.

    Raised at most once per call and kind of trouble, with the number of rows concerned. The functions of
    `sklvalve.mechanism` never raise from inside a vector and never clip in silence: a row without a
    physical answer becomes NaN, and this warning says how many did. Every function that can emit it takes
    ``warn=False`` to be quiet.

    Examples
    --------
    >>> import warnings
    >>> from sklvalve.mechanism import ValidityWarning, relative_capacity
    >>> with warnings.catch_warnings(record=True) as caught:
    ...     warnings.simplefilter("always")
    ...     phi = relative_capacity([0.5, 1.2], "linear")
    >>> caught[0].category is ValidityWarning
    True
    >>> print(caught[0].message)
    relative_capacity: 1 of 2 rows have an opening outside [0, 1]; the value at the nearer end is returned.
    """


class MissingDatum(ValueError):
    """Something was asked for that needs a datum which nobody gave; the message says which."""


def quiet():
    """Context in which floating point stays silent: what has no answer is NaN, and said in our own words."""
    return np.errstate(invalid="ignore", divide="ignore", over="ignore")


def warn_rows(bad, where, what, *, stacklevel=3):
    """Warn with the count of rows where `bad` is true; silent where there is none."""
    count = int(np.count_nonzero(bad))
    if count:
        message = f"{where}: {count} of {np.size(bad)} rows {what}"
        warnings.warn(message, ValidityWarning, stacklevel=stacklevel)
