# SPDX-License-Identifier: BSD-3-Clause
"""A recording forecast from its own past: fitted to rows before an origin, held against those after it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.inference.origins import spans_of
from sklvalve.mismatch.inference.refitting import lines_of, refitted
from sklvalve.mismatch.proof.black_box import black_box_ahead
from sklvalve.mismatch.proof.feedback import ANSWERS_FROM, answers, driver_of
from sklvalve.mismatch.residual.low_pass_residual import learn_residual
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.simulation import learnt_rest

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Term
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.unknown import Unknown

# of the rows before an origin, an effect must have acted in so many to be known there
_KNOWN_FROM = 0.05


@dataclass(frozen=True, eq=False)
class Forward:
    """Forecasts of a recording, each row by fits to rows before it.

    Parameters
    ----------
    predictions : dict
        ``nominal, corrected, black_box`` -> channel -> ndarray of shape (n,) [SI]; NaN before the
        first origin.
    spans : tuple of slice
        Rows between one origin and the next.
    closed : dict
        Channel -> whether a controller answers it by what its black box reads.
    """

    predictions: dict[str, dict[str, np.ndarray]]
    spans: tuple[slice, ...]
    closed: dict[str, bool]

    @property
    def held(self) -> np.ndarray:
        """Rows that are forecast, ndarray of bool of shape (n,)."""
        first = next(iter(self.predictions["nominal"].values()))
        rows = np.zeros(len(first), dtype=bool)
        rows[self.spans[0].start :] = True
        return rows


def forward_in_time(
    problem: Problem, nominal: Model, model: Model, unknown: Unknown | None = None
) -> Forward:
    """Forecasts by the calibrated nominal, a hypothesis and the black box.

    Parameters
    ----------
    problem : Problem
    nominal, model : Model
        Fitted to all rows; refitted by one step to those before each origin.
    unknown : Unknown, default=None
        The residual that is learnt beside `model`.

    Returns
    -------
    forward : Forward
    """
    n = len(problem.recording)
    spans = spans_of(n)
    made = {"nominal": forecast(problem, nominal, spans)}
    same = model is nominal and unknown is None
    made["corrected"] = (
        made["nominal"] if same else forecast(problem, model, spans, unknown=unknown, nominal=nominal)
    )
    for c in problem.channels:
        # a signal that nothing found changes is simulated as before
        untouched = np.array_equal(model.predictions[c], nominal.predictions[c], equal_nan=True)
        if untouched and (unknown is None or unknown.channel != c):
            made["corrected"][c] = made["nominal"][c]
    closed = {c: closed_loop(problem, nominal, c) for c in problem.channels}
    made["black_box"] = {
        c: black_box_ahead(problem.recording, c, spans, closed=closed[c]) for c in problem.channels
    }
    return Forward(made, spans, closed)


def closed_loop(problem: Problem, nominal: Model, channel: str) -> bool:
    """Whether a controller answers a channel by what its black box reads.

    A recorded opening, with the pressures, says itself what drives a flow; where the drop is unknown the
    controller answers it by the opening.
    """
    recording = problem.recording
    driver = driver_of(recording, channel)
    if driver == "opening" and not drop_is_unknown(recording):
        return False
    simulated = nominal.predictions[channel]
    return answers(recording[driver], recording[channel], simulated) >= ANSWERS_FROM


def forecast(
    problem: Problem,
    model: Model,
    spans: Sequence[slice],
    *,
    unknown: Unknown | None = None,
    nominal: Model | None = None,
) -> dict[str, np.ndarray]:
    """A hypothesis fitted to the rows before each of some spans, and simulated there.

    An effect that begins too late for those rows to tell of it is left out. Where none is left the `nominal`
    is forecast, if given: a span in which no effect takes part says nothing for or against one.

    Returns
    -------
    made : dict
        Channel -> ndarray of shape (n,); NaN outside the spans [SI].
    """
    n = len(problem.recording)
    made = {c: np.full(n, np.nan) for c in problem.channels}
    fits: dict[tuple[Term, ...], Model] = {} if nominal is None else {(): nominal}
    before = _by_history(problem, model if nominal is None else nominal)
    for span in spans:
        past = np.arange(n) < span.start
        known = _known_at(model, span.start)
        if known.terms not in fits:
            fits[known.terms] = model if known is model else problem.least_squares(known)
        fitted = fits[known.terms]
        judge = problem.homoscedastic(fitted, past) if before is None else before
        lines = lines_of(judge, fitted)
        again = problem.simulate(fitted.terms, refitted(problem, fitted, lines, past))
        for c in problem.channels:
            made[c][span] = again.predictions[c][span]
        part = None if unknown is None else learn_residual(problem, again, unknown, past)
        if unknown is not None and part is not None:
            made[unknown.channel][span] += learnt_rest(part, again.chain, again.values)[span]
    return made


def _by_history(problem: Problem, model: Model) -> Problem | None:
    """A problem with a history by the noise that a model leaves; None without a history.

    Plain least squares take every row for news and draw a calibration from what its history knows, and the
    noise of the best explanation makes little of a poor one's errors.
    """
    return None if problem.history is None else problem.with_noise_of(model, cautious=True)


def _known_at(model: Model, origin: int) -> Model:
    """A hypothesis without the effects that begin too late for rows before an origin to tell of them."""
    clock = model.chain.clock
    last = clock[0] + (1.0 - _KNOWN_FROM) * (clock[max(origin - 1, 0)] - clock[0])
    terms = tuple(m for m in model.terms if m.onset is None or m.onset <= last)
    return model if len(terms) == len(model.terms) else replace(model, terms=terms)
