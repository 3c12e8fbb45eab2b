# SPDX-License-Identifier: BSD-3-Clause
"""What a valve is known to have had in its history is held in a later recording, and no candidate."""

from sklvalve.datasets import make_valve_recording
from sklvalve.history import ValveHistory
from sklvalve.mismatch import CATALOGUE
from sklvalve.mismatch.data.preparation import candidates, prepared_problem
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import ValveSimulation

LEAK = next(effect for effect in CATALOGUE if effect.key == "seat_leakage")


def test_effects_of_a_history_are_held():
    made = make_valve_recording("seat_leakage", 0.05, onset=0.0, loop="wide", n_samples=1200, n_later=0)
    whole = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    history = ValveHistory(effects=(LEAK,)).fit(whole.slice(0, 800))
    leak = history.values_["seat_leakage.leak_kv"]
    assert leak > 0.0
    problem = prepared_problem(whole.slice(800, 1200), history=history)
    assert [term.effect for term in problem.held] == [LEAK]
    assert problem.held_values == {"seat_leakage.leak_kv": leak}
    assert "seat_leakage" not in {effect.name for effect in candidates(problem, "all", [])[0]}
    # a simulation that has it too holds it no second time
    both = prepared_problem(whole.slice(800, 1200), ValveSimulation(effects=(LEAK,)), history=history)
    assert [term.effect for term in both.held] == [LEAK]
