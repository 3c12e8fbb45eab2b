# SPDX-License-Identifier: BSD-3-Clause
"""How far apart a test, not yet made, would put the explanations of a recording.

The record that a program would give is simulated with one explanation and held against another, whose
parameters and calibration answer: as far as the present recording leaves them open, which its own curvature
says, and within their bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import SHARE_WRONG_BY_ONE_NOISE
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.next_test.forecast import ForecastRecord, Present
from sklvalve.simulation.fitting import Misfit
from sklvalve.simulation.robust import robust_cost, robust_weights, step_inside

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.next_test.programs import Program

# of the reweighting; and cost below which there is nothing to tell
_ROUNDS, _NOTHING = 3, 0.1


@dataclass(frozen=True, eq=False)
class Explanation:
    """A fitted hypothesis and what the present recording tells of its parameters.

    Parameters
    ----------
    name : str
    probability : float
    model : Model
    misfits : list of Misfit
        On the present recording, for the groups of channels that differ between explanations.
    """

    name: str
    probability: float
    model: Model
    misfits: list[Misfit]

    @property
    def terms(self) -> tuple[Term, ...]:
        """Effects that go on: what grows from the recording's first row on does so in the test too."""
        first = float(self.model.chain.clock[0])
        return tuple(
            Term(m.effect, first) if m.effect.grows and m.onset is None else m for m in self.model.terms
        )

    @cached_property
    def groups(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """For each group of channels: where its parameters stand, and the curvature of the cost there."""
        groups = []
        for misfit in self.misfits:
            vector = misfit.vector
            z = vector.pack(self.model.values)
            errors = misfit.errors(z)
            slopes = misfit.slopes(z, errors)
            curvature = slopes.T @ (robust_weights(errors)[:, None] * slopes)
            groups.append((z, curvature + np.diag(1e-9 / vector.scale**2)))
        return groups


class Advisor:
    """Expected distances between explanations after tests.

    Parameters
    ----------
    problem : Problem
    explanations : list of Explanation
    without : Explanation or None
        What remains of the hypothesis without the effect in question.
    gain : float
        Log likelihood that the first explanation adds to `without`.
    """

    def __init__(
        self, problem: Problem, explanations: list[Explanation], without: Explanation | None, gain: float
    ) -> None:
        self.problem, self.explanations, self.without, self.gain = problem, explanations, without, gain

    @cached_property
    def _present_record(self) -> Present:
        return Present(self.problem)

    def records(self, program: Program, sensor: str | None = None) -> list[ForecastRecord]:
        """The record that a program would give, for each explanation taken for true."""
        return [ForecastRecord(self._present_record, program, e, sensor) for e in self.explanations]

    def distances(self, program: Program, sensor: str | None = None, rounds: int = 1) -> np.ndarray:
        """Distance D of every explanation from every other after a test.

        Parameters
        ----------
        program : Program
        sensor : str, default=None
            A signal that is recorded beside those of the present recording.
        rounds : int, default=1
            How often the answer of the parameters is found anew from where it has led: once is to first
            order.

        Returns
        -------
        distances : ndarray of shape (k, k)
            Of the explanation in the column from the one in the row, where that is true; never below what
            the present recording gives.
        """
        records = self.records(program, sensor)
        rivals = [*self.explanations, *([self.without] if self.without else [])]
        costs = np.zeros((len(records), len(rivals)))
        for j, rival in enumerate(rivals):
            slopes = None
            for i, record in enumerate(records):
                if i == j:
                    continue
                answer = Answer(record, rival)
                if slopes is None or rounds > 1:
                    slopes = answer.slopes()
                costs[i, j] = answer.least(slopes, rounds)
        # a test in which the effect gains much and the pair little raises the temperature of both records;
        # but the present recording, by itself, still tells what it tells
        return np.maximum(self._pooled(costs), self._now)

    def now(self) -> np.ndarray:
        """Distances that the present recording gives, without a sign: the larger of both ways."""
        return self._now.copy()

    @cached_property
    def _now(self) -> np.ndarray:
        k = len(self.explanations)
        one_way = self._pooled(np.zeros((k, k + 1)))
        return np.maximum(one_way, one_way.T)

    def _pooled(self, costs: np.ndarray) -> np.ndarray:
        """Distances from the present recording and the test together."""
        k = len(self.explanations)
        likelihood = [e.model.log_likelihood for e in self.explanations]
        distances = np.zeros((k, k))
        for i in range(k):
            gain = self.gain + likelihood[i] - likelihood[0]
            gain += costs[i, k] if self.without else 0.0
            for j in range(k):
                if i != j:
                    distances[i, j] = distance(
                        likelihood[i], likelihood[j] - costs[i, j], gain, SHARE_WRONG_BY_ONE_NOISE
                    )
        return distances

    def spread_after(self, program: Program, name: str) -> tuple[float, ...]:
        """Standard deviation of a parameter of the first explanation before and after a test.

        Parameters
        ----------
        program : Program
        name : str
            ``effect.parameter``.
        """
        best = self.explanations[0]
        answer = Answer(ForecastRecord(self._present_record, program, best, None), best)
        for misfit, (_, curvature), slopes in zip(best.misfits, best.groups, answer.slopes(), strict=True):
            if name in misfit.vector.names:
                k, scale = misfit.vector.names.index(name), misfit.vector.scale
                both = [curvature, curvature + slopes.T @ slopes]
                inverse = [np.linalg.pinv(h * np.outer(scale, scale), hermitian=True) for h in both]
                return tuple(float(np.sqrt(max(v[k, k], 0.0)) * scale[k]) for v in inverse)
        raise KeyError(name)


class Answer:
    """How a rival explains a forecast record.

    Parameters
    ----------
    record : ForecastRecord
    rival : Explanation
    """

    def __init__(self, record: ForecastRecord, rival: Explanation) -> None:
        self.record, self.rival = record, rival
        self.chain = record.chain_of(rival)
        self.misfits = [
            Misfit(self.chain, m.vector.parameters, m.channels, record.noise, fixed=rival.model.values)
            for m in rival.misfits
        ]

    def errors(self, misfit: Misfit, z: np.ndarray) -> np.ndarray:
        """Whitened errors of a group, those of a sensor that is new included."""
        errors = misfit.whitened(misfit.predictions(z))
        if self.record.sensor is None:
            return errors
        return np.concatenate([errors, self.record.sensed(self.chain.opening(misfit.values(z)))])

    def slopes(self) -> list[np.ndarray]:
        """Derivatives of the errors where the rival's parameters stand, group by group."""
        pairs = zip(self.misfits, self.rival.groups, strict=True)
        return [self._slopes_at(misfit, z) for misfit, (z, _) in pairs]

    def _slopes_at(self, misfit: Misfit, z: np.ndarray) -> np.ndarray:
        base = self.errors(misfit, z)
        moved, reach = misfit.neighbours(z)
        columns = [(self.errors(misfit, m) - base) / r for m, r in zip(moved, reach, strict=True)]
        return np.stack(columns, axis=1)

    def least(self, slopes: list[np.ndarray], rounds: int) -> float:
        """Least cost that the rival reaches, by simulation; what the present recording says is counted in."""
        total = 0.0
        for misfit, columns, (z, curvature) in zip(self.misfits, slopes, self.rival.groups, strict=True):
            at, errors = np.zeros(len(z)), self.errors(misfit, z)
            cost = robust_cost(errors)
            for k in range(rounds):
                if cost < _NOTHING:
                    break
                columns = self._slopes_at(misfit, z + at) if k else columns
                reach = misfit.vector.low - z - at, misfit.vector.high - z - at
                step, gained = _step(columns, errors, curvature, at, *reach), 0.0
                for share in (1.0, 0.3):
                    other = at + share * step
                    tried = self.errors(misfit, z + other)
                    lower = robust_cost(tried) + 0.5 * other @ curvature @ other
                    if lower < cost:
                        gained, cost, at, errors = cost - lower, lower, other, tried
                        break
                if gained < 0.05 * cost:
                    break
            total += cost
        return float(total)


def _step(
    slopes: np.ndarray,
    errors: np.ndarray,
    curvature: np.ndarray,
    at: np.ndarray,
    lowest: np.ndarray,
    highest: np.ndarray,
) -> np.ndarray:
    """Step of parameters to the least cost of errors in proportion to them and of a quadratic about zero."""
    step = np.zeros(len(at))
    for _ in range(_ROUNDS):
        left = errors + slopes @ step
        weights = robust_weights(left)
        hessian = slopes.T @ (weights[:, None] * slopes) + curvature
        gradient = slopes.T @ (weights * left) + curvature @ (at + step)
        step = step + step_inside(hessian, gradient, lowest - step, highest - step)
    return step
