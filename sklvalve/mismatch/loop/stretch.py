# SPDX-License-Identifier: BSD-3-Clause
"""One stretch of a loop: the command itself against every stem that sticks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import sklvalve.mismatch.loop.constants as constants
from sklvalve.mismatch.loop.fit import Comparison, LoopFit, Regression, fit_stems, likeliest
from sklvalve.mismatch.loop.operators import Candidates, candidate_stems, count_reversals
from sklvalve.mismatch.loop.process import QUICK_RESPONSES, forecast_command, responses
from sklvalve.mismatch.loop.signals import LoopSignals
from sklvalve.mismatch.loop.varying_gain import likelihood_with_varying_gain


@dataclass(frozen=True, eq=False)
class StretchResult:
    """What a stretch says. Gains are differences of log likelihood from the command itself [nats].

    Parameters
    ----------
    loop : LoopSignals
    forecast : ndarray of shape (n,)
        Of the command, from the rows before [fraction of travel].
    candidates : Candidates
    comparison : Comparison
        Under the likelier sign of the process gain.
    evidence : float
        Gain of the best stem that sticks; see `evidence_of` [nats].
    largest_gain : float
        The most that any noise says for a relevant band, before anything is taken off [nats].
    band_share : float
        Band of that stem, as a share of the command's movement [1].
    turns : int
        How often the command turns and goes back by 30 % of its movement.
    p_value : float
        How often a healthy loop gives as much evidence.
    small_band_gain : float
        Of the best smaller band [nats].
    response_gain : float
        How much better the command fits than no response at all [nats].
    """

    loop: LoopSignals
    forecast: NDArray
    candidates: Candidates
    comparison: Comparison
    evidence: float
    largest_gain: float
    band_share: float
    turns: int
    p_value: float
    small_band_gain: float
    response_gain: float


def examine_stretch(loop: LoopSignals) -> StretchResult:
    """Compare the command itself with every stem that sticks, on one stretch."""
    forecast = forecast_command(loop.command, loop.value, loop.setpoint)
    candidates = candidate_stems(loop, forecast)
    shares = candidates.stick / loop.span
    relevant = shares >= constants.RELEVANT_BAND
    comparison = _likelier_sign(loop, candidates, relevant, ~relevant & (shares > 0.0))
    screened, command = comparison.screening.log_likelihoods, comparison.command.log_likelihood
    sticking, small = comparison.sticking.log_likelihood, comparison.small_band.log_likelihood
    simple = float(np.max(screened[relevant]) - screened[0])
    gain = min(sticking - command, _gain_with_varying_gain(comparison, candidates, loop))
    evidence = evidence_of(gain, simple)
    turns = int(count_reversals(loop.recorded_command, constants.TURN_SIZE * loop.span))
    # a smaller band that fits better is the play that every valve has
    counts = turns >= constants.FEWEST_TURNS and small - sticking <= 0.0
    return StretchResult(
        loop=loop,
        forecast=forecast,
        candidates=candidates,
        comparison=comparison,
        evidence=evidence,
        largest_gain=float(max(gain, simple)),
        band_share=float(shares[comparison.sticking.index]),
        turns=turns,
        p_value=p_value_of(evidence, _is_fast(loop, comparison.sticking)) if counts else 1.0,
        small_band_gain=float(small - command),
        response_gain=float(screened[0] - comparison.screening.without_response),
    )


def evidence_of(gain: float, simple: float) -> float:
    """Evidence that a stem sticks [nats].

    Where the simpler noise speaks against it, that is taken off: a level whose controller answers at once is
    explained by any stem under a long autoregression.

    Parameters
    ----------
    gain : float
        How much better the stem fits than the command itself [nats]: the lesser of that with a linear process
        and that where the valve may be curved and its gain may drift. Friction shows itself in both; what a
        healthy loop lends to it goes where the process may take another form.
    simple : float
        The same under a wander with white noise alone [nats].
    """
    return float(gain + min(simple, 0.0))


def p_value_of(evidence: float, fast: bool) -> float:
    """Survival function of the evidence [nats] of a relevant band in healthy loops, drawn at random.

    `fast` says that the value follows the stem at once, as a flow does. No p-value is below 0.0001: nothing
    is known of rarer loops.
    """
    known = constants.NULL_EVIDENCE[:, 1 if fast else 2]
    return float(np.exp(np.interp(evidence, known, np.log(constants.NULL_EVIDENCE[:, 0]))))


def _likelier_sign(
    loop: LoopSignals, candidates: Candidates, relevant: NDArray[np.bool_], small: NDArray[np.bool_]
) -> Comparison:
    """The comparison under the sign of the process gain that explains the value best."""
    columns = responses(candidates.stem, candidates.stem_forecast, not loop.is_flow)
    regressions = (Regression(columns, loop.value, loop.used, sign) for sign in loop.gain_signs)
    comparisons = [fit_stems(regression, relevant, small) for regression in regressions]
    return max(comparisons, key=lambda c: likeliest([c.command, c.sticking]).log_likelihood)


def _gain_with_varying_gain(comparison: Comparison, candidates: Candidates, loop: LoopSignals) -> float:
    """How much better the stem fits than the command where the valve may be curved and its gain may drift."""

    def likelihood(fit: LoopFit) -> float:
        stems = candidates.stem[fit.index], candidates.stem_forecast[fit.index]
        return likelihood_with_varying_gain(fit, *stems, not loop.is_flow)

    return likelihood(comparison.sticking) - likelihood(comparison.command)


def _is_fast(loop: LoopSignals, fit: LoopFit) -> bool:
    """Whether the value follows the stem as a flow does: little comes by a long lag, or summed up."""
    sizes = np.abs(fit.weights) * fit.regression.responses[fit.index].std(axis=-1)
    slow = float(sizes[QUICK_RESPONSES:].sum() / (sizes.sum() or 1.0))
    return loop.is_flow or slow <= constants.FAST_SHARE
