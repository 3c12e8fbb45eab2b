# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of then and now: means by bins, the stretch of a stem, and what is drawn of which signals."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.report.html import render
from sklvalve.report.signals import as_shown
from sklvalve.report.then_and_now import by_bins, stretch, then_and_now_figures
from tests.report import examples

pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
pytest.importorskip("matplotlib", reason='needs pip install "sklvalve[report]"')


def _drawn(d, traces):
    return then_and_now_figures(d, as_shown(traces, d.get("location") or {}))


def test_means_by_bins_are_of_whole_rows_only():
    x = np.repeat(np.linspace(0.0, 1.0, 20), 10)
    then = 2.0 * x
    then[:3] = np.nan
    curves = by_bins(x, then, x, np.full(200, 0.5))
    np.testing.assert_allclose(curves.then, 2.0 * curves.at)
    np.testing.assert_allclose(curves.now, curves.at)
    np.testing.assert_allclose(curves.half, 0.98)
    assert by_bins(np.full(50, 0.3), np.ones(50), np.ones(50), np.ones(50)) is None
    assert by_bins(x, np.full(200, np.nan), x, x) is None


def test_the_stretch_of_a_stem_is_where_a_small_move_is_missed():
    opening = np.concatenate([np.linspace(0.0, 90.0, 800), np.full(200, 90.0), np.linspace(90.0, 80.0, 200)])
    then, now = opening.copy(), opening.copy()
    then[1100:1160] += 1.5
    both = {
        "recorded": {"opening": opening},
        "nominal": {"opening": then},
        "corrected": {"opening": now},
    }
    part = stretch(both, np.ones(1200, dtype=bool))
    assert part.start >= 1000
    assert part.start < 1130 < part.stop
    assert stretch(both | {"recorded": {}}, np.ones(1200, dtype=bool)) is None
    short = stretch(both, np.arange(1200) < 50)
    assert (short.start, short.stop) == (0, 50)


def test_three_pictures_where_all_is_recorded_each_with_words_for_those_who_cannot_see():
    made = examples.since_history(examples.named())
    pictures = _drawn(made, examples.traces_since())
    assert [picture.alt.split(":")[0] for picture in pictures] == [
        "Installed characteristic then and now",
        "Stem response then and now",
        "Mean residual of flow by opening, then and now",
    ]
    for picture in pictures:
        assert 'role="img"' in picture.svg
        assert "expected, 95 %" in picture.svg
        assert picture.caption


def test_without_an_opening_the_stem_is_not_drawn():
    made = examples.since_history(examples.no_mismatch())
    pictures = _drawn(made, examples.traces_since(opening=False))
    assert [picture.alt.split(":")[0] for picture in pictures] == [
        "Installed characteristic then and now",
        "Mean residual of flow by command, then and now",
    ]


def test_only_what_there_are_traces_of_is_drawn():
    made = examples.since_history(examples.named())
    assert _drawn(made, examples.traces()) == []
    alone = examples.traces_since()
    del alone["then_scatter"]
    assert len(_drawn(made, alone)) == 3
    made["since_history"]["residuals"] = {}
    assert len(_drawn(made, examples.traces_since())) == 2


def test_the_page_shows_them_and_says_what_then_is():
    made = examples.since_history(examples.named())
    page = render(SimpleNamespace(to_dict=lambda: made, traces=examples.traces_since()))
    assert page.count('id="since-') >= 3
    assert "then is the simulation with the calibration expected from it" in page
    healthy = examples.named()
    assert "since-" not in render(examples.diagnosis(healthy))
