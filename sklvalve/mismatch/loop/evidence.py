# SPDX-License-Identifier: BSD-3-Clause
"""How often healthy loops give as much evidence of sticking."""

import numpy as np

#: Share of healthy drawn loops, and the evidence that it exceeds: a value that follows at once, any other.
#: From 135 and 160 loops (of seeds 61000 to 61639 of `benchmarks.loop_alarms`); beyond 0.01 the tail goes
#: on as it falls before.
TAIL = np.array(
    [
        [1.0, 0.0, 0.0],
        [0.1, 3.3, 5.3],
        [0.05, 4.5, 10.7],
        [0.02, 5.5, 16.3],
        [0.01, 7.5, 22.0],
        [0.0001, 18.0, 60.0],
    ]
)


def evidence_of(compared, simple, bent, fast):
    """Evidence that a stem sticks: the least of several differences of log likelihood to the command itself.

    Friction that is there shows itself whatever else is allowed for; what a healthy loop lends to it goes
    where the noise or the process may take other forms.

    Parameters
    ----------
    compared : Compared
        Under Gaussian noise with an autoregression.
    simple : float
        The difference under a wander with white noise alone, so that the evidence does not hang on the
        autoregression. Asked of values that answer slowly; where one follows at once, the autoregression
        holds what the simpler noise takes for the stem's.
    bent : float
        The difference where the valve may be curved and its gain may drift (`alternatives`).
    fast : bool
        Whether the value follows the stem at once, as a flow does.

    Returns
    -------
    evidence : float
    """
    gaussian = compared.stem.log_likelihood - compared.command.log_likelihood
    return float(min(gaussian, bent) if fast else min(gaussian, bent, simple))


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
