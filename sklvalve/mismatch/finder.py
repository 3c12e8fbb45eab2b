# SPDX-License-Identifier: BSD-3-Clause
"""The estimator that goes from a recording to its diagnosis, one step after the other."""

import numpy as np
from sklearn.base import BaseEstimator
from threadpoolctl import threadpool_limits

import sklvalve
from sklvalve.mismatch.detect import mismatch_p_value
from sklvalve.mismatch.diagnosis import Diagnosis
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.explain import explain
from sklvalve.mismatch.gate import effects_switched_off
from sklvalve.mismatch.locate import acting_rows, regions
from sklvalve.mismatch.next_test import next_test
from sklvalve.mismatch.prove import errors, held_out_predictions, holds_out
from sklvalve.mismatch.unknown import find_unknown
from sklvalve.mismatch.verdict import class_of, effect_entry, verdict_of
from sklvalve.mismatch.workbench import Workbench
from sklvalve.recording import InputError, Recording, screen_recording
from sklvalve.simulation import Tolerance, ValveSimulation

_FEWEST_ROWS = 120


class MissingPhysicsFinder(BaseEstimator):
    """Find the physics that the simulation of a valve leaves out, name it, model it, and prove it.

    Parameters
    ----------
    simulation : ValveSimulation, default=None
        Gives the data sheet and the tolerance where set; otherwise the recording's own sheet is used.
    effects : "all" or sequence of str, default="all"
        Names of the effects to be considered.
    alpha : float, default=0.01
        Level of the test for any mismatch at all, for the whole recording.
    tolerance : Tolerance, default=None
        What a data sheet leaves open, and from which size on an effect counts.
    max_effects : int, default=4
        Largest number of effects at once.
    evidence : float, default=15.0
        Log likelihood that an effect must add beyond the price of its parameters.
    random_state : int, default=0
        Seed of surrogates and bootstrap.
    callback : callable, default=None
        Called as ``callback(stage, done)`` with a plain word and the share done.

    Attributes
    ----------
    diagnosis_ : Diagnosis
    nominal_simulation_, corrected_simulation_ : ValveSimulation
        Calibrated without, and with, what was found.

    Examples
    --------
    >>> from sklvalve import MissingPhysicsFinder, Recording, Valve
    >>> from sklvalve.datasets import make_valve_recording
    >>> made = make_valve_recording("clogging", 0.5, loop="wide", n_samples=1500, n_later=0, random_state=3)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> MissingPhysicsFinder().fit(recording).diagnosis_.verdict
    'named'
    """

    def __init__(
        self,
        simulation=None,
        *,
        effects="all",
        alpha=0.01,
        tolerance=None,
        max_effects=4,
        evidence=15.0,
        random_state=0,
        callback=None,
    ):
        self.simulation = simulation
        self.effects = effects
        self.alpha = alpha
        self.tolerance = tolerance
        self.max_effects = max_effects
        self.evidence = evidence
        self.random_state = random_state
        self.callback = callback

    def fit(self, X, y=None, *, until=None):
        """Diagnose a recording.

        Parameters
        ----------
        X : Recording, or DataFrame with role names as columns, in SI
        y : ignored
        until : int, default=None
            Number of rows to use; the rows behind serve nothing but the final held-out figures.

        Returns
        -------
        self : MissingPhysicsFinder

        Raises
        ------
        InputError
            If the recording lacks what a diagnosis needs.
        """
        # fits of a score of parameters gain nothing from threads, and lose much to their waiting
        with threadpool_limits(1, user_api="blas"):
            return self._fit(X, y, until)

    def _fit(self, X, y, until):
        whole = X if isinstance(X, Recording) else ValveSimulation(self._sheet(None))._recording(X, y)
        used = self._used_rows(whole, until)
        recording = whole.slice(0, used)
        self._say("reading", 0.0)
        data = screen_recording(recording)
        workbench = Workbench(recording, self._tolerance(), self._physics(whole))
        effects, not_testable = self._candidates(workbench, data)
        self._say("calibrating", 0.05)
        nominal = workbench.calibrated()
        explanation = explain(
            workbench,
            nominal,
            effects,
            threshold=self.evidence,
            most=self.max_effects,
            report=lambda done: self._say("comparing explanations", 0.1 + 0.7 * done),
        )
        self._say("looking for the unknown", 0.8)
        verdict, findings, model, unknown, p_value = self._judge(workbench, explanation, len(effects))
        nominal = workbench.least_squares(explanation.nominal)
        model = workbench.least_squares(model) if findings else nominal
        self._keep_simulations(workbench, nominal, model, unknown)
        self._say("proving on held-out rows", 0.85)
        content, traces = self._report(
            whole,
            workbench,
            nominal,
            model,
            findings,
            unknown,
            verdict,
            p_value,
            data,
            not_testable,
        )
        self.diagnosis_ = Diagnosis(content, traces)
        self._say("done", 1.0)
        return self

    def _judge(self, workbench, explanation, n_candidates):
        """Verdict, what stands of the findings, and the model that goes with it."""

        def rest_of(model):
            return find_unknown(workbench, model, alpha=self.alpha, random_state=self.random_state)

        findings, model, nominal = explanation.findings, explanation.model, explanation.nominal
        unknown = rest_of(model)
        p_value = mismatch_p_value(explanation, unknown, workbench, n_candidates)
        upheld = not findings or holds_out(workbench, nominal, model)
        explained = 0.0
        if unknown is not None and findings:
            explained = workbench.change(model, nominal)[unknown.channel]
        if not upheld:
            # blocks that the fit had not seen speak against it: no name is better than a wrong one
            findings = []
        verdict, findings = verdict_of(findings, unknown, p_value, self.alpha, explained)
        if not findings:
            model = nominal
            if verdict != "no_mismatch":
                unknown = rest_of(model) or unknown
                verdict = "none_of_these" if unknown is not None else "cannot_tell"
        return verdict, findings, model, (None if verdict == "no_mismatch" else unknown), p_value

    def _say(self, stage, done):
        if self.callback is not None:
            self.callback(stage, min(done, 1.0))

    def _sheet(self, recording):
        if self.simulation is not None and self.simulation.valve is not None:
            return self.simulation.valve
        return None if recording is None else recording.valve

    def _tolerance(self):
        given = self.simulation.tolerance if self.simulation is not None else None
        return self.tolerance or given or Tolerance()

    def _used_rows(self, whole, until):
        used = len(whole) if until is None else int(until)
        if used < _FEWEST_ROWS:
            raise InputError(
                f"{whole.source}: {used} rows are too few for a diagnosis; give at least {_FEWEST_ROWS}"
                + ("" if until is None else ", or a later time to use them until")
            )
        return min(used, len(whole))

    def _physics(self, recording):
        known = {e.name for e in CATALOGUE}
        unknown = [name for name in recording.valve.physics if name not in known]
        if unknown:
            raise InputError(
                f"{recording.valve.source}: [simulation] physics names {unknown[0]!r}, which is no effect; "
                f"the effects are {', '.join(sorted(known))}"
            )
        return recording.valve.physics

    def _candidates(self, workbench, data):
        wanted = {e.name for e in CATALOGUE} if isinstance(self.effects, str) else set(self.effects)
        if isinstance(self.effects, str) and self.effects != "all":
            wanted = {self.effects}
        strange = wanted - {e.name for e in CATALOGUE}
        if strange:
            raise InputError(
                f"effects names {sorted(strange)[0]!r}, which is no effect; the effects are "
                f"{', '.join(sorted({e.name for e in CATALOGUE}))}"
            )
        off = effects_switched_off(data)
        candidates, untestable = [], {}
        for effect in CATALOGUE:
            if effect.name not in wanted:
                continue
            missing = [role for role in effect.needs if role not in workbench.recording]
            if missing:
                untestable.setdefault(effect.name, " and ".join(missing))
            elif effect.name in off:
                untestable.setdefault(effect.name, off[effect.name])
            elif effect.possible(workbench.plain) and workbench.channels_touched(effect):
                candidates.append(effect)
            else:
                untestable.setdefault(effect.name, "a data sheet with the characteristic and the fluid")
        tested = {e.name for e in candidates}
        return candidates, [{"name": n, "needs": w} for n, w in untestable.items() if n not in tested]

    def _keep_simulations(self, workbench, nominal, model, unknown):
        def built(fitted, correction):
            return ValveSimulation.from_parts(
                workbench.valve,
                workbench.trim,
                fitted.values,
                choking=fitted.chain.choking,
                effects=[m.effect for m in fitted.members],
                onsets={m.effect.key: m.onset for m in fitted.members if m.onset is not None},
                correction=correction,
            )

        self.nominal_simulation_ = built(nominal, None)
        self.corrected_simulation_ = built(model, None if unknown is None else unknown.correction)

    def _report(
        self, whole, workbench, nominal, model, findings, unknown, verdict, p_value, data, not_testable
    ):
        corrected = self.corrected_simulation_

        def learnt(channel):
            if unknown is None or unknown.channel != channel:
                return 0.0
            return corrected._learnt(corrected._chain(whole), channel)

        made, held = held_out_predictions(workbench, whole, nominal, model, learnt)
        # switched off in the same simulation, not calibrated away: so it shows where it acts itself
        bare = workbench.simulate((), model.values)
        flagged = acting_rows(workbench, model, bare)
        if unknown is not None and not findings:
            rest = np.abs(correct_rows(corrected, workbench.recording, unknown.channel))
            flagged = rest > 0.25 * np.quantile(rest, 0.99)
        onsets = [f.member.onset for f in findings if f.member.onset is not None]
        clock = model.chain.clock
        onset = min(onsets) - clock[0] if onsets and len(onsets) == len(findings) else None
        started = onset if onset is not None else 0.0
        if onset is not None:
            flagged &= clock - clock[0] >= onset
        entries = [effect_entry(f, whole) for f in findings]
        blocks = sorted({b for e in entries for b in e["blocks"]})
        found = verdict != "no_mismatch"
        content = {
            "schema": "sklvalve.diagnosis/1",
            "verdict": verdict,
            "mismatch": {"detected": found, "p_value": p_value, "alpha": self.alpha},
            "location": {
                "blocks": blocks or ([_block_of(unknown)] if unknown is not None else []),
                "regions": regions(model.chain, model.values, flagged) if found else [],
                "onset": None if onset is None else float(onset),
                "intervals": [[float(started), float(clock[-1] - clock[0])]] if found else [],
            },
            "effects": entries,
            "fit": {
                c: errors(whole, made, held, c, workbench.noise[c].floor, random_state=self.random_state)
                for c in workbench.channels
            },
            "not_testable": not_testable,
            "next_test": next_test([class_of(f) for f in findings], verdict, unknown, workbench),
            "data": [{k: d[k] for k in ("finding", "role", "detail")} for d in data],
            "provenance": {
                "sklvalve": sklvalve.__version__,
                "recording_sha256": whole.sha256,
                "rows": len(workbench.recording),
                "random_state": self.random_state,
            },
        }
        if unknown is not None:
            content["unknown"] = {
                "signal": unknown.channel,
                "inputs": list(unknown.inputs),
                "size": unknown.size,
                "skill": unknown.skill,
                "p_value": unknown.p_value,
            }
        return content, self._traces(whole, flagged, len(workbench.recording))

    def _traces(self, whole, flagged, used):
        def own(signals):
            return {r: whole.in_recorded_units(r, v) for r, v in signals.items() if r in ("opening", "flow")}

        roles = [r for r in ("command", "opening", "flow", "p1", "p2", "temperature") if r in whole]
        shown = np.zeros(len(whole), dtype=bool)
        shown[: len(flagged)] = flagged
        return {
            "time": whole.time - whole.time[0],
            "units": {r: whole.unit(r) for r in roles},
            "recorded": {r: whole.in_recorded_units(r, whole[r]) for r in roles},
            "nominal": own(self.nominal_simulation_.simulate(whole)),
            "corrected": own(self.corrected_simulation_.simulate(whole)),
            "dp": whole["p1"] - whole["p2"] if "p1" in whole and "p2" in whole else None,
            "pressure_ratio": self.nominal_simulation_._chain(whole).pressure_ratio,
            "flagged": shown,
            "until": None if used == len(whole) else used,
        }


def correct_rows(simulation, recording, channel):
    """What the learnt part adds to a channel, row by row."""
    return np.broadcast_to(simulation._learnt(simulation._chain(recording), channel), len(recording))


def _block_of(unknown):
    return "valve" if unknown.channel == "flow" else "actuator"
