# SPDX-License-Identifier: BSD-3-Clause
import copy
import json
import re

import pytest

from sklvalve._telling import lacking
from sklvalve.report import summary_sentence, to_markdown, to_text
from sklvalve.report.headline import headline
from sklvalve.report.html import render
from tests.report import examples


def test_sentence_when_nothing_is_missing():
    sentence = summary_sentence(examples.no_mismatch())
    assert sentence.startswith("Nothing is missing: simulation and recording agree")
    assert "p = " not in sentence


def test_sentence_when_the_difference_is_real_but_too_small_to_count():
    made = examples.no_mismatch()
    made["mismatch"] |= {"detected": True, "p_value": 1e-6}
    sentence = summary_sentence(made)
    assert sentence.startswith("Nothing relevant is missing")
    assert "p < 0.001" in sentence


def test_sentence_names_class_size_place_onset_certainty_and_gain():
    assert summary_sentence(examples.named()) == (
        "Likely fault: the seat leaks or a bypass is open (right in 97 % of blind tests): leak Kv 0.8 m3/h "
        "[0.7 to 0.9], acting in the valve below 12 % opening from 812 s on; including it lowers the flow "
        "error on 1440 unseen rows from 1.9 to 0.22 m3/h."
    )


def test_without_later_rows_nothing_is_called_unseen():
    made = examples.named() | {"proof": "four_blocks"}
    sentence = summary_sentence(made)
    assert sentence.endswith("including it lowers the cross-validated flow error from 1.9 to 0.22 m3/h.")
    for text in (to_text(made), to_markdown(made)):
        words = " ".join(text.split())
        assert "unseen" not in words
        assert "on 1440 rows, held out in turn" in words
        assert "each is predicted by fits to the other three." in words
        assert "was reached on all rows" in words
    loop = " ".join(to_text(made | {"reasons": ["A band explains the value."]}).split())
    assert "fits to the other three. The verdict" in loop
    silent = {key: value for key, value in made.items() if key != "proof"}
    assert "lowers the flow error on 1440 held-out rows" in summary_sentence(silent)


def test_what_could_not_be_learnt_is_told_of_its_own_signal():
    made = examples.none_of_these()
    made["fit"] = {
        "opening": made["fit"]["flow"] | {"unit": "1", "rmse": {"nominal": 0.0015, "corrected": 0.0015}},
        "flow": made["fit"]["flow"] | {"rmse": {"nominal": 1.64, "black_box": 3.7, "corrected": 1.64}},
    }
    made["location"] |= {"onset": None}
    lost = {"added": False, "rmse_without": 1.637, "rmse_with": 1.737}
    made["unknown"] = {"signal": "flow", "inputs": ["opening"], "correction": lost}
    sentence = summary_sentence(made)
    assert "opening error" not in sentence
    assert "from the start" not in sentence, "learnt from all rows alike, it has no beginning"
    assert sentence.endswith(
        "but it could not be modelled well enough to predict: a correction fitted to three blocks made it "
        "worse when it predicted the fourth (flow error 1.64 without it, 1.74 m3/h with it), so it was left "
        "out."
    )
    text = " ".join(to_text(made).split())
    assert "Of what no effect explains: it could not be modelled well enough" in text
    assert "Since not known" in text
    made["unknown"]["correction"] = lost | {"added": True, "rmse_with": 0.9}
    made["fit"]["flow"]["rmse"]["corrected"] = 0.9
    sentence = summary_sentence(made)
    assert (
        "including a fitted correction lowers the flow error on 1440 unseen rows from 1.64 to 0.9" in sentence
    )


def test_where_no_error_falls_the_signal_is_that_of_the_finding():
    made = examples.named()
    still = {"nominal": 0.002, "corrected": 0.002}
    made["fit"] = {"opening": made["fit"]["flow"] | {"unit": "1", "rmse": still}, "flow": made["fit"]["flow"]}
    made["fit"]["flow"]["rmse"]["corrected"] = 1.9
    assert "though including it does not lower the flow error" in summary_sentence(made)
    made["location"] = made["location"] | {"blocks": ["actuator"]}
    assert "does not lower the opening error" in summary_sentence(made)


def test_sentence_lists_two_things():
    sentence = summary_sentence(examples.named_twice())
    assert sentence.startswith("Likely fault: 1. the stem has play (backlash), in the actuator (")
    assert "2. the seat leaks or a bypass is open, in the valve (" in sentence
    assert "right in more than 99 % of blind tests" in sentence


