# SPDX-License-Identifier: BSD-3-Clause
"""The next test for a diagnosed recording, within limits that the user gives."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from sklearn.utils.validation import check_is_fitted
from threadpoolctl import threadpool_limits

from sklvalve.mismatch.data.gathering import gathered
from sklvalve.mismatch.data.masking import masked
from sklvalve.mismatch.data.preparation import candidates, hidden_by_data, prepared_problem, rows_to_use
from sklvalve.mismatch.effects import EVENTS
from sklvalve.mismatch.inference.hypothesis import begun, is_in
from sklvalve.mismatch.next_test.planning import planned
from sklvalve.mismatch.search.rivals import find_rivals
from sklvalve.recording import InputError
from sklvalve.recording.measured import screened
from sklvalve.simulation import ValveSimulation

if TYPE_CHECKING:
    from sklvalve.mismatch.effects import Effect
    from sklvalve.mismatch.finder import MissingPhysicsFinder
    from sklvalve.mismatch.inference.hypothesis import Term
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.next_test.plan import TestPlan
    from sklvalve.mismatch.next_test.programs import TestLimits
    from sklvalve.mismatch.search.rivals import Finding


def plan_next_test(
    finder: MissingPhysicsFinder, X: Any, *, limits: TestLimits | None = None, until: int | None = None
) -> TestPlan | None:
    """Program of the command, or sensor, that would tell apart what a diagnosis leaves open.

    Programs of a small library are simulated with each explanation of the class, and every other one is
    fitted to the outcome, to first order and with the calibration as free as the present recording leaves
    it. The program with the largest least distance :math:`D` between explanations is the one to make: with

    .. math:: D = \\frac{2 (\\log L_i - \\log L_j)}{1 + 2 \\kappa^2 G}

    over the present recording and the test together, G the log likelihood that the effect adds and
    :math:`\\kappa = 0.10` the share of it that a simulation gets wrong, one of two explanations is taken
    for the other with a chance of :math:`\\Phi(-\\sqrt D / 2)`.

    Parameters
    ----------
    finder : MissingPhysicsFinder
        Fitted.
    X : Recording, DataFrame with role names as columns, in SI, or list of these
        What it was fitted on.
    limits : TestLimits, default=None
        What the test may do. Without limits programs within what the command has visited come first, then
        the whole travel, a moved outlet pressure, and a stem sensor where there is none.
    until : int, default=None
        Number of rows used by the finder.

    Returns
    -------
    plan : TestPlan or None
        None where nothing was found, or no test that can be simulated tells more.

    Raises
    ------
    InputError
        If the finder has diagnosed a loop of which nothing is simulated.

    Notes
    -----
    The record of the test belongs together with the present one, as a second recording: what this says of the
    calibration counts, and a short test diagnosed by itself leaves more open. Pressures are taken to stand
    for a flow as they did in the recording. Excitation by the least distance between rival models is
    T-optimal design: Atkinson and Fedorov, Biometrika 62 (1975) 57.

    Examples
    --------
    >>> from sklvalve import MissingPhysicsFinder, Recording, Valve
    >>> from sklvalve.datasets import make_valve_recording
    >>> from sklvalve.mismatch import TestLimits, plan_next_test
    >>> made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=1500, n_later=0, random_state=3)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> finder = MissingPhysicsFinder(effects=["clogging"]).fit(recording)
    >>> plan = plan_next_test(finder, recording, limits=TestLimits(opening=(0.2, 0.9), duration=600.0))
    >>> plan is None or (plan.command.min() >= 0.2 and len(plan.time) == 600)
    True
    """
    check_is_fitted(finder, "diagnosis_")
    if not hasattr(finder, "corrected_simulation_"):
        raise InputError(
            "a test can be planned where the valve is simulated; this diagnosis is of a loop known by its "
            "command and value only: record the opening, or the pressures and the flow"
        )
    with threadpool_limits(1, user_api="blas"):
        problem, findings = reopened(finder, X, until=until)
        return planned(problem, findings, limits)


def reopened(
    finder: MissingPhysicsFinder, X: Any, *, names: Iterable[str] = (), until: int | None = None
) -> tuple[Problem, list[Finding]]:
    """The problem of a fitted finder and its findings, fitted once more.

    Parameters
    ----------
    finder : MissingPhysicsFinder
    X : Recording, DataFrame with role names as columns, in SI, or list of these
    names : sequence of str, default=()
        Effects to be weighed beside those that the diagnosis names.
    until : int, default=None

    Returns
    -------
    problem : Problem
    findings : list of Finding
        Empty where nothing was found.
    """
    problem, data = _problem_of(finder, X, until)
    terms = _simulated_terms(finder, problem)
    if not terms:
        return problem, []
    model = problem.simulate(terms, finder.corrected_simulation_.values_)
    for _ in range(2):
        problem = problem.with_noise_of(model, anew=problem.channels)
        model = problem.fit(terms, start=model)
    effects = _effects_to_weigh(finder, problem, data, names)
    return problem, find_rivals(problem, model, effects, None)


def _problem_of(
    finder: MissingPhysicsFinder, X: Any, until: int | None
) -> tuple[Problem, list[dict[str, Any]]]:
    """The problem that a finder has diagnosed, its noise not yet learnt, and the findings about its data."""
    ours = finder.simulation if isinstance(finder.simulation, ValveSimulation) else None
    whole = gathered(X, simulation=ours, external=finder.simulation if ours is None else None)
    recording = whole.slice(0, rows_to_use(whole, until))
    data = screened(recording)
    _, recording = masked(recording, recording, data)
    return prepared_problem(recording, ours, finder.tolerance), data


def _simulated_terms(finder: MissingPhysicsFinder, problem: Problem) -> tuple[Term, ...]:
    """Effects that a diagnosis has added to the simulation; those that events show are not simulated."""
    corrected = finder.corrected_simulation_
    onsets = corrected.onsets or {}
    simulated = [e for e in corrected.effects if e not in EVENTS and not is_in(e, problem.held)]
    return tuple(begun(e, onsets.get(e.key)) for e in simulated)


def _effects_to_weigh(
    finder: MissingPhysicsFinder, problem: Problem, data: list[dict[str, Any]], names: Iterable[str]
) -> list[Effect]:
    """Effects that a diagnosis names, and further ones by name."""
    wanted = {m["name"] for entry in finder.diagnosis_.content["effects"] for m in entry["members"]}
    wanted |= set(names)
    of_user = [] if isinstance(finder.effects, str) else [e for e in finder.effects if not isinstance(e, str)]
    asked = [*sorted(wanted - {e.name for e in of_user}), *of_user]
    effects, _ = candidates(problem, asked, data)
    return [e for e in (*effects, *hidden_by_data(problem, asked, effects)) if e.name in wanted]
