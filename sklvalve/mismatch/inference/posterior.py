# SPDX-License-Identifier: BSD-3-Clause
r"""How probable the explanations of one difference are, although each of their simulations is a little wrong.

Of true models the likelihood decides, and a day of rows tells anything from anything. A simulation is never
true: it gets a share :math:`\kappa` of an effect wrong. Let two explanations differ by :math:`d`, both
whitened, and let the best of them change the simulation by :math:`c`. Then the error of the simulation along
:math:`d` has the variance :math:`\kappa^2 |c|^2` beside the noise's one, and the log likelihood ratio counts
by the part

.. math:: \frac{1}{T}, \qquad T = 1 + \kappa^2 |c|^2 = 1 + 2 \kappa^2 G,

with :math:`G = |c|^2 / 2` the log likelihood that the best explanation gains on none. This is the model error
of Kennedy and O'Hagan (2001) in the one direction that matters, and a power posterior (Holmes and Walker,
2017) whose power the recording itself sets.
"""

import numpy as np

from sklvalve.mismatch.constants import IN_CLASS, SHARE_WRONG


def temperature(gain: float, share: float = SHARE_WRONG) -> float:
    """How many nats of likelihood count as one.

    Parameters
    ----------
    gain : float
        Log likelihood that the best explanation gains on none.
    share : float, default=0.15
        What a simulation gets wrong of an effect [1].

    Returns
    -------
    temperature : float
        At least 1.

    Examples
    --------
    >>> from sklvalve.mismatch.inference.posterior import temperature
    >>> round(temperature(20.0), 2), round(temperature(2000.0), 1)
    (1.9, 91.0)
    """
    return 1.0 + 2.0 * share**2 * max(gain, 0.0)


def posterior(scores: np.ndarray, gain: float) -> np.ndarray:
    """Probabilities of explanations of which one is true.

    Parameters
    ----------
    scores : ndarray of shape (k,)
        Log likelihood of each, less what its parameters cost.
    gain : float
        Log likelihood that the best one gains on none.

    Returns
    -------
    probabilities : ndarray of shape (k,)
        Their sum is 1.

    Examples
    --------
    >>> from sklvalve.mismatch.inference.posterior import posterior
    >>> posterior([-100.0, -103.0], gain=20.0).round(2)
    array([0.83, 0.17])
    >>> posterior([-100.0, -103.0], gain=20_000.0).round(2)
    array([0.5, 0.5])
    """
    cooled = np.asarray(scores, dtype=float) / temperature(gain)
    weights = np.exp(cooled - cooled.max())
    return weights / weights.sum()


def distance(best: float, other: float, gain: float, share: float = SHARE_WRONG) -> float:
    r"""Distance D of an explanation from the best one, as far as the simulation can be trusted.

    Twice the difference of log likelihoods, by the temperature. Two explanations at a distance D are taken
    for each other with a probability of about :math:`\Phi(-\sqrt{D}/2)`.

    Parameters
    ----------
    best, other : float
        Log likelihoods.
    gain : float
        Log likelihood that the best one gains on none.
    share : float, default=0.15
        What a simulation gets wrong of an effect [1].
    """
    return 2.0 * max(best - other, 0.0) / temperature(gain, share)


def smallest_class(probabilities: dict) -> dict:
    """The fewest explanations that hold `IN_CLASS` of the probability, the most probable first.

    Parameters
    ----------
    probabilities : dict
        Name -> probability.
    """
    held: dict = {}
    for name, probability in sorted(probabilities.items(), key=lambda item: -item[1]):
        if sum(held.values()) >= IN_CLASS:
            break
        held[name] = probability
    return held
