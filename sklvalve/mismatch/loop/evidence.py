# SPDX-License-Identifier: BSD-3-Clause
"""How often healthy loops give as much evidence of sticking."""

import numpy as np

#: Share of healthy drawn loops, and the evidence that it exceeds: a value that follows at once, any other.
#: From 270 and 284 loops (of seeds 61000 to 61576 and 61700 to 62228 of `benchmarks.loop_alarms`). Beyond
#: 0.01 so few tell nothing but their largest, 34 nats in both; the last line is set, not measured.
TAIL = np.array(
    [
        [1.0, 0.0, 0.0],
        [0.1, 3.7, 6.3],
        [0.05, 4.9, 8.6],
        [0.02, 6.3, 16.0],
        [0.01, 10.2, 21.0],
        [0.0001, 60.0, 60.0],
    ]
)


def evidence_of(better, simple):
    """Evidence that a stem sticks.

    Where the simpler noise speaks against it, that is taken off: a level whose controller answers at once is
    explained by any stem under a long autoregression.

    Parameters
    ----------
    better : float
        How much better the stem fits than the command itself: the lesser of the differences of log likelihood
        with a linear process and where the valve may be curved and its gain may drift. Friction that is there
        shows itself in both; what a healthy loop lends to it goes where the process may take another form.
    simple : float
        The difference under a wander with white noise alone.

    Returns
    -------
    evidence : float
    """
    return float(better + min(simple, 0.0))


def p_value(evidence, fast):
    """Share of healthy loops, drawn at random, with as much evidence of a band that matters.

    Parameters
    ----------
    evidence : float
        Difference of log likelihood.
    fast : bool
        Whether the value follows the stem at once, as a flow does.

    Returns
    -------
    p : float
        Not below 0.0001: nothing is known of rarer loops.
    """
    known = TAIL[:, 1 if fast else 2]
    return float(np.exp(np.interp(evidence, known, np.log(TAIL[:, 0]))))
