# SPDX-License-Identifier: BSD-3-Clause
"""One table of all hypotheses: how well each explains the recording, and why this one and not that.

A recording may lack several effects at once. Each stands in a place of its own, and in every place the
hypotheses compete: the effects that were fitted there beside what stands in the other places, and nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.mismatch.constants import IN_CLASS
from sklvalve.mismatch.decide.records import plain_records
from sklvalve.mismatch.inference.hypothesis import Model, Term, complexity_penalty
from sklvalve.mismatch.inference.posterior import posterior, temperature
from sklvalve.mismatch.inference.refitting import BLOCKS, blocks_in_turn, fits_without
from sklvalve.mismatch.search.onset import losses_of, penalty_with_times

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.explain import Explanation
    from sklvalve.mismatch.search.rivals import Finding

NOTHING = "nothing"
# rows of a place that are kept beside nothing, and those that are held against rows left out of the fit
_KEPT, _HELD_OUT = 12, 3
_WITHIN_95 = 1.96


@dataclass(frozen=True)
class Row:
    """One hypothesis in one place.

    Attributes
    ----------
    place : int
        From 1 on, the strongest difference first.
    rank : int
        Within the place, by posterior probability, from 1 on.
    hypothesis : str
        Name of the effect, or ``"nothing"``.
    form : str
        Which form of the effect; ``""`` of nothing.
    time_profile : {"throughout", "from onset", "intermittent", "growing", ""}
    in_class : bool
        Whether it is of the smallest set that holds 0.95 of the probability.
    channel : str
        Signal that it changes most, in multiples of what counts there.
    size : float
        That change, rms where it acts, share of the signal's span [1].
    size_ci95 : tuple of float or None
        What noise leaves open of the size; None where it was not fitted to the end, or where its first
        parameter says where or when it acts and not how much.
    size_over_relevance : float
        The size in multiples of what counts [1].
    log_likelihood : float or None
        What it gains on nothing in the same place [nat]: the best by the noise that it leaves, the others as
        much less as each by its own; None of events, which no likelihood tells.
    log_evidence : float or None
        The same less what its parameters and its times cost [nat].
    posterior : float
        Probability among the hypotheses of the place, under the error that simulations have.
    held_out_gain, held_out_se : float or None
        What it gains on nothing in rows left out of its fit, and the standard error of that by blocks [nat];
        None but for the likeliest.
    stands : bool
        Whether the place is that of an effect of the diagnosis; the others were tried, and not named.
    tempering : float or None
        T, by which differences of log evidence are divided on the way to the posterior, one for a place [1];
        None where there is no evidence, as of events.
    """

    place: int
    rank: int
    hypothesis: str
    form: str
    time_profile: str
    in_class: bool
    channel: str
    size: float
    size_ci95: tuple[float, float] | None
    size_over_relevance: float
    log_likelihood: float | None
    log_evidence: float | None
    posterior: float
    held_out_gain: float | None = None
    held_out_se: float | None = None
    stands: bool = False
    tempering: float | None = None


@dataclass(frozen=True)
class Comparison:
    """The table.

    Attributes
    ----------
    rows : tuple of Row
        Place by place, the likeliest first.
    """

    rows: tuple[Row, ...] = ()

    def in_order_of(self, problem: Problem, findings: Sequence[Finding]) -> Comparison:
        """The table by the effects of a diagnosis: their places first, in their order, then all others.

        An effect that was found outside of the search, such as by events, gets a place of its explanations.
        """
        places = [list(rows) for _, rows in groupby(self.rows, key=lambda row: row.place)]
        chosen: list[list[Row]] = []
        for finding in findings:
            matched = _place_of(finding, places)
            if matched is None:
                chosen.append(_rows_of_rivals(problem, finding))
            else:
                places.remove(matched)
                chosen.append([replace(row, stands=True) for row in matched])
        numbered = enumerate([*chosen, *places], start=1)
        return Comparison(tuple(replace(row, place=place) for place, rows in numbered for row in rows))

    def behind(self, other: Comparison) -> Comparison:
        """The rows of another table, and those of this one in the places behind them."""
        first = max((row.place for row in other.rows), default=0)
        moved = [replace(row, place=row.place + first) for row in self.rows]
        return Comparison((*other.rows, *moved))

    def held_out_errors(self, place: int) -> float:
        """Gain of the best member of a class on rows left out of its fit, in standard errors."""
        gains = [
            row.held_out_gain / max(row.held_out_se, 1e-12)
            for row in self.rows
            if row.place == place
            and row.in_class
            and row.held_out_gain is not None
            and row.held_out_se is not None
        ]
        return max(gains, default=0.0)

    def to_records(self) -> list[dict[str, Any]]:
        """The rows as plain data, numbers with four digits."""
        return plain_records(self.rows)


def _place_of(finding: Finding, places: list[list[Row]]) -> list[Row] | None:
    """The rows of a place in which a finding's likeliest effect is of the class; None where there is none."""
    key = max(finding.rivals, key=lambda rival: rival.probability).term.effect.key
    able = [rows for rows in places if any(row.form == key and row.in_class for row in rows)]
    return max(able, key=lambda rows: max(r.posterior for r in rows if r.form == key), default=None)


