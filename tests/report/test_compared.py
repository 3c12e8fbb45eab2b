# SPDX-License-Identifier: BSD-3-Clause
"""The table of explanations and the checks, as a reader sees them."""

from sklvalve.mismatch.decide.rules import ORDER
from sklvalve.report import to_markdown, to_text
from sklvalve.report.compared import HEAD, RULES_HEAD, comparisons, rules

_BLANK = {
    "rank": 1, "form": "", "time_profile": "throughout", "in_class": True, "channel": "flow", "size": 0.05,
    "size_ci95": [0.04, 0.06], "size_over_relevance": 10.0, "log_likelihood": 123.4, "log_evidence": 119.0,
    "posterior": 0.7, "held_out_gain": 101.0, "held_out_se": 20.0,
}  # fmt: skip
_NOTHING = {"channel": "", "size": 0.0, "size_ci95": None, "size_over_relevance": 0.0, "log_likelihood": 0.0}


def _row(place, hypothesis, **more):
    return {**_BLANK, "place": place, "hypothesis": hypothesis, **more}


def _diagnosis(**more):
    return {
        "verdict": "cannot_tell",
        "location": {"blocks": [], "regions": [], "intervals": []},
        "effects": [],
        "mismatch": {"detected": True, "p_value": 0.004, "alpha": 0.01},
        "fit": {},
    } | more


TABLE = [
    _row(1, "clogging"),
    _row(1, "erosion", posterior=0.2999, held_out_gain=None, held_out_se=None, time_profile="from onset"),
    _row(1, "nothing", **_NOTHING, posterior=0.0001, held_out_gain=None, held_out_se=None),
    _row(2, "backlash", posterior=0.5),
    _row(2, "backlash", form="backlash_linkage", posterior=0.4995),
]


def test_a_table_for_each_difference_with_nothing_in_it():
    first, second = comparisons({"comparison": TABLE})
    assert first.title == "In the place of clogging that caps the opening"
    assert second.title == "In the place of backlash"
    assert all(len(row) == len(HEAD) for row in first.rows)
    assert first.rows[0] == (
        "clogging that caps the opening",
        "flow",
        "10 [8 to 12]",
        "123",
        "101 ± 20",
        "70 %",
    )
    assert first.rows[1][0].endswith(", from onset")
    assert first.rows[1][4] == ""
    assert first.rows[2][0] == "nothing is missing here"
    assert first.rows[2][-1] == "<0.1 %"


def test_forms_of_one_effect_are_one_row():
    _, second = comparisons({"comparison": TABLE})
    assert [row[-1] for row in second.rows] == [">99.9 %"]


def test_of_many_explanations_the_likeliest_are_shown_and_nothing_always():
    many = [_row(1, f"effect_{k}", posterior=0.1) for k in range(9)]
    [only] = comparisons({"comparison": [*many, _row(1, "nothing", **_NOTHING, posterior=0.0)]})
    assert only.title == ""
    assert len(only.rows) == 6
    assert only.rows[-1][0] == "nothing is missing here"


def test_rules_in_words():
    told = rules({"rules": [{"name": "rarity", "passed": False, "sentence": "Too usual."}]})
    assert told == [("rare among healthy valves", "no", "Too usual.")]
    assert all(len(row) == len(RULES_HEAD) for row in told)


def test_text_and_markdown_hold_them_and_old_diagnoses_need_none():
    d = _diagnosis(comparison=TABLE, rules=[{"name": "rarity", "passed": False, "sentence": "Too usual."}])
    text = " ".join(to_text(d).split())
    first = (
        "In the place of clogging that caps the opening: clogging that caps the opening 70 %, gain 123 nats"
    )
    assert f"Compared {first}" in text
    assert "Not passed, rare among healthy valves: Too usual." in text
    page = to_markdown(d)
    assert "### Why this and not that: in the place of clogging that caps the opening" in page
    assert "### Checks" in page
    assert "Compared" not in to_text(_diagnosis())
    assert "Checks" not in to_markdown(_diagnosis())


def test_names_from_a_file_do_not_act_in_markdown():
    page = to_markdown(_diagnosis(comparison=[_row(1, "<script>*x*")]))
    assert "| \\<script>\\*x\\* |" in page


def test_what_was_tried_and_not_named_says_so_and_no_check_stopped_it_where_nothing_is_missing():
    table = [_row(1, "clogging", stands=False)]
    [place] = comparisons({"comparison": table})
    assert place.title == "Tried, and not named"
    asked = [{"name": "rarity", "passed": False, "sentence": "Too usual."}]
    agrees = {"verdict": "no_mismatch", "mismatch": {"detected": False, "p_value": 0.4}}
    d = _diagnosis(**agrees, comparison=table, rules=asked)
    assert "Not passed" not in to_text(d)
    assert "Too usual." in to_markdown(d)


def test_an_explanation_told_by_events_has_no_gain():
    [place] = comparisons({"comparison": [_row(1, "stiction", log_likelihood=None, stands=True)]})
    assert place.rows[0][3] == ""


def test_every_rule_has_a_name_of_its_own_for_readers():
    asked = [{"name": name, "passed": True, "sentence": ""} for name in ORDER]
    shown = [check for check, *_ in rules({"rules": asked})]
    assert not {name.replace("_", " ") for name in ORDER} & set(shown)
