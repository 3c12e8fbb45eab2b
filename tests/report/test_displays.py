# SPDX-License-Identifier: BSD-3-Clause
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from sklearn.exceptions import NotFittedError

from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.recording import Recording, Valve
from sklvalve.report import (
    ExplanationDisplay,
    FitImprovementDisplay,
    RecordingDisplay,
    ResidualMapDisplay,
    SignatureDisplay,
)
from tests.report import examples

plt = pytest.importorskip("matplotlib.pyplot", reason='needs pip install "sklvalve[plot]"')

ALL = (ExplanationDisplay, FitImprovementDisplay, RecordingDisplay, ResidualMapDisplay, SignatureDisplay)


@pytest.fixture(autouse=True)
def _closed():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def diagnosis():
    return examples.diagnosis(examples.named_twice())


@pytest.mark.parametrize("display", ALL, ids=lambda display: display.__name__)
def test_made_of_a_diagnosis_or_of_the_estimator_that_made_it(display, diagnosis):
    made = display.from_diagnosis(diagnosis)
    assert all(ax.figure is made.figure_ for ax in np.ravel(made.ax_))
    finder = MissingPhysicsFinder()
    finder.diagnosis_ = diagnosis
    again = display.from_estimator(finder)
    assert np.shape(again.ax_) == np.shape(made.ax_)
    assert again.figure_ is not made.figure_


@pytest.mark.parametrize("display", ALL, ids=lambda display: display.__name__)
def test_an_estimator_that_is_not_fitted_is_refused(display):
    with pytest.raises(NotFittedError):
        display.from_estimator(MissingPhysicsFinder())


@pytest.mark.parametrize("display", [RecordingDisplay, ResidualMapDisplay, SignatureDisplay])
def test_a_diagnosis_without_traces_says_so(display):
    with pytest.raises(ValueError, match="expected a diagnosis with its traces"):
        display.from_diagnosis(SimpleNamespace(to_dict=examples.named, traces={}))


def test_draws_on_axes_that_are_given_and_again_on_others(diagnosis):
    figure, axes = plt.subplots(1, 2)
    made = SignatureDisplay.from_diagnosis(diagnosis, ax=axes)
    assert made.figure_ is figure
    assert [ax.get_ylabel() for ax in axes] == ["opening [%]", "flow at a drop of 100 kPa [m3/h]"]
    other = plt.figure()
    made.plot(other.subplots(1, 2))
    assert made.figure_ is other
    with pytest.raises(ValueError, match="ax must hold 2 axes, one a panel; got 1"):
        made.plot(plt.figure().subplots())


def test_recording_shades_the_flagged_rows_and_marks_those_not_used(diagnosis):
    made = RecordingDisplay.from_diagnosis(diagnosis)
    assert len(made.ax_) == 3
    first = made.ax_[0]
    assert {line.get_label() for line in first.lines[:2]} == {"opening [%]", "command [%]"}
    (bars,) = (each for each in first.collections if len(each.get_paths()))
    spans = [path.get_extents().intervalx for path in bars.get_paths()]
    flagged = np.asarray(diagnosis.traces["flagged"])
    inside = np.any([(made.time >= low) & (made.time <= high) for low, high in spans], axis=0)
    assert inside[flagged].all()
    # a bucket has at most three rows here, at either end of each time
    assert (inside & ~flagged).sum() <= 6 * len(spans)
    assert any(np.allclose(line.get_xdata(), 2400.0) for line in first.lines)


def test_what_is_left_is_drawn_before_and_after(diagnosis):
    made = RecordingDisplay.from_diagnosis(diagnosis, show="residual")
    assert len(made.panels) == 2
    before, after = (np.nanstd(course.values) for course in made.panels[1])
    assert after < 0.5 * before
    with pytest.raises(ValueError, match='show must be "recorded" or "residual"; got \'rest\''):
        RecordingDisplay.from_diagnosis(diagnosis, show="rest")