def _rows_of_rivals(problem: Problem, finding: Finding) -> list[Row]:
    """Rows of a finding that the search's table does not hold, by its own explanations."""
    # each by its own noise, as in the search's table: log likelihoods by several noises are not compared
    best = max(rival.gain for rival in finding.rivals)
    rows: list[Row] = []
    before = 0.0
    for rank, rival in enumerate(sorted(finding.rivals, key=lambda r: -r.probability)[:_KEPT], start=1):
        known = finding.gain > 0.0
        gain = finding.gain + rival.gain - best if known else None
        one = _Competitor(rival.term, rival.model, gain or 0.0, finding.sizes)
        row = _of_effect(problem, one, None) | {"log_likelihood": gain}
        evidence = None if gain is None else gain - _penalty(problem, one)
        shared: dict[str, Any] = {
            "rank": rank,
            "in_class": before < IN_CLASS,
            "log_evidence": evidence,
            "tempering": temperature(best) if known else None,
        }
        rows.append(Row(**row, **shared, place=0, posterior=rival.probability, stands=True))
        before += rival.probability
    return rows


EMPTY = Comparison()


def compared(explanation: Explanation, threshold: float) -> Comparison:
    """The table of a search, under the noise that it ended with.

    Parameters
    ----------
    explanation : Explanation
    threshold : float
        Log odds before any data that nothing is missing, against any one effect: what an effect must add to
        be taken up [nat].

    Returns
    -------
    comparison : Comparison
        Where nothing was found, one place with what was tried.
    """
    if not explanation.findings:
        return Comparison(tuple(_tried(explanation, threshold)))
    numbered = enumerate(explanation.findings, start=1)
    rows = (row for place, f in numbered for row in _rows_of(explanation, f, place, threshold))
    return Comparison(tuple(rows))


def _rows_of(explanation: Explanation, finding: Finding, place: int, threshold: float) -> list[Row]:
    """Rows of the place of a finding."""
    problem = explanation.problem
    others = tuple(m for m in explanation.model.terms if m is not finding.term)
    without = problem.fit(others, start=explanation.model)
    # explanations differ as each one's own noise has it; nothing is held against the best by that one's noise
    best = max(r.gain for r in finding.rivals)
    made = [
        _Competitor(
            r.term,
            r.model,
            finding.gain + r.gain - best,
            problem.change(r.model, problem.baseline(r.model, others, without)),
        )
        for r in finding.rivals
    ]
    held_out = HeldOut(problem, without)
    return _ranked(problem, made, place, threshold, best, held_out)


def _tried(explanation: Explanation, threshold: float) -> list[Row]:
    """Rows of what was tried where nothing was found."""
    by_key = {e.key: e for e in explanation.effects}
    made = [
        _Competitor(Term(by_key[key]), None, tried.gain, tried.sizes)
        for key, tried in explanation.tried.items()
        if key in by_key
    ]
    gain = max((c.gain for c in made), default=0.0)
    return _ranked(explanation.problem, made, 1, threshold, gain, None)


@dataclass(frozen=True, eq=False)
class _Competitor:
    term: Term
    model: Model | None
    gain: float
    sizes: dict[str, float]


def _penalty(problem: Problem, one: _Competitor) -> float:
    """What a row must earn: as the search has it, where that has fitted the row by all that is known."""
    if one.model is None:
        return complexity_penalty(problem, one.term)
    return penalty_with_times(problem, one.model, one.term)