def test_sentence_of_what_no_effect_explains_names_none():
    sentence = summary_sentence(examples.none_of_these())
    assert "no known effect explains" in sentence
    assert "leakage" not in sentence
    assert "follows from the recorded signals" in sentence
    told = examples.none_of_these() | {"unknown": {"inputs": ["opening", "p1"]}}
    assert "follows from opening and inlet pressure, so" in summary_sentence(told)
    besides = examples.none_of_these() | {"effects": [examples.PLAY]}
    assert summary_sentence(besides).startswith("Besides backlash, something is missing")


def test_sentence_of_an_undecided_recording_points_to_the_test():
    sentence = summary_sentence(examples.cannot_tell())
    assert "the recording does not identify what" in sentence
    assert "most likely seat leakage (45 %), then erosion" in sentence
    assert sentence.endswith("the next test would decide.")


def test_sentence_owns_up_where_the_error_does_not_fall():
    made = examples.named()
    made["fit"]["flow"]["rmse"]["corrected"] = 1.9
    told = "though including it does not lower the flow error on 1440 unseen rows"
    assert told in summary_sentence(made)


def test_opening_as_a_fraction_is_told_in_percent():
    made = examples.named()
    made["fit"] = {"opening": made["fit"]["flow"] | {"unit": "1"}}
    made["fit"]["opening"]["rmse"] = {"nominal": 0.021, "black_box": None, "corrected": 0.004}
    assert "from 2.1 to 0.4 %." in summary_sentence(made)
    assert "opening RMSE [% of travel]" in to_text(made)


def test_text_and_markdown_begin_with_the_report_s_own_sentence():
    made = examples.named()
    first = headline(made)
    assert " ".join(to_text(made).split()).startswith(f"Finding {first} How sure In blind tests")
    assert to_markdown(made).startswith(f"**{first}**\n\n- How sure: In blind tests")
    assert (
        "Benefit Including it lowers the flow error on 1440 unseen rows from 1.9 to 0.22 m3/h."
        in " ".join(to_text(made).split())
    )


def test_what_was_assumed_is_told_at_the_top_and_in_full_below():
    made = examples.named()
    made["data"] = [
        {"finding": "assumed", "role": "command", "detail": "column 'OP'"},
        {"finding": "guessed", "role": "p1", "detail": "unit 'bar'"},
    ]
    words = "Partly a guess: inlet pressure."
    assert words in to_markdown(made).split("###")[0]
    text = to_text(made)
    assert f"Assumed No data sheet was given; the columns were read by their names and values. {words}" in (
        " ".join(text.split())
    )
    assert "inlet pressure, guessed: unit 'bar'" in text


def test_unknown_verdict_is_refused():
    with pytest.raises(ValueError, match="verdict must be one of no_mismatch"):
        summary_sentence(examples.named() | {"verdict": "perhaps"})


@pytest.mark.parametrize("make", examples.ALL)
@pytest.mark.parametrize("render", [to_text, to_markdown])
def test_all_verdicts_render_with_every_part(make, render):
    made = make()
    before = copy.deepcopy(made)
    text = render(made)
    assert made == before, "rendering must not change the diagnosis"
    assert "viscous" in text
    assert "temperature" in text
    assert "steps of 0.5 % of travel" in text
    for effect in made["effects"]:
        assert effect["sentence"] in " ".join(text.split())
    if made["next_test"]:
        assert made["next_test"] in text
    if made["fit"]:
        assert "0.22" in text
        assert "black box" in text


@pytest.mark.parametrize("make", examples.ALL)
def test_text_is_plain_narrow_and_survives_json(make):
    made = make()
    text = to_text(made)
    assert text.isascii()
    assert max(len(line) for line in text.splitlines()) <= 96
    assert to_text(json.loads(json.dumps(made))) == text


def test_missing_numbers_leave_gaps_not_errors():
    made = examples.named()
    made["effects"][0] = examples.LEAK | {
        "parameters": {"leak_kv": {"value": 0.8, "unit": "m3/h", "ci95": [None, None]}}
    }
    made["fit"]["flow"] |= {"rmse": {"nominal": None, "black_box": None, "corrected": None}, "skill": None}
    text = to_text(made)
    assert "leak Kv 0.8 m3/h" in text
    assert "lowers" not in text
    made["fit"] = {"flow": None}
    assert "Error" not in to_text(made)


