# SPDX-License-Identifier: BSD-3-Clause
"""How often healthy loops give as much evidence of sticking."""

import numpy as np

#: Share of healthy drawn loops, and the evidence that it exceeds: a value that follows at once, any other.
#: From 351 and 380 loops (of seeds 61000 to 62399 of `benchmarks.loop_alarms`); beyond 0.01 the tail goes
#: on as it falls from 0.02 to 0.002.
TAIL = np.array(
    [
        [1.0, 0.0, 0.0],
        [0.1, 3.7, 5.4],
        [0.05, 5.4, 7.5],
        [0.02, 7.5, 12.9],
        [0.01, 8.7, 23.3],
        [0.0001, 60.0, 90.0],
    ]
)


def evidence_of(compared, bent):
    """Evidence that a stem sticks: the lesser of two differences of log likelihood to the command itself.

    Friction that is there shows itself whatever else is allowed for; what a healthy loop lends to it goes
    where the process may take another form.

    Parameters
    ----------
    compared : Compared
        With a linear process.
    bent : float
        The difference where the valve may be curved and its gain may drift (`alternatives`).

    Returns
    -------
    evidence : float
    """
    return float(min(compared.stem.log_likelihood - compared.command.log_likelihood, bent))


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
