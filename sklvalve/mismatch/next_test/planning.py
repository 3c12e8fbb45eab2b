# SPDX-License-Identifier: BSD-3-Clause
"""Choice of the test that separates the members of a class, or tells the size of its only one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.mismatch.constants import DISTINGUISHABLE
from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.mismatch.next_test.excitation import Advisor, Explanation
from sklvalve.mismatch.next_test.forecast import Surroundings
from sklvalve.mismatch.next_test.plan import (
    SURE,
    Pair,
    TestPlan,
    appreciable,
    confusion,
    distances_in_words,
    sentence_of,
)
from sklvalve.mismatch.next_test.programs import MOST_ROWS, TestLimits, as_now, library
from sklvalve.mismatch.search.rivals import class_of
from sklvalve.simulation.given import ROLES as GIVEN

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.next_test.programs import Program
    from sklvalve.mismatch.search.rivals import Finding

# explanations that are simulated: the most probable ones
_MOST = 4
# programs worth a closer look, and how close
_LOOKED_AT, _ROUNDS = 3, 3
# length of a test where no limit says so [s], its fewest rows, and those of any test
_LONGEST, _FEWEST, _LEAST = 3600.0, 120, 20
# where no limits are given, pressures that may be moved, and how far: what asks least comes first
_FREER = ((("p2",), 0.3), (("p2",), 0.6), (("p1", "p2"), 0.3))
# a distance beyond this is no better: of programs that reach it the slower one asks less of a simulation
_ENOUGH = 2.0 * SURE
# a size is worth a test that narrows its interval to this share
_NARROWS = 0.7


def planned(
    problem: Problem, findings: Sequence[Finding], limits: TestLimits | None = None
) -> TestPlan | None:
    """The test that is expected to tell most.

    Parameters
    ----------
    problem : Problem
    findings : sequence of Finding
        The strongest first; the first one with more than one explanation counts, else the first.
    limits : TestLimits, default=None

    Returns
    -------
    plan : TestPlan or None
        None where no test that can be simulated tells more.
    """
    if not findings or set(GIVEN) & set(problem.recording):
        return None
    finding = next((f for f in findings if len(class_of(f)) > 1), findings[0])
    advisor = _advisor(problem, finding)
    if limits is not None and not {"p1", "p2"} <= set(problem.recording):
        # what a move of pressures does that nobody records cannot be simulated
        limits = replace(limits, pressures=())
    if len(advisor.explanations) == 1:
        return _for_its_size(advisor, finding, limits or TestLimits())
    return _Choice(advisor, finding, limits).plan()


def _advisor(problem: Problem, finding: Finding) -> Advisor:
    likeliest = list(class_of(finding).items())[:_MOST]
    touched = problem.touched_by(term for _, (_, term, _) in likeliest)

    def explanation(name: str, probability: float, model: Model) -> Explanation:
        return Explanation(name, probability, model, problem.misfits(model, touched))

    explanations = [explanation(name, p, model) for name, (p, _, model) in likeliest]
    if len(explanations) == 1:
        return Advisor(problem, explanations, None, finding.gain)
    in_place = next(r for r in finding.rivals if r.term is finding.term)
    others = tuple(m for m in in_place.model.terms if m is not finding.term)
    bare = problem.fit(others, start=in_place.model)
    gain = explanations[0].model.log_likelihood - bare.log_likelihood
    return Advisor(problem, explanations, explanation("without", 0.0, bare), gain)


class _Ranges:
    """Where and how long the command may move, by a recording and limits."""

    def __init__(self, problem: Problem, limits: TestLimits) -> None:
        recording = problem.recording
        role = "command" if "command" in recording else "opening"
        command = np.clip(recording[role], 0.0, 1.0)
        self.step = recording.sample_time
        length = _LONGEST if limits.duration is None else limits.duration
        fewest = _FEWEST if limits.duration is None else 1
        self.rows = int(np.clip(round(length / self.step), fewest, MOST_ROWS))
        if self.rows < _LEAST:
            raise ValueError(
                f"a test must last {_LEAST} samples at least, {_LEAST * self.step:g} s of this recording; "
                f"the limits leave it {limits.duration:g} s."
            )
        self.about = float(np.nanmedian(command))
        low, high = (float(v) for v in np.nanquantile(command, (0.005, 0.995)))
        self.visited = max(np.floor(100.0 * low) / 100.0, 0.0), min(np.ceil(100.0 * high) / 100.0, 1.0)
        # beyond what it has seen a trim learnt from the recording knows nothing
        self.whole = (0.0, 1.0) if problem.trim.known or "flow" not in recording else self.visited

    def programs(self, opening: tuple[float, float], limits: TestLimits) -> list[Program]:
        """Library for a range of the command."""
        return library(*opening, self.about, self.rows, self.step, limits)


class _Choice:
    """Programs within limits, tried on the explanations of a class."""

    def __init__(self, advisor: Advisor, finding: Finding, limits: TestLimits | None) -> None:
        self.advisor, self.finding = advisor, finding
        self.names = [e.name for e in advisor.explanations]
        weights = np.array([e.probability for e in advisor.explanations])
        self.weights = np.outer(weights, weights)[np.tril_indices(len(weights), -1)]
        self.limited, self.limits = limits is not None, limits or TestLimits()
        self.ranges = _Ranges(advisor.problem, self.limits)
        self.now = advisor.now()
        # what the present recording tells apart already speaks for no test
        self.open = self._least(self.now) < DISTINGUISHABLE
        # what was tried, and how much each asks of the process
        self.tried: list[tuple[Program, str | None, np.ndarray]] = []
        self.asks: list[int] = []

    def plan(self) -> TestPlan | None:
        """The best of all, looked at closely; None where none tells more."""
        close: dict[int, np.ndarray] = {}
        for asked, (programs, sensor) in enumerate(self._stages()):
            self._try(programs, sensor, asked)
            if not self.tried:
                continue
            before = [self._least(d) for _, _, d in self.tried]
            self._look_closely(before, close)
            if any(np.all(self._least(d)[self.open] >= SURE) for d in close.values()):
                break
        if not close:
            return None
        after = [self._least(d) for d in close.values()]
        best = list(close)[self._order(after, [self.asks[k] for k in close])[0]]
        pairs = zip(self._least(self.now), self._least(close[best]), strict=True)
        if not any(appreciable(now, then) for now, then in pairs):
            return None
        program, sensor, _ = self.tried[best]
        return self._as_plan(program, sensor, close[best], before)

    def _try(self, programs: Sequence[Program], sensor: str | None, asked: int) -> None:
        for program in programs:
            self.tried.append((program, sensor, self.advisor.distances(program, sensor)))
            self.asks.append(asked)

    def _look_closely(self, before: list[np.ndarray], close: dict[int, np.ndarray]) -> None:
        """Add closer distances of the programs that look best."""
        for k in self._order(before, self.asks)[:_LOOKED_AT]:
            if k not in close:
                program, sensor, _ = self.tried[k]
                close[k] = self.advisor.distances(program, sensor, _ROUNDS)

    def _stages(self) -> Iterator[tuple[list[Program], str | None]]:
        """Programs, those first that ask least of the process, and the sensor that they need besides."""
        problem, limits, ranges = self.advisor.problem, self.limits, self.ranges
        recording = problem.recording
        opening = ranges.visited if limits.opening is None else limits.opening
        yield self._first_programs(opening), None
        if limits.opening is None and ranges.whole != ranges.visited:
            yield ranges.programs(ranges.whole, limits), None
        if not self.limited and {"p1", "p2"} <= set(recording):
            for pressures, share in _FREER:
                yield self._with_pressures(replace(limits, pressures=pressures, pressure_share=share)), None
        if problem.coupled and "opening" in limits.sensors and "command" in recording:
            yield ranges.programs(opening if self.limited else ranges.whole, limits), "opening"

    def _first_programs(self, opening: tuple[float, float]) -> list[Program]:
        """What asks least: more of the same, and moves of the command within where it has been."""
        wide = opening[1] - opening[0] > 0.01 + 1e-9
        programs = self.ranges.programs(opening, self.limits) if wide else []
        same = None if self.limited else as_now(self.advisor.problem.recording, self.ranges.rows)
        return [same, *programs] if same else programs

    def _with_pressures(self, freer: TestLimits) -> list[Program]:
        """Programs that move the first of the pressures, alone or with another."""
        ranges = dict.fromkeys((self.ranges.visited, self.ranges.whole))
        made = [p for r in ranges for p in self.ranges.programs(r, freer) if p.moved]
        return [p for p in made if freer.pressures[0] in p.moved]

    def _least(self, distances: np.ndarray) -> np.ndarray:
        """Of each pair the smaller of both ways."""
        return np.minimum(distances, distances.T)[np.tril_indices(len(self.names), -1)]

    def _order(self, distances: list[np.ndarray], asks: Sequence[int]) -> list[int]:
        """Numbers of the programs, the best first.

        What they tell apart for sure counts first; then how little they ask of the process; then the least
        distance, as far as it is of use. Where none tells anything apart, the chance that explanations are
        confused counts.
        """
        table = np.array(distances)
        able = self._able(table)
        if able.any():
            weight = ((table >= SURE) * self.weights)[:, able].sum(axis=1)
            apart = np.where(table >= SURE, table, np.inf)[:, able].min(axis=1)
            least = np.where(weight > 0.0, apart, table[:, able].min(axis=1))
        else:
            weight = np.zeros(len(table))
            least = -np.array([[confusion(d) for d in row] for row in table]) @ self.weights

        def rank(k: int) -> tuple[float, ...]:
            asked = asks[k] if able.any() else 0
            return -round(float(weight[k]), 6), asked, -min(float(least[k]), _ENOUGH), k

        return sorted(range(len(table)), key=rank)

    def _able(self, table: np.ndarray) -> np.ndarray:
        """Pairs that some program tells apart, and the present recording does not."""
        return (table >= SURE).any(axis=0) & self.open

    def _advice(self) -> list[str]:
        """What the catalogue says of how to tell each of the members."""
        explanations = class_of(self.finding)
        return [explanations[name][1].effect.separated_by for name in self.names]

    def _as_plan(
        self, program: Program, sensor: str | None, distances: np.ndarray, before: list[np.ndarray]
    ) -> TestPlan:
        both = np.minimum(distances, distances.T)
        text = program.text
        if sensor is not None:
            text = f"Record the stem position too, and {text[0].lower()}{text[1:]}"
        if np.isfinite(self.limits.rate):
            text += f", never faster than {100 * self.limits.rate:.3g} %/s"
        unmoved = [self._least(d) for p, _, d in self.tried if not p.moved]
        alone = bool(program.moved and unmoved) and not self._able(np.array(unmoved)).any()
        sentence = sentence_of(text, self.names, self.now, both, self._advice(), alone=alone)
        omitted = len(class_of(self.finding)) - len(self.names)
        if omitted > 0:
            were = "s were" if omitted > 1 else " was"
            sentence += f" {omitted} less probable explanation{were} not considered."
        ranks = np.array(before)
        able = self._able(ranks)
        shown = ranks[:, able if able.any() else slice(None)].min(axis=1)
        considered: dict[str, float] = {}
        for (tried, _, _), least in zip(self.tried, shown, strict=True):
            considered[tried.name] = max(float(least), considered.get(tried.name, -np.inf))
        k = len(self.names)
        pairs = [
            Pair(
                (self.names[j], self.names[i]),
                float(self.now[i, j]),
                (float(distances[j, i]), float(distances[i, j])),
            )
            for i in range(k)
            for j in range(i)
        ]
        details = distances_in_words(self.names, self.now, both)
        return _plan(self.advisor, program, sentence, sensor, pairs, considered, details)


def _plan(
    advisor: Advisor,
    program: Program,
    sentence: str,
    sensor: str | None = None,
    pairs: Sequence[Pair] = (),
    considered: dict[str, float] | None = None,
    details: str = "",
) -> TestPlan:
    recording = advisor.problem.recording
    surroundings = Surroundings(recording)
    return TestPlan(
        program.name,
        sentence,
        recording.sample_time * np.arange(len(program.command)),
        program.command,
        {role: surroundings.shift(role, share) for role, share in program.moved.items()},
        sensor,
        tuple(pairs),
        considered or {},
        details,
    )


def _for_its_size(advisor: Advisor, finding: Finding, limits: TestLimits) -> TestPlan | None:
    """The program that narrows the interval of an effect's main parameter most."""
    term = finding.rivals[0].term
    best = advisor.explanations[0]
    quantity = term.effect.quantities(best.model.chain)[0]
    name = f"{term.effect.key}.{quantity.name}"
    ranges = _Ranges(advisor.problem, limits)
    opening = ranges.visited if limits.opening is None else limits.opening
    tried = []
    for program in ranges.programs(opening, limits):
        now, then = advisor.spread_after(program, name)
        tried.append((then / now if now > 0.0 else 1.0, program))
    share, program = min(tried, key=lambda each: each[0])
    if not share < _NARROWS:
        return None
    what = f"the {quantity.name.replace('_', ' ')} ({term.effect.name.replace('_', ' ')})"
    sentence = (
        f"{program.text}: this should narrow the 95 % interval of {what} to {100 * share:.0f} % of its "
        f"present width. To confirm the cause: {term.effect.separated_by}"
    )
    return _plan(advisor, program, sentence, considered={p.name: float(s) for s, p in tried})