def test_recording_is_drawn_before_any_diagnosis():
    valve = Valve.from_dict({"recording": {"command": {"column": "CV", "unit": "%"}}})
    time = np.arange(50.0)
    made = RecordingDisplay.from_recording(
        Recording.from_frame({"time": time, "CV": 50.0 + 10.0 * np.sin(time / 5.0)}, valve)
    )
    (course,) = made.panels[0]
    np.testing.assert_allclose(course.values, 50.0 + 10.0 * np.sin(time / 5.0), atol=1e-12)
    assert made.ax_.get_xlabel() == "time from the first sample [s]"


def test_map_has_one_scale_and_falls(diagnosis):
    made = ResidualMapDisplay.from_diagnosis(diagnosis)
    scales = [ax.collections[0].get_clim() for ax in made.ax_]
    assert scales[0] == scales[1] == (-made.limit, made.limit)
    before, after = (np.nanmean(np.abs(made.means[model])) for model in ("nominal", "corrected"))
    assert after < 0.5 * before
    assert [ax.get_title() for ax in made.ax_] == ["before", "after"]


def test_map_of_any_predictions_finds_where_they_are_wrong():
    rng = np.random.default_rng(0)
    x, y = rng.uniform(0.0, 1.0, (2, 4000))
    made = ResidualMapDisplay.from_predictions(x, y, y_true=x + (y > 0.5), y_pred=x, x_label="x")
    wrong = made.y_edges[:-1] >= 0.5
    np.testing.assert_allclose(np.nanmean(made.means["nominal"][:, wrong]), 1.0, atol=0.05)
    np.testing.assert_allclose(np.nanmean(made.means["nominal"][:, made.y_edges[1:] < 0.5]), 0.0, atol=1e-12)
    assert made.ax_.get_xlabel() == "x"
    with pytest.raises(ValueError, match="thirty rows or more"):
        ResidualMapDisplay.from_predictions(x[:10], y[:10], y_true=x[:10], y_pred=x[:10])


def test_explanations_stand_in_order_with_their_shares(diagnosis):
    made = ExplanationDisplay.from_diagnosis(diagnosis)
    names = [label.get_text() for label in made.ax_.get_yticklabels()]
    assert names == ["backlash", "seat leakage", "an open bypass"]
    shares = [bar.get_width() for bar in made.ax_.patches if bar.get_width() < 1.0]
    assert shares == [0.999, 0.61, 0.36]
    assert [text.get_text() for text in made.ax_.texts] == ["> 99 %", "61 %", "36 %"]


def test_what_to_do_next_stands_below_the_explanations():
    made = ExplanationDisplay.from_diagnosis(examples.diagnosis(examples.named()))
    assert made.ax_.get_xlabel() == "probability"
    assert made.figure_.get_supxlabel() == "Next test: Close the valve for 60 s."
    made.plot(plt.figure().subplots())
    assert made.ax_.get_xlabel() == "probability\n\nNext test: Close the valve for 60 s."


@pytest.mark.parametrize("pairs", [0, 2])
@pytest.mark.parametrize("count", [1, 4])
def test_a_long_next_test_takes_no_height_from_the_bars_and_is_not_cut(pairs, count):
    words = " ".join(["Hold the command at 12 % for 60 s."] * 17)
    assert len(words) > 590
    pair = SimpleNamespace(names=("seat_leakage", "bypass_open"), now=2.0, expected=31.25)
    made = ExplanationDisplay([[("seat leakage", 0.97)] * count], words, [pair] * pairs).plot()
    figure = made.figure_
    figure.draw_without_rendering()
    first = np.ravel(made.ax_)[0]
    bars = [bar.get_window_extent().height / figure.dpi for bar in first.patches]
    assert min(bars) >= 0.15
    (strip,) = (text for text in figure.texts if "Hold the command" in text.get_text())
    assert " ".join(strip.get_text().split()) == f"Next test: {words}"
    box, paper = strip.get_window_extent(), figure.bbox
    assert box.x0 >= 0.0
    assert box.x1 <= paper.width
    assert box.y0 >= 0.0
    for ax in np.ravel(made.ax_):
        drawn = ax.get_tightbbox()
        assert drawn.y0 >= box.y1, "the words lie on a panel"
        assert drawn.y1 <= paper.height