def _ranked(
    problem: Problem,
    made: list[_Competitor],
    place: int,
    threshold: float,
    explained: float,
    held_out: HeldOut | None,
) -> list[Row]:
    scores = np.array([0.0, *(c.gain - _penalty(problem, c) for c in made)])
    before_data = np.array([threshold, *[0.0] * len(made)])
    probabilities = posterior(scores + before_data, explained)
    order = np.argsort(-probabilities, kind="stable")
    rows: list[Row] = []
    before = 0.0
    for rank, k in enumerate(order.tolist(), start=1):
        probability = float(probabilities[k])
        shared: dict[str, Any] = {
            "place": place,
            "rank": rank,
            "in_class": before < IN_CLASS,
            "posterior": probability,
            "tempering": temperature(explained),
            "log_evidence": float(scores[k]),
        }
        before += probability
        if k == 0:
            rows.append(Row(**_OF_NOTHING, **shared))
        elif rank <= _KEPT:
            tried = held_out if rank <= _HELD_OUT else None
            rows.append(Row(**_of_effect(problem, made[k - 1], tried), **shared))
    return rows


def _of_effect(problem: Problem, one: _Competitor, held_out: HeldOut | None) -> dict[str, Any]:
    """What a row says of an effect."""
    gain, error = held_out.gain(one.model) if held_out and one.model else (None, None)
    return {
        "hypothesis": one.term.effect.name,
        "form": one.term.effect.key,
        "time_profile": _profile(one.term),
        "log_likelihood": one.gain,
        "held_out_gain": gain,
        "held_out_se": error,
        **_size(problem, one),
    }


_OF_NOTHING: dict[str, Any] = {
    "hypothesis": NOTHING,
    "form": "",
    "time_profile": "",
    "channel": "",
    "size": 0.0,
    "size_ci95": None,
    "size_over_relevance": 0.0,
    "log_likelihood": 0.0,
}


def _profile(term: Term) -> str:
    if term.effect.grows:
        return "growing"
    if term.onset is None:
        return "throughout"
    return "intermittent" if term.switches else "from onset"


def _size(problem: Problem, one: _Competitor) -> dict[str, Any]:
    """Size of the change in the channel where it counts most, and how well noise lets it be known."""
    if not one.sizes:
        return {"channel": "", "size": 0.0, "size_ci95": None, "size_over_relevance": 0.0}
    multiples = {channel: size / problem.least(channel) for channel, size in one.sizes.items()}
    channel = max(multiples, key=lambda c: multiples[c])
    size, spread = one.sizes[channel], _relative_spread(one)
    ends = None
    if spread is not None:
        ends = max(size * (1.0 - _WITHIN_95 * spread), 0.0), size * (1.0 + _WITHIN_95 * spread)
    return {
        "channel": channel,
        "size": size,
        "size_ci95": ends,
        "size_over_relevance": multiples[channel],
    }


def _relative_spread(one: _Competitor) -> float | None:
    """Standard deviation of an effect's first parameter, share of its size; None where it is not known."""
    if one.model is None:
        return None
    first = one.term.effect.quantities(one.model.chain)[0]
    name = f"{one.term.effect.key}.{first.name}"
    spread = one.model.spreads.get(name)
    if spread is None or first.null is None:
        return None
    size = abs(one.model.values[name] - first.null)
    relative = spread if first.log else spread / max(size, 1e-300)
    return relative if np.isfinite(relative) else None


class HeldOut:
    """Gains of hypotheses on rows that were left out of their fits.

    Parameters
    ----------
    problem : Problem
    without : Model
        What they are compared with.
    """

    def __init__(self, problem: Problem, without: Model) -> None:
        self._problem, self._without = problem, without
        self._block = blocks_in_turn(len(problem.recording))
        self._of_nothing: np.ndarray | None = None

    def gain(self, model: Model) -> tuple[float, float]:
        """Log likelihood that a hypothesis gains on such rows, and its standard error by blocks [nat]."""
        if self._of_nothing is None:
            self._of_nothing = self._losses(self._without)
        gained = self._of_nothing - self._losses(model)
        return float(gained.sum()), float(np.sqrt(BLOCKS) * gained.std(ddof=1))

    def _losses(self, model: Model) -> np.ndarray:
        """Robust losses of every block, each predicted by a fit to the blocks of other folds."""
        problem, block, losses = self._problem, self._block, np.zeros(BLOCKS)
        for held, fit in fits_without(problem, model):
            left = problem.residuals(fit)
            for channel in problem.channels:
                rows = losses_of(problem.noise[channel], left[channel])
                losses += np.bincount(block[held], rows[held], minlength=BLOCKS)
        return losses