def test_table_cells_cannot_break_markdown():
    made = examples.named()
    made["data"] = [{"finding": "gap", "role": None, "detail": "a|b\nc"}]
    assert "| times | gap | a\\|b c |" in to_markdown(made)


def test_names_from_a_file_command_neither_markdown_nor_the_terminal():
    made = examples.named()
    evil = "<img src=x> *a* [b](javascript:c) \x1b[31m"
    made["data"] = [{"finding": "gap", "role": None, "detail": evil}]
    made["next_test"] = evil
    told = to_markdown(made)
    assert told.count(r"\<img src=x> \*a\* [b]\(javascript:c)") == 2
    assert "\x1b" not in to_text(made)
    assert "p < 0.001" in to_markdown(examples.named() | {"verdict": "none_of_these", "effects": []})


def test_what_no_effect_explains_is_described_and_drawn():
    made = examples.none_of_these() | {
        "unknown": {
            "signal": "flow",
            "inputs": ["opening"],
            "size": 0.03,
            "formula": "flow residual [m3/h] = 0.2 - 0.03 max(0, opening [%] - 62) <b>",
            "share": 0.93,
            "curve": {"signal": "opening", "unit": "%", "at": [10.0, 50.0, 90.0], "rest": [0.0, 0.1, -0.5]},
        }
    }
    for text in (to_text(made), to_markdown(made)):
        words = " ".join(text.split())
        assert "max(0, opening [%] - 62)" in words
        assert "explains 93 % of its variance" in words
        assert "3 % of span" in words
    page = render(examples.diagnosis(made))
    assert "What no known effect explains" in page
    assert 'aria-label="What no known effect explains, over the opening"' in page
    assert "<b>" not in page.split("<main>")[1]
    made["unknown"] |= {"formula": None, "share": 0.4}
    assert "no short formula (the best explains 40 % of its variance)" in " ".join(to_text(made).split())


def test_an_effect_is_told_with_what_it_moves():
    made = examples.named()
    made["effects"][0]["size"] = {"flow": 0.032, "opening": 1e-5}
    for text in (to_text(made), to_markdown(made), render(examples.diagnosis(made))):
        assert "it moves the flow by 3 % of span." in " ".join(
            text.replace("\N{NO-BREAK SPACE}", " ").split()
        )


@pytest.mark.parametrize("width", [40, 60, 96])
def test_text_keeps_to_the_width_asked_for(width):
    made = examples.named_twice() | {"fit": {}}
    narrow = to_text(made, width=width)
    # a word longer than a line stays whole
    assert max(len(line) for line in narrow.splitlines() if len(line.split()) > 2) <= width
    assert narrow.split() == to_text(made).split()
    assert to_text(made, width=7) == to_text(made, width=40)


def test_many_effects_of_one_need_are_one_sentence_and_what_cannot_be_is_not_listed():
    lacking = [{"name": f"effect {k}", "needs": "p1 and p2"} for k in range(43)]
    lacking.append({"name": "gas_expansion", "needs": "a gas", "applies": False})
    made = examples.named() | {"not_testable": lacking}
    told = "an inlet pressure and an outlet pressure recorded: effect 0, effect 1, effect 2 and 40 others."
    for page in (
        to_text(made),
        to_markdown(made),
        re.sub("</?strong>", "", render(examples.diagnosis(made))),
    ):
        words = " ".join(page.split())
        assert f"Without {told}" in words
        assert "effect 3" not in words
        assert "expansion of the gas" not in words
    assert "Not testable" not in to_text(made | {"not_testable": lacking[-1:]})


@pytest.mark.parametrize(
    ("effects", "value", "passed", "words"),
    [
        ([], None, False, "differs from the history"),
        # weak candidates, and names, are of a change
        ([{"members": []}], None, False, "has changed since the history"),
        ([], None, True, "has changed since the history"),
        ([], 0.4, False, "has changed since the history"),
    ],
)
def test_what_the_history_may_have_had_is_not_said_to_have_changed(effects, value, passed, words):
    rule = {"name": "probability", "value": value, "passed": passed}
    assert lacking({"since_history": {"rows": 3600}, "effects": effects, "rules": [rule]}) == words
    assert lacking({"effects": effects, "rules": [rule]}) == "is missing"
