# SPDX-License-Identifier: BSD-3-Clause
"""From made-up findings to p-value, classes, verdict, place, onset and next test."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import chi2

from sklvalve.mismatch.data.gate import effects_switched_off
from sklvalve.mismatch.decide.decision import by_evidence
from sklvalve.mismatch.decide.detect import p_value_of_what_counts
from sklvalve.mismatch.effects import CATALOGUE
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.mismatch.next_test.suggestions import next_test
from sklvalve.mismatch.residual.smooth_pattern import Pattern
from sklvalve.mismatch.search.onset import best_onset
from sklvalve.mismatch.search.rivals import Rival, class_of
from sklvalve.mismatch.search.taking_up import Tried
from sklvalve.simulation.fitting import PlainNoise

EFFECTS = {effect.key: effect for effect in CATALOGUE}
BENCH = SimpleNamespace(least=lambda channel: 0.005)


def _finding(*rivals, gain=100.0, sizes=None):
    """A finding of rivals (key, log likelihood, probability), the first one the best."""
    best = max(ll for _, ll, _ in rivals)
    made = [
        Rival(Term(EFFECTS[k]), SimpleNamespace(log_likelihood=ll), p, 2.0 * (best - ll))
        for k, ll, p in rivals
    ]
    return SimpleNamespace(term=made[0].term, rivals=made, gain=gain, sizes=sizes or {"flow": 0.05})


def _p(findings=(), tried=None):
    return p_value_of_what_counts(list(findings), tried or {}, BENCH)


LEAK = ("seat_leakage", -10.0, 0.6)
BYPASS = ("bypass_open", -10.5, 0.4)


# ---- does anything count


def test_nothing_tried_and_nothing_found_is_no_mismatch():
    assert _p() == 1.0
    assert _p(tried={"clogging": Tried(0.0, {"flow": 0.2})}) == pytest.approx(1.0)


def test_what_is_too_small_to_count_is_no_evidence():
    assert _p([_finding(LEAK, gain=1e4, sizes={"flow": 0.004, "opening": 0.005})]) == pytest.approx(1.0)


def test_p_value_is_that_of_the_likelihood_ratio_beyond_what_counts():
    # a size of 0.05 stands 0.9 of itself beyond what counts, 0.005
    assert _p([_finding(LEAK, gain=5.0)]) == pytest.approx(chi2.sf(2.0 * 5.0 * 0.9**2, 2), rel=1e-9)
    assert _p([_finding(LEAK, gain=1e5)]) == 1e-12
    # of what was tried two parameters are granted
    tried = {"clogging": Tried(5.0, {"flow": 0.05}), "erosion": Tried(1e5, {"flow": 0.004})}
    assert _p(tried=tried) == pytest.approx(chi2.sf(2.0 * 5.0 * 0.9**2, 3), rel=1e-9)


@settings(max_examples=50, deadline=None)
@given(st.floats(0.0, 300.0), st.floats(0.0, 300.0), st.floats(0.0, 0.5))
def test_more_evidence_never_raises_it(gain, more, size):
    def p_of(gain):
        return _p([_finding(LEAK, gain=gain, sizes={"flow": size})])

    assert 1e-12 <= p_of(gain + more) <= p_of(gain) <= 1.0


# ---- which


def test_what_fits_worse_and_is_probable_all_the_same_leads_the_class():
    # an explanation in spells fits best, and pays for every switch; one without them is likelier
    rivals = ("seat_leakage", -10.0, 0.06), ("clogging", -30.0, 0.93), ("erosion", -30.0, 0.01)
    found = class_of(_finding(*rivals))
    assert list(found) == ["clogging", "seat_leakage"]
    assert by_evidence([_finding(*rivals)], None, True, 0.0)[0] == "named"


def test_class_is_the_fewest_that_hold_the_probability():
    rivals = ("seat_leakage", -10.0, 0.5), ("bypass_open", -10.5, 0.4), ("flow_meter_bias", -13.0, 0.06)
    assert set(class_of(_finding(*rivals, ("clogging", -30.0, 0.04)))) == {
        "seat_leakage",
        "bypass_open",
        "flow_meter_bias",
    }


def test_class_is_sorted_and_joins_the_forms_of_an_effect():
    found = class_of(_finding(("backlash", -5.0, 0.3), LEAK, ("backlash_linkage", -5.2, 0.5)))
    assert list(found) == ["backlash", "seat_leakage"]
    assert found["backlash"][0] == pytest.approx(0.8)
    assert found["backlash"][1].effect.key == "backlash_linkage"


def test_verdicts():
    sure = _finding(LEAK, BYPASS)
    big, small = (SimpleNamespace(size=size) for size in (0.03, 0.003))
    assert by_evidence([sure], None, False, 0.05) == ("no_mismatch", [])
    assert by_evidence([sure], None, True, 0.05) == ("named", [sure])
    assert by_evidence([], None, True, 0.0) == ("cannot_tell", [])
    assert by_evidence([], small, True, 0.0) == ("none_of_these", [])
    # a rest that is large against what the effects explain makes their names doubtful, a small one does not
    assert by_evidence([sure], big, True, 0.05) == ("none_of_these", [])
    assert by_evidence([sure], small, True, 0.05) == ("named", [sure])


# ---- what the data forbid, where, since when, and what next


def test_only_effects_of_the_catalogue_are_switched_off():
    names = {effect.name for effect in CATALOGUE}
    for finding in ("compressed", "frozen", "clock_shift", "saturated"):
        for role in ("opening", "command", "flow"):
            assert set(effects_switched_off([{"finding": finding, "role": role}])) <= names


@pytest.mark.parametrize("row", [200, 613, 900])
def test_onset_is_where_the_losses_change_sides(row):
    rng = np.random.default_rng(row)
    noise = rng.standard_normal(1200)
    # the other channel was fitted better without, up to a row of its own: no matter of this effect
    other = {"without": np.where(np.arange(1200) < 1100, 0.0, 9.0), "acting": np.full(1200, 5.0)}
    late = np.arange(1200) >= row
    left = {"without": noise + 2.0 * late, "acting": noise - 2.0 * ~late}
    bench = SimpleNamespace(
        recording=range(1200),
        noise={"flow": PlainNoise(1.0), "opening": PlainNoise(1.0)},
        residuals=lambda model: {"flow": left[model.kind], "opening": other[model.kind]},
        channels_touched=lambda effect: ("flow",),
        rows=None,
    )
    chain = SimpleNamespace(clock=5000.0 + np.arange(1200.0))
    members = (Term(EFFECTS["clogging"]),)
    without, acting = (SimpleNamespace(kind=kind, chain=chain, terms=members) for kind in left)
    assert best_onset(bench, without, acting) == pytest.approx(5000.0 + row, abs=5.0)


def test_next_test_separates_what_is_open_first():
    clogging = class_of(_finding(("clogging", -3.0, 1.0)))
    open_one = class_of(_finding(LEAK, BYPASS))
    stem_seen = SimpleNamespace(recording={"opening"})
    assert next_test([clogging, open_one], "named", None, stem_seen) == EFFECTS["seat_leakage"].separated_by
    assert next_test([clogging], "named", None, stem_seen) == EFFECTS["clogging"].separated_by
    unknown = SimpleNamespace(inputs=("opening", "pressure_ratio"), period=None)
    assert "opening and the pressure ratio" in next_test([], "none_of_these", unknown, stem_seen)
    pattern = Pattern("flow", ("opening", "pressure_ratio"), 0.01, 4.0)
    assert "opening and the pressure ratio" in next_test([], "none_of_these", pattern, stem_seen)
    over_time = Pattern("flow", (), 0.01, 4.0)
    assert next_test([], "none_of_these", over_time, stem_seen).startswith("Hold the command")
    assert next_test([], "no_mismatch", None, stem_seen) is None
    assert "stem position" in next_test([], "no_mismatch", None, SimpleNamespace(recording=set()))
