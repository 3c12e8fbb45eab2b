# SPDX-License-Identifier: BSD-3-Clause
"""The picture of parameters with their intervals: each on its own scale, and told to who cannot see it."""

import pytest

from sklvalve.report.intervals import _on_own_scale, interval_figures
from sklvalve.report.parameters import Parameter
from tests.report import examples

pytest.importorskip("matplotlib", reason='needs pip install "sklvalve[plot]"')


def test_one_picture_for_each_thing_found_with_its_numbers_in_words():
    play, leak = interval_figures(examples.named_twice())
    assert play.alt == "Parameters with their 95 % intervals: play 3.1 % of travel [2.9 to 3.3]"
    assert leak.alt == "Parameters with their 95 % intervals: leak Kv 0.8 m3/h [0.7 to 0.9]"
    for picture, name in ((play, "play"), (leak, "leak Kv")):
        assert f'aria-label="{picture.alt}"' in picture.svg
        assert f">{name}</text>" in picture.svg


def test_what_has_no_interval_is_not_drawn():
    made = examples.named()
    made["effects"][0]["parameters"]["leak_kv"]["ci95"] = None
    assert interval_figures(made) == [None]
    assert interval_figures(examples.no_mismatch()) == []


@pytest.mark.parametrize(
    ("ends", "scaled"),
    [
        ((2.0, 3.0, 4.0), (0.5, 0.75, 1.0)),
        ((-4.0, -1.0, 2.0), (-1.0, -0.25, 0.5)),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
    ],
)
def test_a_scale_of_its_own_keeps_nought_at_nought(ends, scaled):
    low, value, high = ends
    assert _on_own_scale(Parameter("size", value, low, high, "")) == pytest.approx(scaled)
