# SPDX-License-Identifier: BSD-3-Clause
"""How far apart two explanations of one recording are, and how far what one gains can be trusted.

Between two true models the log likelihood ratio is normal with a mean of half the distance D and a variance
of D. A simulation is never true: it gets a share of every effect wrong, and what it gets wrong makes the
ratio jump from event to event by far more than that law allows.
"""

import numpy as np

from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.onset import row_losses

# two explanations are told apart from this distance on (3 % confusion)
DISTINGUISHABLE = 14.0
# what a simulation gets wrong of most effects, share of their size: so much passes for something else
SHARE_MISTAKEN = Effect.mistaken
# and of one inside positioner and actuator, of whose air and friction a sheet tells less
OF_STROKES = 0.3
# stretches are longer than whatever a valve remembers, and so many that a few make a scatter
_STRETCH = 60.0
_FEWEST, _MOST = 16, 96


def gain_in_spreads(workbench, better, other):
    """Log likelihood that one fit gains on another, in standard deviations of its scatter over time.

    The scatter is the recording's own, stretch by stretch (Vuong, Econometrica 57, 1989): what one event
    gained counts as one event.

    Parameters
    ----------
    workbench : Workbench
    better, other : Model

    Returns
    -------
    spreads : float
    """
    losses = [row_losses(workbench, m, workbench.channels) for m in (better, other)]
    gained = losses[1] - losses[0]
    clock = workbench.plain.clock
    # the time between recordings that were joined holds nothing
    length = min(clock[-1] - clock[0], len(clock) * workbench.recording.sample_time)
    many = int(np.clip(length / _STRETCH, _FEWEST, _MOST))
    each = np.array([part.sum() for part in np.array_split(gained, many)])
    scatter = np.sqrt(many) * each.std(ddof=1)
    return float(each.sum() / scatter) if scatter > 0.0 else 0.0


def distance(best, other, gain, share=SHARE_MISTAKEN):
    """Profile-likelihood distance D of an explanation from the best one, as far as it can be trusted.

    Two simulations of an effect that differ by less than a simulation gets wrong of any effect are not told
    apart, however many rows there are.

    Parameters
    ----------
    best, other : Model
    gain : float
        Log likelihood that the best explanation adds to the simulation without it.
    share : float, default=0.15
        What a simulation gets wrong of the effect, share of its size [1].

    Returns
    -------
    distance : float
        Two explanations are taken for each other with a probability of about Phi(-sqrt(D)/2).
    """
    own_error = share**2 * 2.0 * max(gain, 0.0)
    between = 2.0 * max(best.log_likelihood - other.log_likelihood, 0.0)
    return between / (1.0 + own_error / DISTINGUISHABLE)


def distance_of_strokes(workbench, best, other, without):
    """Distance of two explanations of a stem's movement, where one or two strokes must not decide.

    As `distance`; but where the best explanation leaves more of the effect than a simulation usually gets
    wrong, that much is wrong. And z deviations of the scatter of the difference over time are a D of
    4 z^2 at most, for both stand for a chance of mistaking them of Phi(-z): where a stem comes to rest hangs
    on what no simulation knows, and until the next stroke every row repeats it. An explanation that leaves
    less of the opening (mean square) than the likeliest is nowhere told from it: which of the two is
    preferred then hangs on how much a gross error counts.

    Parameters
    ----------
    workbench : Workbench
    best, other, without : Model
        Two hypotheses with the effect or its rival, and that without either.
    """
    share = max(OF_STROKES, min(_left_of_opening(workbench, best, without), 1.0))
    between = distance(best, other, best.log_likelihood - without.log_likelihood, share)
    if between < DISTINGUISHABLE:
        return between
    if _mean_square(workbench, other) < _mean_square(workbench, best):
        return float(np.nextafter(DISTINGUISHABLE, 0.0))
    return min(between, 4.0 * max(gain_in_spreads(workbench, best, other), 0.0) ** 2)


def _left_of_opening(workbench, best, without):
    """What is left over of the opening beyond the sensor's noise, share of what the effect changes."""
    if "opening" not in workbench.channels:
        return 0.0
    left = _mean_square(workbench, best) - workbench.noise["opening"].floor ** 2
    changed = np.nanmean((best.predictions["opening"] - without.predictions["opening"]) ** 2)
    return float(np.sqrt(max(left, 0.0) / max(changed, 1e-30)))


def _mean_square(workbench, model):
    """Mean square of what a model leaves of the opening; nothing where that is not recorded."""
    if "opening" not in workbench.channels:
        return 0.0
    return float(np.nanmean(workbench.residuals(model)["opening"] ** 2))
