# SPDX-License-Identifier: BSD-3-Clause
"""Reliability of probabilities, and the fit by which they are calibrated."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import expit

from benchmarks.concealed.calibrate import (
    Told,
    as_code,
    fitted_to,
    held_by_name,
    of_histories,
    reported_anew,
    told_of,
)
from benchmarks.concealed.calibrate_left_over import WITH_IT, odds_of, tried
from benchmarks.concealed.calibrate_left_over import fitted as fitted_to_what_is_left
from benchmarks.concealed.report.reliability import by_chance, main, reliability_report
from sklvalve.mismatch.decide.borne_out import SEALED, Numbers
from sklvalve.mismatch.decide.probability import Grounds, probability_of


def _told(n=1500, seed=0):
    """Classes drawn with a good name, a bad one, and p-values that matter."""
    rng = np.random.default_rng(seed)
    truth = Numbers(1.5, 1.0, (0.5, -0.5, -1.0, 0.0), (0.0, 1.0), {"good": (95, 100), "bad": (60, 100)})
    made = []
    for _ in range(n):
        grounds = Grounds(
            str(rng.choice(["good", "bad"])),
            10.0 ** -rng.uniform(2.0, 6.0),
            beside=bool(rng.random() < 0.2),
            coarse=bool(rng.random() < 0.3),
            few_signals=bool(rng.random() < 0.1),
        )
        right = bool(rng.random() < probability_of(grounds, truth))
        first = bool(right and rng.random() < 0.7)
        made.append(Told("first", grounds, (first, right and not first)))
    return made


def test_the_fit_finds_what_was_drawn():
    told = _told()
    numbers = fitted_to(told)
    rarity, beside, coarse, vanish = numbers.of_grounds
    assert rarity == pytest.approx(0.5, abs=0.15)
    assert beside == pytest.approx(-0.5, abs=0.4)
    assert coarse == pytest.approx(-1.0, abs=0.35)
    assert vanish == pytest.approx(0.0, abs=1e-3)
    fresh = _told(seed=1)
    off = [probability_of(each.grounds, numbers) - each.right for each in fresh]
    assert abs(np.mean(off)) < 0.05
    held = held_by_name(told)
    assert sum(many for _, many in held.values()) == len(told)
    assert '"bad": (' in as_code(numbers)


def test_classes_told_with_a_history_get_an_offset_and_a_slope():
    numbers = Numbers(1.5, 1.0, (0.5, -0.5, -1.0, 0.0), (0.0, 1.0), {"good": (95, 100), "bad": (60, 100)})
    drawn = replace(numbers, with_history=(-0.5, 0.6))
    rng, told = np.random.default_rng(3), []
    for each in _told(seed=2):
        grounds = replace(each.grounds, history=True)
        told.append(
            each._replace(grounds=grounds, true=(bool(rng.random() < probability_of(grounds, drawn)),))
        )
    fitted = of_histories(told, numbers)
    assert fitted.with_history == pytest.approx((-0.5, 0.6), abs=0.25)
    assert sum(many for _, many in fitted.held_with_history.values()) == len(told)
    # what was drawn afresh is as likely as it is said to be, name by name
    for name in ("good", "bad"):
        of_name = [each for each in told if each.grounds.leading == name]
        said = np.mean([probability_of(each.grounds, fitted) for each in of_name])
        assert said == pytest.approx(np.mean([each.right for each in of_name]), abs=0.05)


def test_what_is_left_over_gets_an_offset_and_a_weight():
    drawn = replace(SEALED, left_over=(0.6, -0.15))
    rng, told = np.random.default_rng(5), []
    for name in rng.choice(sorted(SEALED.held), 4000):
        grounds = Grounds(str(name), 10.0 ** -rng.uniform(2.0, 6.0), left=float(rng.uniform(0.0, 22.0)))
        told.append(Told("draw", grounds, (bool(rng.random() < probability_of(grounds, drawn)),)))
    assert fitted_to_what_is_left(told) == pytest.approx((0.6, -0.15), abs=0.15)
    by_odds = expit(odds_of(told))
    with_it = np.array([probability_of(each.grounds, drawn) for each in told])
    loss = [np.mean((p - [each.right for each in told]) ** 2) for p in (by_odds, with_it)]
    assert loss[1] < loss[0]


def test_each_draw_is_tried_by_numbers_fitted_without_it():
    told = [
        each._replace(grounds=replace(each.grounds, left=1.0, history=k % 2 == 0))
        for k, each in enumerate(_told(400, seed=7))
    ]
    wrong = [each._replace(true=(False, False)) for each in told]
    draws = {"seed_1": told[:200], "seed_2": wrong[200:]}
    runs = [{"run": "first", "seed": "9", "lines": [_line(0.9, True)] * 30 + [_line(0.9, False)] * 3}]
    states = tried(draws, runs)
    said = {name: np.mean([p for p, _ in states[WITH_IT][name]]) for name in draws}
    # where the others are all wrong little is believed, and much where they are mostly right
    assert said["seed_1"] < 0.2 < 0.6 < said["seed_2"]


def test_counts_with_a_history_speak_of_recordings_with_one_only():
    numbers = Numbers(1.5, 1.0, (0.0,) * 4, (0.0, 1.0), {"good": (95, 100), "bad": (60, 100)})
    known = replace(numbers, held_with_history={"bad": (40, 40), "new": (0, 9)})
    without, with_ = Grounds("bad", 1e-5), Grounds("bad", 1e-5, history=True)
    assert probability_of(without, known) == probability_of(without, numbers)
    assert probability_of(with_, known) > probability_of(with_, numbers)
    assert probability_of(replace(with_, leading="new"), known) < probability_of(with_, known)


def _line(probability, true, nasty=(), grade=None, p=1e-5):
    bias = {"bias": {"value": 1.0, "unit": "m3/h", "ci95": [-0.5, 2.5]}}
    entry = {
        "members": [{"name": "flow_meter_bias", "probability": probability}],
        "probability": probability,
        "parameters": bias,
    } | ({} if grade is None else {"grade": {"level": grade, "reason": "So."}})
    found = {"verdict": "named", "mismatch": {"p_value": p}, "effects": [entry], "data": []}
    truth = {"effects": ["flow_meter_bias" if true else "clogging"], "nasty": list(nasty), "kind": "single"}
    return {"record": f"r{probability}{true}{nasty}", "found": found, "truth": truth}


def test_facts_are_read_from_a_line():
    (told,) = told_of([{"run": "first", "lines": [_line(0.9, True, ["no_p2"])]}])
    assert told.right
    grounds = told.grounds
    assert (grounds.leading, grounds.may_vanish, grounds.few_signals) == ("flow_meter_bias", True, True)
    numbers = Numbers(0.0, 0.0, (0.0,) * 4, (0.0, 1.0), {"clogging": (1, 2)})
    line = _line(0.9, True)
    assert reported_anew(line, numbers)["found"]["effects"][0]["probability"] == 0.5
    assert line["found"]["effects"][0]["probability"] == 0.9


def test_tables():
    lines = [_line(0.9, True), _line(0.4, False, ["no_opening"], "weak"), _line(None, True, grade="strong")]
    text = reliability_report(lines)
    assert "### Classes\n" in text
    assert "### Classes, opening or a pressure not recorded" in text
    assert "| 0.9-0.95 | 1 | 0.900 | 100 % (2-100) |" in text
    assert "2 of them; 2 bins filled between 0.3 and 0.95" in text
    assert "| strong | no | 100 % (2-100) |" in text
    assert "| weak | yes | 0 % (0-98) |" in text
    assert reliability_report([]) == ""


def test_error_of_true_probabilities():
    # of one class at one half it is always one half off; of many it vanishes
    assert by_chance([(0.5, True)]) == pytest.approx(0.5)
    assert by_chance([(0.5, True)] * 4000) < 0.01


def test_command(tmp_path, capsys):
    path = tmp_path / "scores.jsonl"
    path.write_text(json.dumps(_line(0.9, True)) + "\n")
    assert main([str(path)]) == 0
    assert "### Names" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main([str(tmp_path / "none.jsonl")])
