# SPDX-License-Identifier: BSD-3-Clause
"""Probabilities against outcomes; time and memory."""

import numpy as np
import pytest

from benchmarks.concealed.scoring.calibration import (
    brier,
    calibration,
    expected_error,
    log_score,
    reliability,
    told_classes,
    told_names,
)
from benchmarks.concealed.scoring.cost import codes, cost, load
from benchmarks.concealed.scoring.rates import Rate


def test_what_is_told(a_line, a_failure):
    sure = [{"probability": 0.9, "members": [0.6, 0.3]}, {}]
    lines = [a_line("a", "named", "b/a", "c", told=sure), a_failure("a"), a_line()]
    lines.append(a_line("", "cannot_tell", "a", told=[{"probability": 0.4}]))
    assert told_classes(lines) == [(0.9, True), (0.4, False)]
    assert told_names(lines) == [(0.6, False), (0.3, True)]


def test_scores_by_hand():
    told = [(0.8, True), (0.8, False), (0.5, True)]
    assert brier(told).value == pytest.approx((0.04 + 0.64 + 0.25) / 3)
    expected = -(np.log(0.8) + np.log(0.2) + np.log(0.5)) / 3
    assert log_score(told).value == pytest.approx(expected)
    assert log_score([(1.0, False)]).value == pytest.approx(-np.log(1e-4))
    assert log_score([(1.0, True)]).value == pytest.approx(0.0, abs=2e-4)


def test_bins():
    told = [(0.0, False), (0.05, True), (0.1, False), (0.95, True), (1.0, True), (1.0, False)]
    bins = reliability(told)
    assert [(b.low, b.true) for b in bins] == [
        (0.0, Rate(1, 2)),
        (0.1, Rate(0, 1)),
        (0.9, Rate(2, 3)),
    ]
    assert [b.mean for b in bins] == pytest.approx([0.025, 0.1, 2.95 / 3])


def test_expected_calibration_error_by_hand():
    """Bins of 2, 1 and 3 classes, off by |0.05 - 1|, 0.1 and |2.95 - 2| in sum, of six."""
    told = [(0.0, False), (0.05, True), (0.1, False), (0.95, True), (1.0, True), (1.0, False)]
    assert expected_error(told).value == pytest.approx((0.95 + 0.1 + 0.95) / 6)
    good = expected_error([(0.75, True)] * 3 + [(0.75, False)])
    assert good.value == pytest.approx(0.0)
    # by the bins of the table: the same figure
    bins = reliability(told)
    assert sum(b.true.of * abs(b.mean - b.true.value) for b in bins) / 6 == pytest.approx((1.9 + 0.1) / 6)


def test_without_probabilities_nothing_is_told(a_line):
    figures = calibration([a_line("a", "named", "a")])
    assert figures.of == 0
    assert figures.bins == []
    for figure in (figures.brier, figures.log_score, figures.expected_error):
        assert str(figure) == "-"


def test_cost(a_line):
    lines = [{"truth": {}, "seconds": s, "code": "x"} for s in (1.0, 2.0, 9.0)] + [{"truth": {}}]
    seconds = cost(lines)
    assert (seconds.of, seconds.median, seconds.most, seconds.total) == (3, 2.0, 9.0, 12.0)
    assert seconds.ninth == pytest.approx(7.6)
    assert str(cost(lines, "peak_mb")) == "-"
    assert np.isnan(load(lines))
    assert load([{"load": 1.0}, {"load": 2.0}, {}]) == 1.5
    assert codes(lines) == {"x": 3, "?": 1}
