# SPDX-License-Identifier: BSD-3-Clause
"""Agreement with the truth without noise."""

import pytest

from benchmarks.concealed.scoring import improvement
from benchmarks.concealed.scoring.rates import Rate


@pytest.fixture
def with_errors(a_line):
    """Maker of a line with mean squares of the flow, and of the opening where given."""

    def make(nominal, corrected, oracle=None, opening=None, true="a"):
        errors = {"flow": {"nominal": nominal, "corrected": corrected, "oracle": oracle, "floor": 0.0}}
        if opening is not None:
            errors["opening"] = {"nominal": opening[0], "corrected": opening[1]}
        return a_line(true, "named", "a") | {"errors": errors}

    return make


def test_skill_is_pooled_over_records(with_errors, a_failure):
    lines = [with_errors(10.0, 1.0), with_errors(1.0, 1.0), a_failure("a")]
    skill = improvement.skill(lines)
    assert skill.value == pytest.approx((9.0 + 0.0) / 11.0)  # not the mean of 0.9 and 0
    assert skill.of == 2
    assert skill.low <= skill.value <= skill.high
    assert improvement.untold(lines) == Rate(1, 3)


def test_channels_are_added_up_or_asked_alone(with_errors):
    lines = [with_errors(4.0, 1.0, opening=(2.0, 2.0)), with_errors(2.0, 1.0)]
    assert improvement.skill(lines, ("flow",)).value == pytest.approx(4.0 / 6.0)
    assert improvement.skill(lines, ("opening",)).value == pytest.approx(0.0)
    assert improvement.skill(lines).value == pytest.approx(4.0 / 8.0)
    assert [row.channel for row in improvement.improvement(lines)] == ["flow", "opening", "both"]


def test_a_floor_counts_as_reached(with_errors):
    line = with_errors(5.0, 1.0)
    line["errors"]["flow"]["floor"] = 1.0
    assert improvement.skill([line]).value == pytest.approx(4.0 / 4.0)
    line["errors"]["flow"]["floor"] = None
    assert improvement.skill([line]).value == pytest.approx(4.0 / 5.0)


def test_the_share_of_the_gain_of_the_true_structure(with_errors):
    lines = [with_errors(10.0, 2.0, oracle=0.0), with_errors(6.0, 3.0, oracle=1.0), with_errors(9.0, 0.0)]
    assert improvement.oracle_share(lines).value == pytest.approx((8.0 + 3.0) / (10.0 + 5.0))
    assert str(improvement.oracle_share([with_errors(9.0, 0.0)])) == "-"


def test_harm_is_more_than_what_does_not_matter(with_errors):
    def of(nominal, corrected):
        return improvement.harmed({"nominal": nominal**2, "corrected": corrected**2})

    assert of(0.010, 0.012)
    assert not of(0.010, 0.0104)  # 4 % more
    assert not of(0.0001, 0.0005)  # 0.04 % of the span
    assert not of(0.010, 0.001)
    lines = [with_errors(1e-4, 4e-4, true=""), with_errors(1e-4, 1e-4, opening=(1e-4, 4e-4))]
    lines.append(with_errors(1e-4, 1e-6))
    assert improvement.no_harm(lines) == Rate(1, 3)
    assert improvement.no_harm(lines, ("opening",)) == Rate(0, 1)


def test_errors_of_another_form_or_none_are_left_out(a_line):
    lines = [a_line("a") | {"errors": {"corrected": [1.0, 2.0], "nominal": [3.0, 4.0]}}, a_line("a")]
    lines.append(a_line("a") | {"errors": {"flow": {"nominal": 1.0, "corrected": None}, "opening": None}})
    assert str(improvement.skill(lines)) == str(improvement.skill([])) == "-"
    assert improvement.no_harm(lines) == Rate(0, 0)
    assert improvement.untold(lines) == Rate(3, 3)
