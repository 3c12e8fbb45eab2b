# SPDX-License-Identifier: BSD-3-Clause
"""How large a change is, where several recordings were joined and where not."""

from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.mismatch.describe.locate import acting_rows
from sklvalve.mismatch.inference.sizes import Sizes
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import span_of


class _Signals(dict):
    def __init__(self, flow, spans):
        super().__init__(flow=flow, p1=flow, p2=flow)
        self.spans = spans

    def __len__(self):
        return len(self["flow"])


class _Bench(Sizes):
    channels = ("flow",)
    tolerance = Tolerance()

    def __init__(self, flow, spans):
        self.recording = _Signals(flow, spans)
        self.spans = {"flow": span_of(flow)}


def _models(gap):
    return SimpleNamespace(predictions={"flow": gap}), SimpleNamespace(predictions={"flow": 0.0 * gap})


@pytest.fixture
def flow():
    """A loop at a tenth of a metre cubed a second, and a test that goes up to three times as much."""
    return np.concatenate([np.full(600, 0.1), np.linspace(0.0, 0.3, 300)])


def test_what_counts_in_a_recording_counts_when_a_wide_test_is_joined(flow):
    gap = np.full(900, 0.0008)
    joined, one = _Bench(flow, [(0, 600), (600, 900)]), _Bench(flow, [(0, 900)])
    assert joined.change(*_models(gap))["flow"] == pytest.approx(0.008)
    assert joined.counts(joined.change(*_models(gap)))
    assert one.change(*_models(gap))["flow"] == pytest.approx(0.0008 / span_of(flow))
    assert not one.counts(one.change(*_models(gap)))


def test_a_recording_in_which_hardly_anything_flows_asks_for_no_hairs_breadth():
    flow = np.concatenate([np.full(600, 1e-6), np.linspace(0.0, 0.3, 300)])
    bench = _Bench(flow, [(0, 600), (600, 900)])
    size = bench.change(*_models(np.full(900, 1e-5)))["flow"]
    assert size == pytest.approx(1e-5 / (0.2 * span_of(flow)))


def test_rows_that_were_not_recorded_speak_for_nothing(flow):
    flow[:600] = np.nan
    bench = _Bench(flow, [(0, 600), (600, 900)])
    gap = np.concatenate([np.full(600, 1.0), np.full(300, 0.003)])
    assert bench.change(*_models(gap))["flow"] == pytest.approx(0.003 / span_of(flow[600:]))


def test_what_is_explained_of_all_recordings_is_a_share_of_the_span_of_all(flow):
    bench = _Bench(flow, [(0, 600), (600, 900)])
    assert bench.change_in_all("flow", *_models(np.full(900, 0.0008))) == pytest.approx(
        0.0008 / span_of(flow)
    )


def test_rows_are_flagged_in_the_recording_in_which_an_effect_counts(flow):
    bench = _Bench(flow, [(0, 600), (600, 900)])
    gap = np.concatenate([np.full(600, 0.0007), np.zeros(281), np.full(19, 0.0035)])
    flagged = acting_rows(bench, *_models(gap))
    assert flagged[:600].all()
    assert flagged[600:].sum() == 19


def test_no_flow_at_all_is_no_change():
    bench = _Bench(np.zeros(900), [(0, 900)])
    assert bench.change(*_models(np.zeros(900))) == {"flow": 0.0}
