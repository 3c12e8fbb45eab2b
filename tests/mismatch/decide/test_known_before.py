# SPDX-License-Identifier: BSD-3-Clause
"""Names that a history may have had already are taken back, and no others."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from sklvalve.history import ByItself
from sklvalve.mismatch.decide.judgement import Judgement
from sklvalve.mismatch.decide.known_before import known_before
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term

UNSURE, SOUND = ByItself("cannot_tell", "Nobody knows."), ByItself("no_mismatch", "Nothing is missing.")
LEAKS = ByItself("named", "It leaks.", held=True)
NEVER_CHECKED = replace(LEAKS, checked=False)


def judged(onset=None, verdict="named"):
    term = Term(CATALOGUE[0], onset)
    # the likeliest of the class may act at other times than the search ended with
    finding = SimpleNamespace(
        term=Term(CATALOGUE[0], 5.0), rivals=[SimpleNamespace(term=term, probability=1.0, model=None)]
    )
    return Judgement(None, verdict, 1e-5, [finding], None, "nominal", "model", kept=True)


def problem(by_itself, kind="fault"):
    effect = SimpleNamespace(kind_of=lambda chain, late: kind)
    return SimpleNamespace(history=SimpleNamespace(by_itself_=by_itself, effects=[effect]), plain="chain")


def test_a_name_is_taken_back_where_the_history_could_not_tell():
    found = known_before(problem(UNSURE), judged())
    assert (found.verdict, found.findings, found.kept) == ("cannot_tell", [], False)
    assert (found.model, found.suspected) == ("nominal", "model")
    assert "may have been there in the history already" in found.why[-1]
    assert (found.rules[-1].passed, found.rules[-1].sentence) == (False, found.why[-1])


@pytest.mark.parametrize("before", [SOUND, LEAKS, None])
def test_a_history_that_was_told_lets_names_stand(before):
    given = judged()
    assert known_before(problem(before), given) is given


def test_what_begins_within_the_recording_is_new():
    given = judged(onset=100.0)
    assert known_before(problem(UNSURE), given) is given


def test_nothing_else_is_touched():
    given = judged(verdict="none_of_these")
    assert known_before(problem(UNSURE), given) is given
    assert known_before(SimpleNamespace(history=None), replace(given, verdict="named")).verdict == "named"


def test_a_name_is_taken_back_where_the_name_of_the_history_has_no_probability():
    found = known_before(problem(NEVER_CHECKED), judged())
    assert (found.verdict, found.findings) == ("cannot_tell", [])
    assert "how often such a name holds was not checked" in found.why[-1]


def test_what_begins_within_the_recording_is_new_there_too():
    given = judged(onset=100.0)
    assert known_before(problem(NEVER_CHECKED), given) is given


def test_what_no_effect_explains_has_no_name_to_lose():
    given = judged(verdict="none_of_these")
    assert known_before(problem(NEVER_CHECKED), given) is given


def test_nothing_is_kept_of_the_proof_of_names_that_go():
    given = replace(judged(), tried="cross-validated", errors=(1.0, 0.5))
    found = known_before(problem(UNSURE), given)
    assert (found.tried, found.errors, found.kept) == (None, None, False)


def test_a_property_of_the_history_is_part_of_a_sound_valve():
    given = judged()
    assert known_before(problem(NEVER_CHECKED, "property"), given) is given
    # what the history does not hold may pass for a change
    found = known_before(problem(replace(NEVER_CHECKED, held=False), "property"), given)
    assert found.verdict == "cannot_tell"
