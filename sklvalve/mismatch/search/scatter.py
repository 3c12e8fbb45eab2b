# SPDX-License-Identifier: BSD-3-Clause
"""How far what one explanation gains on another is borne out over time, event by event."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.search.onset import losses_of, row_losses
from sklvalve.simulation.robust import robust_weights

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem

# stretches are longer than whatever a valve remembers, and so many that a few make a scatter
_STRETCH = 60.0
_FEWEST, _MOST = 16, 96
# what healthy recordings say of how stretches scatter counts as so many more: the strongest effects of 209
# scatter by the law of F with so many, around 1
_AS_OTHERS = 20.0


def gain_in_spreads(problem: Problem, better: Model, other: Model) -> float:
    """Log likelihood that one fit gains on another, in standard deviations of its scatter over time.

    The scatter is the recording's own, stretch by stretch (Vuong, Econometrica 57, 1989): what one event
    gained counts as one event. What is gained by a calibration nearer to what is expected of it has no
    stretches and no scatter.

    Parameters
    ----------
    problem : Problem
    better, other : Model
        Fitted under the noise of `problem`.

    Returns
    -------
    spreads : float
    """
    losses = [row_losses(problem, m, problem.channels) for m in (better, other)]
    scatter = scatter_of_sum(problem, losses[1] - losses[0])
    gain = better.log_likelihood - other.log_likelihood
    return float(gain / scatter) if scatter > 0.0 else 0.0


def scatter_of_sum(problem: Problem, rows: np.ndarray) -> float:
    """Standard deviation of the sum of what each row says, by how stretches of the recording scatter.

    Parameters
    ----------
    problem : Problem
    rows : ndarray of shape (k,)
        Of all rows, or of the last ones.
    """
    each = _by_stretch(problem, rows, _FEWEST)
    return float(np.sqrt(len(each)) * each.std(ddof=1))


@dataclass(frozen=True)
class OverTime:
    r"""How the rows that speak for an effect agree, stretch by stretch, once it is fitted.

    The derivative of the log likelihood by an effect's size is a sum over stretches. As far as the noise is
    what it is taken for, the stretches scatter by the information that each of them holds, and as far as the
    equation of the effect is wrong by a share of its size, by that share beside. Errors of the simulation
    last: where they look like the effect, its stretches disagree by more.

    Parameters
    ----------
    scatter : float, default=1
        Variance of the derivative over stretches, in multiples of what it is expected to be.
    stretches : float, default=inf
        How many stretches that hold alike much would scatter as much by chance.
    of_rows : float, default=1
        Share of what the effect gains that lies in rows; the rest, a calibration nearer to what is expected
        of it, has no stretches to agree.
    """

    scatter: float = 1.0
    stretches: float = np.inf
    of_rows: float = 1.0

    @classmethod
    def of(cls, problem: Problem, model: Model, without: Model) -> OverTime:
        """Of what one model holds beyond another, under the same noise.

        Parameters
        ----------
        problem : Problem
        model, without : Model
            With the effect, and without it.
        """
        scores, informations, losses = (np.zeros(len(problem.recording)) for _ in range(3))
        left, before = problem.residuals(model), problem.residuals(without)
        for channel, noise in problem.noise.items():
            errors = np.nan_to_num(noise.whiten(left[channel]))
            change = np.nan_to_num(noise.whiten(before[channel])) - errors
            weights = robust_weights(errors)
            scores += weights * errors * change
            informations += weights * change**2
            losses += losses_of(noise, before[channel]) - losses_of(noise, left[channel])
        score, information = _by_stretch(problem, scores), _by_stretch(problem, informations)
        gain = model.log_likelihood - without.log_likelihood
        if not np.any(information):
            return cls()
        expected = information.sum() + SHARE_WRONG**2 * np.sum(information**2)
        # of the information, as if each held the same
        stretches = information.sum() ** 2 / np.sum(information**2)
        of_rows = np.clip(np.nansum(losses) / gain, 0.0, 1.0) if gain > 0.0 else 1.0
        return cls(float(np.sum(score**2) / expected), float(stretches), float(of_rows))

    def deviations(self, gain: float) -> float:
        r"""Standard deviations of nothing by which an effect differs from it.

        .. math::
            t = \sqrt{\frac{2 g}{1 - a + a s^2}}, \quad
            s^2 = \max\left(1, \frac{\nu_0 + k r}{\nu_0 + k - 1}\right), \quad
            z = \frac{8 \nu + 1}{8 \nu + 3} \sqrt{\nu \ln\left(1 + \frac{t^2}{\nu}\right)}, \quad
            \nu = (\nu_0 + k - 1) \left(\frac{1 - a + a s^2}{a s^2}\right)^2

        with the gain g in log likelihood, the scatter r of k stretches, what other valves' stretches say
        of it, which counts as much as nu_0 (Smyth, Statistical Applications in Genetics and Molecular
        Biology 3, 2004), and the share a of the gain that lies in rows: an effect's size is known from rows
        and from what is expected of the calibration, and its variance is the sum of both. Noise that is taken
        for too small is the error that is allowed for: the scatter only takes from a gain. The last step
        gives the normal deviation that is as rare as t in a law of nu degrees of freedom (Wallace, Annals of
        Mathematical Statistics 30, 1959), as many as a sum of variances has of which one is estimated
        (Satterthwaite, Biometrics Bulletin 2, 1946).

        Parameters
        ----------
        gain : float
            In log likelihood.

        Returns
        -------
        deviations : float
            At least 0.
        """
        square = 2.0 * max(gain, 0.0)
        freedom = _AS_OTHERS + max(self.stretches - 1.0, 0.0)
        if np.isinf(freedom):
            return float(np.sqrt(square))
        by_rows = self.of_rows * max((_AS_OTHERS + self.stretches * self.scatter) / freedom, 1.0)
        variance = 1.0 - self.of_rows + by_rows
        # one over the degrees of freedom: none where nothing is estimated
        square, few = square / variance, (by_rows / variance) ** 2 / freedom
        if few * square > 1e-12:
            square = np.log1p(few * square) / few
        return float((8.0 + few) / (8.0 + 3.0 * few) * np.sqrt(square))


def _by_stretch(problem: Problem, rows: np.ndarray, fewest: int = 2) -> np.ndarray:
    """Sums of a row's values over stretches of a recording, or of its last rows."""
    clock = problem.plain.clock[-len(rows) :]
    # the time between recordings that were joined holds nothing
    length = min(clock[-1] - clock[0], len(clock) * problem.recording.sample_time)
    many = int(np.clip(length / _STRETCH, fewest, _MOST))
    return np.array([part.sum() for part in np.array_split(rows, many)])
