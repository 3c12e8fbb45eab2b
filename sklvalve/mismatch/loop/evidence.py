# SPDX-License-Identifier: BSD-3-Clause
"""How often healthy loops give as much evidence of sticking."""

import numpy as np

#: Share of healthy drawn loops, and the evidence that it exceeds: flow, other values. From 240 and 477 loops;
#: below 0.01 the tail goes on as it falls from 0.05 to 0.01.
TAIL = np.array(
    [
        [1.0, 0.0, 0.0],
        [0.1, 3.0, 3.5],
        [0.05, 7.0, 6.0],
        [0.01, 14.0, 12.5],
        [0.0001, 34.0, 31.0],
    ]
)


def p_value(evidence, is_flow):
    """Share of healthy loops, drawn at random, with as much evidence of a band that matters.

    Parameters
    ----------
    evidence : float
        Difference of log likelihood.
    is_flow : bool

    Returns
    -------
    p : float
        Not below 0.0001: nothing is known of rarer loops.
    """
    known = TAIL[:, 1 if is_flow else 2]
    return float(np.exp(np.interp(evidence, known, np.log(TAIL[:, 0]))))