def test_pairs_of_a_plan_are_drawn_from_now_to_expected(diagnosis):
    pair = SimpleNamespace(names=("seat_leakage", "bypass_open"), now=2.0, expected=31.25)
    plan = SimpleNamespace(sentence="Close the valve at two pressure drops.", pairs=[pair])
    made = ExplanationDisplay.from_diagnosis(diagnosis, plan=plan)
    first, second = made.ax_
    assert made.figure_.get_supxlabel() == "Next test: Close the valve at two pressure drops."
    assert "Next test" not in first.get_xlabel() + second.get_xlabel()
    assert [label.get_text() for label in second.get_yticklabels()] == ["seat leakage or an open bypass"]
    assert any(np.array_equal(line.get_xdata(), [2.0, 31.25]) for line in second.lines)
    assert [text.get_text() for text in second.texts] == ["2 to 31.2"]
    assert any(np.array_equal(line.get_xdata(), [14.0, 14.0]) for line in second.lines)
    finder = MissingPhysicsFinder()
    finder.diagnosis_ = diagnosis
    assert len(ExplanationDisplay.from_estimator(finder, plan=plan).ax_) == 2


def test_nothing_found_is_told_in_words():
    made = ExplanationDisplay.from_diagnosis(examples.diagnosis(examples.no_mismatch()))
    assert "no effect of the catalogue was found" in [text.get_text() for text in made.ax_.texts]


def test_errors_are_drawn_beside_the_black_box(diagnosis):
    made = FitImprovementDisplay.from_diagnosis(diagnosis)
    assert [bar.get_width() for bar in made.ax_.patches] == [1.9, 0.5, 0.22]
    assert any(np.allclose(line.get_xdata(), 0.2) for line in made.ax_.lines), "noise"
    with pytest.raises(ValueError, match="no error on held-out rows is known"):
        FitImprovementDisplay.from_diagnosis(examples.diagnosis(examples.cannot_tell()))


def test_travel_is_told_in_percent():
    made = examples.named()
    made["fit"] = {"opening": made["fit"]["flow"] | {"unit": "1", "noise_floor": 0.001}}
    made["fit"]["opening"]["rmse"] = {"nominal": 0.021, "black_box": None, "corrected": 0.004}
    (improvement,) = FitImprovementDisplay.from_diagnosis(examples.diagnosis(made)).improvements
    assert improvement.unit == "% of travel"
    assert improvement.errors == pytest.approx({"nominal": 2.1, "corrected": 0.4})


def test_without_matplotlib_the_extra_is_named(monkeypatch, diagnosis):
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match="pictures need matplotlib"):
        ExplanationDisplay.from_diagnosis(diagnosis)


def test_the_axis_has_the_calendar_where_the_recording_has_it(diagnosis):
    traces = diagnosis.traces | {"first_stamp": "2024-03-01T13:28:00"}
    made = RecordingDisplay.from_diagnosis(SimpleNamespace(to_dict=diagnosis.to_dict, traces=traces))
    last = made.ax_[-1]
    assert made.time[0] == np.datetime64("2024-03-01T13:28:00")
    assert made.time[-1] - made.time[0] == np.timedelta64(2999, "s")
    assert last.get_xlabel() == "time"
    made.figure_.canvas.draw()
    ticks = [label.get_text() for label in last.get_xticklabels()]
    assert "13:30" in ticks
    assert last.xaxis.get_offset_text().get_text() == "2024-03-01"
    # joined recordings are drawn one after the other, and no clock runs through both
    joined = traces | {"begins": [0, 1000]}
    made = RecordingDisplay.from_diagnosis(SimpleNamespace(to_dict=diagnosis.to_dict, traces=joined))
    assert made.ax_[-1].get_xlabel() == "time, the recordings one after the other [s]"


def test_a_stamp_that_is_none_leaves_seconds(diagnosis):
    traces = diagnosis.traces | {"first_stamp": "yesterday"}
    made = RecordingDisplay.from_diagnosis(SimpleNamespace(to_dict=diagnosis.to_dict, traces=traces))
    assert made.ax_[-1].get_xlabel() == "time from the first sample [s]"
