# SPDX-License-Identifier: BSD-3-Clause
"""One stretch of a loop: the command itself against every stem that sticks."""

from dataclasses import dataclass

import numpy as np

from sklvalve.mismatch.loop.alternatives import beside_a_bend
from sklvalve.mismatch.loop.evidence import evidence_of, p_value
from sklvalve.mismatch.loop.fit import Compared, fit_stems
from sklvalve.mismatch.loop.operators import Candidates, candidates, reversals
from sklvalve.mismatch.loop.process import QUICK, foreseen_command, responses
from sklvalve.mismatch.loop.signals import LoopSignals

MATTERS = 0.17  # of the command's movement; less is the play that every valve has
LARGE = 0.3
FAST = 0.35  # share of slow responses; of drawn flows three quarters have less, of levels few
#: A command that goes one way only tells no band from a supply or a gain that drifts: it must turn and come
#: back by this share of its movement.
FEWEST_TURNS, BACK = 1, 0.3


@dataclass(frozen=True, eq=False)
class Look:
    """What a stretch says.

    Parameters
    ----------
    loop : LoopSignals
    foreseen : ndarray of shape (n,)
    tried : Candidates
    columns : ndarray of shape (m, k, n)
    sense : int
    compared : Compared
    evidence : float
        Of the best stem that sticks over the command itself; see `evidence_of`.
    excess : float
        The most that any noise says for a band that matters, before anything is taken off.
    share : float
        Band of that stem, as a share of the command's movement.
    turns : int
        How often the command turns and goes back by 30 % of its movement.
    p : float
        How often a healthy loop gives as much evidence.
    large : float
        How much better the best of all bands of 30 % or more fits than the command.
    answer : float
        How much better the command fits than no answer at all.
    small : float
        How much better the best smaller band fits than the command.
    fast : bool
        Whether the value follows the stem within a fraction of a swing, as a flow does.
    """

    loop: LoopSignals
    foreseen: np.ndarray
    tried: Candidates
    columns: np.ndarray
    sense: int
    compared: Compared
    evidence: float
    excess: float
    share: float
    turns: int
    p: float
    large: float
    answer: float
    small: float
    fast: bool


def looked(loop):
    """Compare the command itself with every stem that sticks, on one stretch.

    Parameters
    ----------
    loop : LoopSignals

    Returns
    -------
    look : Look
    """
    foreseen = foreseen_command(loop.command, loop.value, loop.setpoint)
    tried = candidates(loop, foreseen)
    columns = responses(tried.stem, tried.ahead, not loop.is_flow)
    shares = tried.stick / loop.span
    eligible = shares >= MATTERS, (shares < MATTERS) & (shares > 0.0)
    fits = {sense: fit_stems(columns, loop.value, loop.used, sense, eligible) for sense in loop.senses}
    sense = max(fits, key=lambda s: _likelihood(fits[s]))
    compared = fits[sense]
    fast = loop.is_flow or _slow_share(columns[compared.stem.stem], compared.stem.mixture) <= FAST
    simple = float(np.max(compared.likelihoods[eligible[0]]) - compared.likelihoods[0])
    linear = compared.stem.log_likelihood - compared.command.log_likelihood
    better = min(linear, _gain_beside_a_bend(compared, columns, tried, loop, sense))
    evidence = evidence_of(better, simple)
    share = float(shares[compared.stem.stem])
    # bands that are never crossed count here: only a value that moves excludes them
    wide = shares >= LARGE
    large = float(np.max(compared.likelihoods[wide], initial=-np.inf) - compared.likelihoods[0])
    turned = int(reversals(loop.whole, BACK * loop.span))
    # a smaller band that fits better is the play that every valve has
    small = float(compared.small.log_likelihood - compared.command.log_likelihood)
    smaller = compared.small.log_likelihood - compared.stem.log_likelihood
    counts = turned >= FEWEST_TURNS and smaller <= 0.0
    return Look(
        loop,
        foreseen,
        tried,
        columns,
        sense,
        compared,
        evidence,
        float(max(better, simple)),
        share,
        turned,
        p_value(evidence, fast) if counts else 1.0,
        large,
        float(compared.likelihoods[0] - compared.silent),
        small,
        fast,
    )


def _gain_beside_a_bend(compared, columns, tried, loop, sense):
    """How much better the stem fits than the command where the valve may be curved and its gain may drift."""

    def beside(fit):
        waves = compared.waves if fit.rhythm else None
        return beside_a_bend(columns, fit, tried.stem[fit.stem], tried.ahead[fit.stem], loop, sense, waves)

    return beside(compared.stem) - beside(compared.command)


def _slow_share(columns, mixture):
    """How much of what the stem moves in the value comes late: by a long lag, or summed up."""
    sizes = np.abs(mixture) * columns.std(axis=-1)
    return float(sizes[QUICK:].sum() / (sizes.sum() or 1.0))


def _likelihood(compared):
    return max(compared.command.log_likelihood, compared.stem.log_likelihood)
