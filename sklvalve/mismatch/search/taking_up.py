# SPDX-License-Identifier: BSD-3-Clause
"""Effects taken up one after the other, as long as the recording asks for one more."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeVar

from sklvalve.mismatch.constants import DETECTABLE
from sklvalve.mismatch.inference.hypothesis import Model, Term, is_in
from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.search.extended import extended
from sklvalve.mismatch.search.own_noise import (
    explains_as_much,
    penalised_across_noises,
    penalised_by_its_noise,
)
from sklvalve.mismatch.search.relevance import beyond_tolerance, is_relevant, may_explain
from sklvalve.mismatch.search.restart import much_is_left, restarted
from sklvalve.mismatch.search.scatter import OverTime
from sklvalve.mismatch.search.settling import settled_fit
from sklvalve.simulation.given import ACTUATOR_STAGES

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.extended import Report
    from sklvalve.mismatch.search.rivals import Finding

# of the effects fitted so many are settled under their own noise
_TRIED = 6


@dataclass(frozen=True)
class Tried:
    """What an effect would gain as the first one.

    Parameters
    ----------
    gain : float
        Log likelihood that it adds to the calibrated simulation.
    sizes : dict
        Channel -> change that it makes, share of span [1].
    by_beginning : float or None, default=None
        Of one that begins within the recording: log likelihood that it gains over the likeliest effect that
        acts throughout. None of one that acts throughout.
    stage : str, default=""
        Of the effect.
    over_time : OverTime
        How the stretches of the recording agree on it.
    """

    gain: float
    sizes: dict[str, float]
    by_beginning: float | None = None
    stage: str = ""
    over_time: OverTime = field(default_factory=OverTime)


#: Whether a hypothesis leaves over more in some channels than a healthy valve does beside its history.
LeavesMuch = Callable[["Problem", "Model", Collection[str]], bool]
_Gained = TypeVar("_Gained", Tried, "Finding")


class Search:
    """Effects taken up one after the other, and what was met on the way.

    Parameters
    ----------
    effects, threshold, most, report, leaves_much
        As `explain` takes them.

    Attributes
    ----------
    tried : dict
        Effect key -> what the effect would gain as the first one.
    acting : dict
        As `Explanation` has it.
    throughout : Model or None
        The likeliest with one effect, or with none, that acts throughout.
    gain_throughout : float
        Log likelihood that its effect adds.
    nominal : Model or None
        The simulation without effects, with the best calibration met.
    met : list of Model
        Every hypothesis that was settled by its own noise.
    """

    def __init__(
        self,
        effects: Sequence[Effect],
        threshold: float,
        most: int,
        report: Report | None,
        leaves_much: LeavesMuch | None,
    ) -> None:
        self.effects, self.threshold = effects, threshold
        self.most, self.report, self.leaves_much = most, report, leaves_much
        self.tried: dict[str, Tried] = {}
        self.acting: dict[str, Tried] = {}
        self.throughout: Model | None = None
        self.gain_throughout = 0.0
        self.nominal: Model | None = None
        self.met: list[Model] = []

    def with_its_beginning(self, problem: Problem, gained: _Gained, model: Model, term: Term) -> _Gained:
        """What a term of a hypothesis gains, with what of it is gained by beginning within the recording.

        A valve that is not as it was known differs throughout: that it began then is what is gained beyond.
        Where the hypothesis holds more terms, these have taken up what differs throughout.
        """
        if term.onset is None:
            return gained
        if len(model.terms) > 1 or self.throughout is None:
            return replace(gained, by_beginning=gained.gain)
        over_time = OverTime.of(problem, model, problem.judged(self.throughout))
        return replace(gained, by_beginning=max(gained.gain - self.gain_throughout, 0.0), over_time=over_time)

    def taken_up(self, problem: Problem, model: Model) -> tuple[Problem, Model]:
        """A hypothesis with one effect after the other taken up, as long as they matter."""
        first = not self.tried and not model.terms
        met = {_effects_of(model)}
        while len(model.terms) < self.most:
            problem, model, settled = self._next_effect(problem, model, first=first and not model.terms)
            if settled is None:
                break
            model = drop_what_no_longer_counts(problem, settled, self.threshold)
            problem = problem.with_noise_of(model, cautious=True)
            model = problem.fit(model.terms, start=model)
            effects = _effects_of(model)
            if effects in met:
                # each under the noise of the other, two effects could take each other's place for ever
                break
            met.add(effects)
        return problem, model

    def _next_effect(
        self, problem: Problem, model: Model, *, first: bool
    ) -> tuple[Problem, Model, Model | None]:
        """A hypothesis so far, and with one effect more that matters; else None."""
        done = len(model.terms) / (self.most + 1)
        candidates, acting = extended(problem, model, self.effects, self.report, done)
        if first:
            calibrated = self._calibrated_anew(problem, model, candidates)
            if calibrated is not model:
                problem = problem.with_noise_of(calibrated, cautious=True)
                model = problem.fit((), start=calibrated)
                candidates, acting = extended(problem, model, self.effects, self.report, done)
            self.nominal = model
            self.throughout = max((model, *acting[:1]), key=lambda m: m.log_likelihood)
            self.gain_throughout = self.throughout.log_likelihood - model.log_likelihood
            self._note_what_acts(problem, acting, model)
            # what a data sheet leaves open is no mismatch, however clear it is
            beyond = [m for m in candidates if beyond_tolerance(problem, m, m.terms[-1])]
            for m in beyond:
                self._note(problem, m, model)
        promising = [m for m in candidates if is_relevant(problem, m, model, self.threshold)]
        problem, settled = self._likeliest_that_counts(problem, model, promising)
        if settled is None and much_is_left(problem, model):
            elsewhere = restarted(problem, model, [e for e in self.effects if not is_in(e, model.terms)])
            problem, settled = self._likeliest_that_counts(problem, model, elsewhere)
        return problem, model, settled

    def _note(self, problem: Problem, model: Model, without: Model) -> None:
        """Keep what the only effect of a hypothesis gains."""
        term, gained = model.terms[-1], _gained(problem, model, without)
        self.tried[term.effect.key] = self.with_its_beginning(problem, gained, model, term)

    def _note_what_acts(self, problem: Problem, acting: Sequence[Model], without: Model) -> None:
        """Keep what is gained by the likeliest effect that acts throughout, of the stem's and of the others.

        One that fits better with a beginning gains by that only what it gains beyond.
        """
        for of_stem in (True, False):
            some = (m for m in acting if (m.terms[-1].effect.stage in ACTUATOR_STAGES) == of_stem)
            best = next((m for m in some if beyond_tolerance(problem, m, m.terms[-1])), None)
            if best is not None:
                self.acting[best.terms[-1].effect.key] = _gained(problem, best, without)

    def _calibrated_anew(self, problem: Problem, nominal: Model, candidates: Sequence[Model]) -> Model:
        """The simulation without effects from where the best of these have led its calibration, if better.

        A calibration may lie in a valley of its own. What only leads out of it explains nothing.
        """
        enough = nominal.log_likelihood + self.threshold
        fits = [problem.fit((), start=m) for m in candidates[:_TRIED] if m.log_likelihood > enough]
        best = max((nominal, *fits), key=lambda m: m.log_likelihood)
        return best if best.log_likelihood > enough else nominal

    def _likeliest_that_counts(
        self, problem: Problem, model: Model, candidates: Sequence[Model]
    ) -> tuple[Problem, Model | None]:
        """The likeliest hypothesis with one effect more that matters, each by its own noise; else None."""
        counting: list[tuple[Problem, Model]] = []
        for chosen in _in_reach(candidates, model):
            by_its_noise, settled = settled_fit(problem, chosen)
            self.met.append(settled)
            without = by_its_noise.fit(settled.terms[:-1], start=model)
            if is_relevant(by_its_noise, settled, without, self.threshold):
                counting.append((by_its_noise, settled))
                continue
            # what a data sheet leaves open, or is absurd, speaks for no mismatch however much it gains
            if not model.terms and may_explain(by_its_noise, settled, without):
                self._note(problem, settled, without)
        if model.terms and counting:
            counting = self._adding(problem, model, counting)
        nothing = problem.with_noise_of(model, cautious=True), None
        return max(counting, key=lambda one: penalised_across_noises(*one)) if counting else nothing

    def _adding(
        self, problem: Problem, model: Model, counting: Sequence[tuple[Problem, Model]]
    ) -> list[tuple[Problem, Model]]:
        """Hypotheses with one effect more that are no other name for one, by the noise that each leaves.

        Noise learnt anew may take up what an effect would explain. A history knows better what noise is: one
        that leaves more than a healthy valve does asks for an effect more by that alone.
        """
        touched = [frozenset(problem.touched_by(m.terms[-1:])) for _, m in counting]
        much: set[frozenset[str]] = set()
        if self.leaves_much is not None:
            # in signals of its own an effect is no other name for what was taken up
            shared = {channels for channels in touched if channels & problem.touched_by(model.terms)}
            much = {channels for channels in shared if self.leaves_much(problem, model, channels)}
        so_far = 0.0 if much.issuperset(touched) else penalised_by_its_noise(problem, model)

        def asks(channels: frozenset[str], other: Model) -> bool:
            if channels in much:
                return True
            of_other = penalised_by_its_noise(problem, other)
            return not explains_as_much(problem, model, other.terms[-1], so_far, of_other)

        return [one for channels, one in zip(touched, counting, strict=True) if asks(channels, one[1])]


def _effects_of(model: Model) -> frozenset[tuple[str, bool]]:
    """Effects of a hypothesis, and whether each begins within the recording."""
    return frozenset((term.effect.key, term.onset is not None) for term in model.terms)


def _gained(problem: Problem, model: Model, without: Model) -> Tried:
    """What the only effect of a hypothesis gains."""
    sizes = problem.change(model, problem.baseline(model, without.terms, without))
    stage, over_time = model.terms[-1].effect.stage, OverTime.of(problem, model, without)
    return Tried(model.log_likelihood - without.log_likelihood, sizes, stage=stage, over_time=over_time)


def _in_reach(candidates: Sequence[Model], model: Model) -> list[Model]:
    """Of hypotheses with one effect more those that may be the likeliest by their own noise."""
    if not candidates:
        return []
    best = max(m.log_likelihood for m in candidates)
    gain = best - model.log_likelihood
    near = [m for m in candidates if distance(best, m.log_likelihood, gain) < DETECTABLE]
    return near[:_TRIED]


def drop_what_no_longer_counts(
    problem: Problem, model: Model, threshold: float, *, last_too: bool = False
) -> Model:
    """A hypothesis without the effects that it no longer needs, the last one kept unless asked for.

    Parameters
    ----------
    problem : Problem
    model : Model
    threshold : float
        As `explain` takes it.
    last_too : bool, default=False

    Returns
    -------
    model : Model
    """
    for term in model.terms if last_too else model.terms[:-1]:
        without = problem.fit(tuple(m for m in model.terms if m is not term), start=model)
        again = problem.fit((*without.terms, term), start=model)
        if not (is_relevant(problem, again, without, threshold) and beyond_tolerance(problem, model, term)):
            model = without
    return model
