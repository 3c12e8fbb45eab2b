# SPDX-License-Identifier: BSD-3-Clause
"""How often healthy loops give as much evidence of sticking."""

import numpy as np
from scipy.special import gammaln

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
_DEGREES = (3.0, 5.0, 10.0, 30.0)  # of Student's t; the last is nearly Gaussian
_ROUNDS = 40


def evidence_of(compared, simple, fast):
    """Evidence that a stem sticks: the least of several differences of log likelihood.

    Under Gaussian noise with an autoregression. Where the value answers slowly, also under a wander with
    white noise alone, so that the evidence does not hang on the autoregression, and under noise with heavy
    tails, so that a few sudden upsets from outside do not speak for friction. Where it follows at once, the
    stem's own jumps are as sudden, and of 135 healthy drawn loops the two more would have stopped none.

    Parameters
    ----------
    compared : Compared
    simple : float
        The difference under the simpler noise.
    fast : bool
        Whether the value follows the stem at once, as a flow does.

    Returns
    -------
    evidence : float
    """
    stem, command = compared.stem, compared.command
    gaussian = stem.log_likelihood - command.log_likelihood
    if fast:
        return float(gaussian)
    heavy = gaussian + _heavier(stem.innovations) - _heavier(command.innovations)
    return float(min(gaussian, heavy, simple))


def _heavier(innovations):
    """How much likelier innovations are under a noise with heavy tails than under a Gaussian one."""
    squares = innovations**2
    gaussian = -0.5 * len(squares) * np.log(np.mean(squares))
    best = -np.inf
    for degrees in _DEGREES:
        variance = np.mean(squares)
        for _ in range(_ROUNDS):
            variance = np.mean((degrees + 1.0) / (degrees + squares / variance) * squares)
        tails = 0.5 * (degrees + 1.0) * np.log1p(squares / (degrees * variance)).sum()
        best = max(best, _constant(degrees, len(squares)) - 0.5 * len(squares) * np.log(variance) - tails)
    return best - gaussian


def _constant(degrees, count):
    return count * (gammaln(0.5 * degrees + 0.5) - gammaln(0.5 * degrees) - 0.5 * np.log(degrees))


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
