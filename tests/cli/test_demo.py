# SPDX-License-Identifier: BSD-3-Clause
import json
import os

import pytest

from sklvalve.cli import main
from sklvalve.cli.demo import DRAWN, draw, judge, tell
from sklvalve.datasets import CONCEALABLE
from tests.cli import stand_in


def test_all_files_and_the_truth_last(folder, capsys, monkeypatch):
    import sklvalve.datasets

    made = []

    def remembered(**settings):
        made.append(settings)
        return original(**(settings | {"n_samples": 400, "n_later": 60}))

    original = sklvalve.datasets.make_valve_recording
    monkeypatch.setattr(sklvalve.datasets, "make_valve_recording", remembered)
    assert main(["demo", "--out", "tried", "--seed", "3"]) == 0
    names = ("recording.csv", "later.csv", "valve.toml", "truth.json", "diagnosis.json", "report.html")
    assert sorted(os.listdir("tried")) == sorted((*names, "corrected_model.skops"))
    shown = capsys.readouterr().out
    places = [shown.index(words) for words in ("Finding", "Later rows", "The truth", "report.html")]
    assert places == sorted(places)
    assert stand_in.Finder.asked["rows"] == 400
    assert [settings.get("return_truth", True) for settings in made] == [False, True]
    truth = json.loads((folder / "tried/truth.json").read_text())
    assert truth["concealed"] == ([] if DRAWN[0] is draw(3)["effect"] else [draw(3)["effect"]])


def test_draws_repeat_and_reach_everything():
    assert draw(11) == draw(11)
    assert {draw(seed)["effect"] for seed in range(300)} == set(DRAWN)
    assert set(DRAWN) - {None} <= set(CONCEALABLE)


@pytest.mark.slow
def test_the_default_demo_names_what_was_concealed_first(tmp_path, capsys):
    pytest.importorskip("skops", reason='needs pip install "sklvalve[all]"')
    assert main(["demo", "--json", "--out", str(tmp_path / "demo")]) == 0
    told = json.loads(capsys.readouterr().out)
    (concealed,) = told["truth"]["effects"]
    assert told["diagnosis"]["effects"][0]["members"][0]["name"] == concealed == "backlash"
    assert told["judgement"] == "The finding is right."


def _found(verdict, *classes):
    return {
        "verdict": verdict,
        "effects": [{"members": [{"name": name} for name in members]} for members in classes],
    }


def _truth(verdict, *effects):
    return {"verdict": verdict, "effects": list(effects)}


@pytest.mark.parametrize(
    ("found", "truth", "words"),
    [
        (_found("no_mismatch"), _truth("no_mismatch"), "is right."),
        (_found("named", ["backlash"]), _truth("no_mismatch"), "is wrong."),
        (_found("no_mismatch"), _truth("named", "backlash"), "is wrong: what was concealed went unnoticed."),
        (_found("named", ["seat_leakage", "bypass_open"]), _truth("named", "bypass_open"), "is right."),
        (_found("named", ["clogging"]), _truth("named", "bypass_open"), "is wrong."),
        (_found("named", ["bypass_open"], ["clogging"]), _truth("named", "bypass_open"), "in part only."),
        (_found("named", ["bypass_open"]), _truth("named", "bypass_open", "clogging"), "is wrong."),
        (_found("none_of_these"), _truth("none_of_these"), "is right."),
        (_found("cannot_tell", ["clogging"]), _truth("named", "clogging"), "is among the candidates."),
        (_found("cannot_tell"), _truth("named", "clogging"), "not among the candidates."),
        (_found("cannot_tell"), _truth("no_mismatch"), "left it open."),
    ],
)
def test_judgement(found, truth, words):
    assert judge(found, truth).endswith(words)


def test_truth_in_words():
    truth = {
        "concealed": ["seat_leakage"],
        "effects": ["seat_leakage"],
        "strengths": {"seat_leakage": 0.018333},
        "units": {"seat_leakage": "kv_rated"},
        "onset": 2000.0,
    }
    assert tell(truth) == "Concealed: seat leakage (0.0183 of the rated capacity), from 2000 s on."
    assert tell({"concealed": []}).startswith("Nothing was concealed")
    alien = truth | {"effects": [], "onset": 0.0}
    assert tell(alien).endswith("from the start, which is not in the catalogue.")
