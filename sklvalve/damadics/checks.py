# SPDX-License-Identifier: BSD-3-Clause
"""What is asked of numbers, in one sentence."""

from numbers import Real

import numpy as np


def number(name, value, low=-np.inf, high=np.inf, *, above=False):
    """A finite number as given; ValueError where it is none, outside a range, or its low end if `above`.

    Examples
    --------
    >>> number("mass", 2.0, 0.0, above=True)
    2.0
    """
    real = isinstance(value, Real) and not isinstance(value, bool | np.bool_)
    if not real or not np.isfinite(value) or not low <= value <= high or (above and value == low):
        raise ValueError(f"{name} must {_range(low, high, above)}, got {value!r}.")
    return value


def generator(random_state):
    """Generator of random numbers of a seed, or the one that is given; ValueError where there is none."""
    try:
        return np.random.default_rng(random_state)
    except (TypeError, ValueError):
        raise ValueError(
            f"random_state must be a whole number of 0 or more, a Generator or None, got {random_state!r}."
        ) from None


def _range(low, high, above):
    if high < np.inf:
        return f"lie in [{low:g}, {high:g}]"
    if low == -np.inf:
        return "be a finite number"
    return f"be a finite number above {low:g}" if above else f"be a finite number, {low:g} or more"
