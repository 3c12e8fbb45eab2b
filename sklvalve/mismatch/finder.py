# SPDX-License-Identifier: BSD-3-Clause
"""The estimator that goes from a recording to its diagnosis, one step after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import partial
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from sklearn.base import BaseEstimator, _fit_context
from sklearn.utils import check_random_state
from sklearn.utils._param_validation import HasMethods, Interval
from sklearn.utils.validation import check_is_fitted
from threadpoolctl import threadpool_limits

from sklvalve._refits import whole_or_nothing
from sklvalve.history import ValveHistory
from sklvalve.history.compatible import require_compatible
from sklvalve.history.learnable import is_learnable, recordings_of, require_learnable, require_no_loop
from sklvalve.history.rehearsal import Rehearsal
from sklvalve.mismatch.data.gate import blocking
from sklvalve.mismatch.data.gathering import gathered
from sklvalve.mismatch.data.masking import masked
from sklvalve.mismatch.data.preparation import (
    candidates,
    hidden_by_data,
    lasting,
    prepared_problem,
    rows_to_use,
)
from sklvalve.mismatch.decide import rules
from sklvalve.mismatch.decide.behind import judged_behind
from sklvalve.mismatch.decide.case import Case
from sklvalve.mismatch.decide.compare import compared
from sklvalve.mismatch.decide.dated import dated
from sklvalve.mismatch.decide.decision import decided
from sklvalve.mismatch.decide.detect import covariates_of, leaves_much
from sklvalve.mismatch.decide.detection_limits import detection_limits
from sklvalve.mismatch.decide.judging import blocked, judge
from sklvalve.mismatch.decide.kinds import with_kinds
from sklvalve.mismatch.decide.known_before import known_before
from sklvalve.mismatch.decide.late import before, late_event, with_late_event
from sklvalve.mismatch.decide.referee import refereed
from sklvalve.mismatch.decide.rehearsing import rehearsed
from sklvalve.mismatch.decide.stretches import over_the_whole, stretches_of
from sklvalve.mismatch.decide.suppression import suppressed
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.inference.hypothesis import is_in
from sklvalve.mismatch.loop import diagnose_loop, is_loop, loop_content, loop_traces
from sklvalve.mismatch.next_test.suggestions import plan_of
from sklvalve.mismatch.result.by_itself import by_itself
from sklvalve.mismatch.result.contents import content_of, flagged_rows
from sklvalve.mismatch.result.diagnosis import Diagnosis
from sklvalve.mismatch.result.effect_entry import effect_entry
from sklvalve.mismatch.result.fit_entries import fit_entries
from sklvalve.mismatch.result.traces import traces_of
from sklvalve.mismatch.search.events import effects_to_search, evident_events
from sklvalve.mismatch.search.explain import explain
from sklvalve.mismatch.search.rivals import leading_term
from sklvalve.recording import (
    InputError,
    Recording,
    join_recordings,
    require_diagnosable,
    screen_recording,
)
from sklvalve.recording.measured import screened
from sklvalve.simulation import Tolerance, ValveSimulation
from sklvalve.simulation.chain import clock_of
from sklvalve.simulation.parallel_map import with_threads

if TYPE_CHECKING:
    from sklvalve.mismatch.decide.judgement import Judgement
    from sklvalve.mismatch.decide.null_reference import Covariates
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.inference.hypothesis import Model, Term
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.search.events import Events
    from sklvalve.mismatch.search.explain import Explanation


class MissingPhysicsFinder(BaseEstimator):
    """Find the physics that the simulation of a valve leaves out, name it, model it, and prove it.

    Parameters
    ----------
    simulation : ValveSimulation, fitted regressor or callable, default=None
        The simulation to compare with the recording. None builds one from the recording's data sheet.

        A `ValveSimulation` brings its own sheet, tolerance and effects, with their onsets. It is calibrated
        again, fitted or not. Its effects are calibrated too and are no candidates.

        A regressor gets the roles that it was fitted to (``feature_names_in_``; else those recorded of
        command, opening, p1, p2, temperature, in this order), in SI. A function gets the `Recording`, and
        returns one number a row, or a dict of such arrays by role, ``flow`` [m3/s] and ``opening`` [1].
        Only the prediction is used, as if the recording had it as the column ``simulated_flow``, or
        ``simulated_opening`` where no flow is recorded. Effects then change this prediction. Only gain,
        zeros, response, and trim and F_L within their tolerances are calibrated; there is no probability.
    effects : "all", str or sequence of str and effects, default="all"
        Names of the effects to be considered, and effects of your own; ``"all"`` among them adds the whole
        catalogue.
    alpha : float, default=0.01
        Level of the main test for any mismatch, for the whole recording. Looks for cycles, pulses and late
        events have levels of their own: together they alarm more often (:doc:`/validation`).
    tolerance : Tolerance, default=None
        What a data sheet leaves open, and from which size on an effect counts; goes before that of
        `simulation`.
    max_effects : int, default=4
        Largest number of effects at once.
    evidence : float, default=15.0
        Log likelihood that an effect must add beyond the penalty of its parameters [nats].
    search_rows : int or None, default=16384
        In a recording with many more rows the search is done on so many, in stretches spread evenly over it;
        what it finds is fitted to all rows, and then forecast. None searches all rows always.
    n_jobs : int or None, default=None
        Threads that fit explanations side by side, counted as joblib counts (-1: all cores); None takes the
        cores, at most four. The diagnosis does not depend on it. Give 1 where recordings run in parallel.
    random_state : int, RandomState or None, default=0
        Seed of surrogates and bootstrap; the diagnosis names the one used.
    callback : callable, default=None
        Called as ``callback(stage, done)`` with a plain word and the share done.
    history : ValveHistory, Recording or list of Recording, default=None
        What was learnt of the valve from earlier recordings (`history_of`), or these recordings, which are
        then learnt here in the same way. It replaces the data sheet's tolerance: an effect that is named is
        a change since then. The p-value has a null reference of its own, which includes the rehearsal of
        the history (:doc:`/history`).

    Attributes
    ----------
    diagnosis_ : Diagnosis
    evidence_ : Evidence or None
        What the p-value was made of; None where nothing was asked, and for a loop as below.
    next_test_ : TestPlan or None
        The test that the diagnosis asks for, sample by sample (:doc:`/next_test`); None where the
        catalogue's words are all there is, data must be mended first, or a loop is known by its value only.
    nominal_simulation_, corrected_simulation_ : ValveSimulation
        Calibrated without, and with, what was found; absent for a loop known by command and flow, or another
        value, only (:doc:`/loops`). What no effect explains is learnt and added to the
        corrected one where that lowers the error of rows that it was not learnt from.

    comparison_ : DataFrame
        All hypotheses that were compared, place by place, the likeliest first, with size, evidence and
        posterior (:doc:`/method` says what each column is). Asking for it needs pandas.

    Examples
    --------
    >>> from sklvalve import MissingPhysicsFinder, Recording, Valve
    >>> from sklvalve.datasets import make_valve_recording
    >>> made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=1500, n_later=0, random_state=3)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> MissingPhysicsFinder().fit(recording).diagnosis_.verdict
    'named'
    """

    _parameter_constraints: ClassVar[dict] = {
        "simulation": [ValveSimulation, HasMethods("predict"), callable, None],
        "effects": [str, list, tuple, set, frozenset],
        "alpha": [Interval(Real, 0, 1, closed="neither")],
        "tolerance": [Tolerance, None],
        "max_effects": [Interval(Integral, 0, None, closed="left")],
        "evidence": [Interval(Real, 0, None, closed="left")],
        "search_rows": [Interval(Integral, 1200, None, closed="left"), None],
        "n_jobs": [Integral, None],
        "random_state": ["random_state"],
        "callback": [callable, None],
        "history": [ValveHistory, Recording, list, tuple, None],
    }

    def __init__(
        self,
        simulation: Any = None,
        *,
        effects: str | Iterable = "all",
        alpha: float = 0.01,
        tolerance: Tolerance | None = None,
        max_effects: int = 4,
        evidence: float = 15.0,
        search_rows: int | None = 16_384,
        n_jobs: int | None = None,
        random_state: Any = 0,
        callback: Callable[[str, float], object] | None = None,
        history: Any = None,
    ) -> None:
        self.simulation = simulation
        self.effects = effects
        self.alpha = alpha
        self.tolerance = tolerance
        self.max_effects = max_effects
        self.evidence = evidence
        self.search_rows = search_rows
        self.n_jobs = n_jobs
        self.random_state = random_state
        self.callback = callback
        self.history = history

    @_fit_context(prefer_skip_nested_validation=True)
    @whole_or_nothing
    def fit(self, X: Any, y: Any = None, *, until: int | None = None) -> MissingPhysicsFinder:
        """Diagnose a recording.

        Parameters
        ----------
        X : Recording, DataFrame with role names as columns, in SI, or list of these
            Roles are command, opening, p1, p2, temperature, flow; a data frame needs a column or an index
            ``time``, and brings no data sheet: its trim is learnt, and names have no probability.
            Several recordings of one valve share its physics, and each has its own noise
            (`sklvalve.recording.join_recordings` says how they are laid out in time).
        y : ignored
        until : int, default=None
            Number of rows to use; the rows behind serve nothing but the final held-out figures. Of several
            recordings the rows are counted through.

        Returns
        -------
        self : MissingPhysicsFinder

        Raises
        ------
        InputError
            If the recording lacks what a diagnosis needs.
        ValueError
            If a parameter of the finder is of the wrong kind or outside its range.
        """
        # fits of a score of parameters gain nothing from threads, and lose much to their waiting
        with threadpool_limits(1, user_api="blas"), with_threads(self.n_jobs):
            return self._fit(X, y, until)

    def predict(self, X: Any) -> np.ndarray:
        """Flow as the meter would show it, by the corrected simulation.

        Parameters
        ----------
        X : Recording, or DataFrame with role names as columns, in SI
            The recording of the fit, or a later one of the same valve.

        Returns
        -------
        flow : ndarray of shape (n,)
            [m3/s, or kg/s]; NaN where a signal that it needs is a gap. ``corrected_simulation_`` has more:
            `simulate` for all signals, `score` for :math:`R^2` against the recorded flow.

        Raises
        ------
        NotFittedError
            If the finder is not fitted.
        InputError
            If a loop was diagnosed, of which there is no simulation; if X holds neither opening nor command.
        """
        check_is_fitted(self, "diagnosis_")
        if not hasattr(self, "corrected_simulation_"):
            raise InputError(
                "this finder diagnosed a loop without pressures, of which there is no simulation; fit it to "
                "a recording with p1, p2 and the opening or the command"
            )
        return self.corrected_simulation_.predict(X)

    def history_of(self, X: Any) -> ValveHistory:
        """Learn a history from recordings, after a diagnosis of them, for later diagnoses to compare with.

        Three steps: the recordings are diagnosed without a history; the valve is calibrated on them; and the
        second half is diagnosed against the first (a rehearsal).

        Parameters
        ----------
        X : Recording, DataFrame with role names as columns, in SI, or iterable of these
            Of one valve.

        Returns
        -------
        history : ValveHistory
            It holds the effects that the diagnosis named: of each class the first name, with its onset. It
            does not hold one that grows, that comes and goes, or that begins in recordings whose distances
            in time are not known. ``by_itself_`` has the verdict of the diagnosis. ``rehearsals_`` says how
            far the second half lies from the first: a change no larger than that is not reported later.

        Raises
        ------
        InputError
            If the recordings lack what a diagnosis or a history needs.
        """
        recordings = recordings_of(X)
        require_learnable(recordings)
        joined = join_recordings(recordings)
        self.fit(joined)
        diagnosis = self.diagnosis_
        terms = lasting(self._leading, joined) if diagnosis.verdict == "named" else []
        with threadpool_limits(1, user_api="blas"), with_threads(self.n_jobs):
            history = self._learnt(recordings, terms)
            history.rehearsals_ = self._rehearsed(joined, terms)
        history.by_itself_ = by_itself(diagnosis, bool(terms) and len(terms) == len(self._leading))
        return history

    @property
    def comparison_(self) -> Any:
        """Data frame of all hypotheses that were compared, a row each (:doc:`/method`); needs pandas."""
        check_is_fitted(self, "diagnosis_")
        return self.diagnosis_.comparison()

    def _fit(self, X: Any, y: Any, until: int | None) -> MissingPhysicsFinder:
        """Read, and diagnose a valve or a loop."""
        ours = self.simulation if isinstance(self.simulation, ValveSimulation) else None
        external = self.simulation if ours is None else None
        whole = gathered(X, y, simulation=ours, external=external)
        used = rows_to_use(whole, until)
        self._say("reading", 0.0)
        recording = whole.slice(0, used)
        if self.history is not None:
            require_no_loop(recording)
        if ours is None and is_loop(recording):
            if recording.pieces:
                raise InputError(
                    "several recordings at once need pressures, an opening or a simulation; a loop known by "
                    "its command and its value only is diagnosed one recording at a time"
                )
            return self._fit_loop(whole, recording, self._seed())
        require_diagnosable(recording)
        history = self._history()
        if history is not None:
            require_compatible(history, recording, None if ours is None else ours.valve)
        data = screened(recording)
        whole, recording = masked(whole, recording, data)
        problem = prepared_problem(recording, ours, self.tolerance, history=history)
        return self._fit_valve(whole, problem, ours, external, data)

    def _history(self) -> ValveHistory | None:
        """What is known of the valve; learnt here where recordings are given."""
        if self.history is None or isinstance(self.history, ValveHistory):
            return self.history
        alone = MissingPhysicsFinder(**(self.get_params(deep=False) | {"history": None}))
        return alone.history_of(self.history)

    def _rehearsed(self, joined: Recording, known: Sequence[Term]) -> list[Rehearsal]:
        """The second half of a history held against the first, as a later recording will be; none if short.

        The rows before an effect begins are unlike those after it, and tell nothing of what a valve does by
        itself.
        """
        onsets = [term.onset for term in known if term.onset is not None]
        begin = int(np.searchsorted(clock_of(joined), max(onsets, default=-np.inf)))
        middle = (begin + len(joined)) // 2
        halves = [joined.slice(begin, middle), joined.slice(middle, len(joined))]
        if not all(map(is_learnable, halves)):
            return []
        steady = [replace(term, onset=None) for term in known]
        made = self._held_against(self._learnt(halves[0], steady), halves[1])
        return [] if made is None else [made]

    def _held_against(self, history: ValveHistory, recording: Recording) -> Rehearsal | None:
        """A part of a history held against another part; None where its data spoil it."""
        stretches = stretches_of(recording, self.search_rows)
        data = screened(stretches)
        if blocking(data):
            return None
        _, stretches = masked(stretches, stretches, data)
        ours = self.simulation if isinstance(self.simulation, ValveSimulation) else None
        problem = prepared_problem(stretches, ours, self.tolerance, history=history)
        effects, _ = candidates(problem, self.effects, data)
        effects = effects_to_search(effects, None) if self.max_effects else []
        return rehearsed(
            problem,
            effects,
            data,
            threshold=self.evidence,
            alpha=float(self.alpha),
            random_state=self._seed(),
        )

    def _learnt(self, recordings: Any, known: Sequence[Term] = ()) -> ValveHistory:
        effects = tuple(term.effect for term in known)
        onsets = {term.effect.key: term.onset for term in known if term.onset is not None}
        # what it was diagnosed by has the same parameters, and lies in the right valley already
        start = (self.corrected_simulation_ if known else self.nominal_simulation_).values_
        history = ValveHistory(tolerance=self.tolerance, effects=effects, onsets=onsets or None, start=start)
        return history.fit(recordings)

    def _fit_valve(
        self,
        whole: Recording,
        problem: Problem,
        ours: ValveSimulation | None,
        external: Any,
        data: list[dict],
    ) -> MissingPhysicsFinder:
        """Diagnose a valve whose recording was read, and lay out what is found."""
        seed, mend = self._seed(), blocking(data)
        effects, not_testable = candidates(problem, self.effects, data)
        self._say("calibrating", 0.05)
        judged = blocked(problem) if mend else self._judged(problem, ours, effects, data, seed)
        problem = judged.problem
        judged, by_data = suppressed(judged, data, problem.recording)
        spoilt = mend or by_data
        judged = replace(judged, rules=(*judged.rules, rules.data(spoilt)))
        self._say("forecasting rows ahead", 0.82)
        judged, forward = (judged, None) if spoilt else refereed(problem, known_before(problem, judged))
        judged = judged if mend else dated(problem, judged, float(self.alpha))
        self.evidence_ = judged.evidence
        self._leading = [leading_term(finding) for finding in judged.findings]
        self.nominal_simulation_ = _simulation_of(problem, judged.nominal, None, external)
        self.corrected_simulation_ = _simulation_of(problem, judged.model, judged.correction, external)
        self._say("proving on held-out rows", 0.85)
        flagged = flagged_rows(problem, judged)
        self.next_test_ = None if spoilt else plan_of(problem, judged.findings)
        entries = [with_kinds(effect_entry(f, whole, problem), f) for f in judged.findings]
        decision = decided(problem, judged, entries, data, float(self.alpha))
        content = content_of(
            whole,
            problem,
            judged,
            decision,
            flagged,
            {} if mend else fit_entries(problem, whole, judged, forward, flagged, seed),
            data=data,
            not_testable=_not_tested(not_testable, decision.entries),
            alpha=float(self.alpha),
            random_state=seed,
            mend=spoilt,
            plan=self.next_test_,
        )
        simulations = self.nominal_simulation_, self.corrected_simulation_
        traces = traces_of(whole, flagged, len(problem.recording), *simulations, problem.history)
        self.diagnosis_ = Diagnosis(content, traces)
        self._say("done", 1.0)
        return self

    def _fit_loop(self, whole: Recording, recording: Recording, seed: int) -> MissingPhysicsFinder:
        """A loop known by command and value only: there is no simulation of its valve, then."""
        for name in ("nominal_simulation_", "corrected_simulation_"):
            self.__dict__.pop(name, None)
        self.evidence_ = self.next_test_ = None
        data = screen_recording(recording)
        self._say("comparing explanations", 0.1)
        finding = diagnose_loop(recording, alpha=float(self.alpha), random_state=seed)
        plain = [{k: d[k] for k in ("finding", "role", "detail")} for d in data]
        content = loop_content(finding, recording, data=plain, random_state=seed)
        self.diagnosis_ = Diagnosis(content, loop_traces(finding, whole, len(recording)))
        self._say("done", 1.0)
        return self

    def _judged(
        self,
        problem: Problem,
        ours: ValveSimulation | None,
        effects: list[Effect],
        data: list[dict],
        seed: int,
    ) -> Judgement:
        """The judgement on a recording; of a long one stretches are searched."""
        events = evident_events(problem, effects, float(self.alpha)) if self.max_effects else None
        stretches = stretches_of(problem.recording, self.search_rows)
        if stretches is problem.recording:
            return self._judge_with_its_end(problem, ours, effects, events, data, seed)
        bench = prepared_problem(stretches, ours, self.tolerance, trim=problem.trim, history=problem.history)
        judged = self._judge(bench, effects, events, data, seed)
        return over_the_whole(problem, judged, float(self.alpha))

    def _judge_with_its_end(
        self,
        problem: Problem,
        ours: ValveSimulation | None,
        effects: list[Effect],
        events: Events | None,
        data: list[dict],
        seed: int,
    ) -> Judgement:
        """The judgement on a recording, what happens in its last rows judged by itself."""
        start, nominal = calibrated(problem)
        event = late_event(start, nominal, float(self.alpha)) if self.max_effects else None
        if event is None:
            return self._judge(start, effects, events, data, seed, nominal)
        rows = before(problem.recording, event)
        bench = prepared_problem(rows, ours, self.tolerance, trim=problem.trim, history=problem.history)
        judged = self._judge(bench, effects, events, data, seed)
        with_event = with_late_event(start, judged, event, effects, float(self.alpha))
        return with_event or self._judge(problem, effects, events, data, seed)

    def _judge(
        self,
        problem: Problem,
        effects: list[Effect],
        events: Events | None,
        data: list[dict],
        seed: int,
        nominal: Model | None = None,
    ) -> Judgement:
        """Search among the effects, and the judgement on what it finds."""
        alpha, considered = float(self.alpha), effects_to_search(effects, events)
        hidden = effects_to_search(hidden_by_data(problem, self.effects, effects), events)

        def judge_on(
            bench: Problem, candidates: Sequence[Effect]
        ) -> tuple[Explanation, Covariates, Judgement]:
            if bench is problem and nominal is not None:
                first = nominal
            else:
                bench, first = calibrated(bench)
            covariates = covariates_of(bench, data)
            explanation = explain(
                bench,
                first,
                candidates,
                threshold=self.evidence,
                most=self.max_effects,
                hidden=[e for e in hidden if not is_in(e, bench.held)],
                report=lambda done: self._say("comparing explanations", 0.1 + 0.7 * done),
                leaves_much=partial(leaves_much, covariates),
            )
            comparison = compared(explanation, self.evidence)
            self._say("looking for the unknown", 0.8)
            case = Case(explanation, covariates, comparison, alpha, seed)
            judged = judge(case, events)
            # where no effect is looked for none could have been noticed
            asked = self.max_effects and judged.verdict == "no_mismatch"
            limits = detection_limits(case) if asked else ()
            return explanation, covariates, replace(judged, comparison=comparison, limits=limits)

        # slips and hunting name what makes them, whatever the rest of the stem does
        if events is not None:
            return judge_on(problem, considered)[-1]
        return judged_behind(problem, considered, judge_on, alpha)

    def _say(self, stage: str, done: float) -> None:
        if self.callback is not None:
            self.callback(stage, min(done, 1.0))

    def _seed(self) -> int:
        if isinstance(self.random_state, Integral):
            return int(self.random_state)
        return int(check_random_state(self.random_state).randint(2**31 - 1))


def _not_tested(not_testable: list[dict], entries: list[dict]) -> list[dict]:
    """What was no candidate; an effect that data hide, and that what was found may be, stands with that."""
    names = {each["name"] for entry in entries for each in entry["members"]}
    return [each for each in not_testable if each["name"] not in names]


def _simulation_of(
    problem: Problem, fitted: Model, correction: dict | None, external: Any
) -> ValveSimulation:
    effects, onsets = problem.physics_of(fitted.terms)
    return ValveSimulation.from_parts(
        problem.valve,
        problem.trim,
        fitted.values,
        choking=fitted.chain.choking,
        effects=effects,
        onsets=onsets,
        correction=correction,
        given=external,
        seen=fitted.chain.clock[[0, -1]],
    )
