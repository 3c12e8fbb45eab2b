# SPDX-License-Identifier: BSD-3-Clause
"""Each quarter of a loop's recording, foretold from the other three."""

import numpy as np

from sklvalve.mismatch.loop.fit import mixture_of

_QUARTERS = 4
_BEFORE = 10  # rows before a quarter that set its level


def held_out(columns, value, used, sense, noise, places):
    """Free runs over each quarter, by the process (and the stem) that the other quarters give.

    The level, which wanders in any loop, is that of the ten rows before the quarter (after, for the first).

    Parameters
    ----------
    columns : ndarray of shape (m, k, n)
        Responses to each stem; the first stem is the command.
    value : ndarray of shape (n,)
    used : ndarray of bool, shape (n,)
    sense : int
    noise : tuple of float
        The noise filter by which errors are weighed.
    places : sequence of int
        Stems that may be chosen, each quarter its own.

    Returns
    -------
    nominal, corrected : ndarray of shape (n,)
        Foretold values, from the command itself and from the best stem.
    """
    nominal, corrected = np.empty(len(value)), np.empty(len(value))
    for quarter in np.array_split(np.arange(len(value)), _QUARTERS):
        others = used.copy()
        others[quarter] = False
        for out, choices in ((nominal, [0]), (corrected, places)):
            fits = [(mixture_of(columns[place], value, others, sense, noise), place) for place in choices]
            (mixture, _), place = min(fits, key=lambda fit: fit[0][1])
            run = mixture @ columns[place]
            begin = quarter[0] - _BEFORE if quarter[0] else quarter[-1] + 1
            level = np.mean((value - run)[begin : begin + _BEFORE])
            out[quarter] = run[quarter] + level
    return nominal, corrected
