# SPDX-License-Identifier: BSD-3-Clause
import json
import os
import re
from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser
from types import SimpleNamespace

import numpy as np
import pytest

from sklvalve.recording.thinning import decimate
from sklvalve.report import write_report
from sklvalve.report.displays.improvement import improvements_of
from sklvalve.report.html import render
from sklvalve.report.intervals import interval_figures
from sklvalve.report.signals import outline, residual_map, where_present
from tests.report import examples

pytest.importorskip("jinja2", reason='needs pip install "sklvalve[report]"')
pytest.importorskip("matplotlib", reason='needs pip install "sklvalve[report]"')

VOID = {"meta", "br", "hr", "img", "link", "input"}


class _Page(HTMLParser):
    """Checks nesting and collects what a browser would act upon."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.attributes, self.tags, self.text = [], [], [], [], ""

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def _read(path):
    page = _Page()
    page.raw = path.read_text(encoding="utf-8")
    page.feed(page.raw)
    page.close()
    assert page.open == []
    return page


def _text(words):
    page = _Page()
    page.feed(words)
    return page.text.replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.parametrize("make", examples.ALL)
def test_page_is_whole_small_and_alone(make, tmp_path):
    path = tmp_path / "report.html"
    write_report(path, examples.diagnosis(make()), title="FV-101")
    assert path.stat().st_size < 2_000_000
    assert os.listdir(tmp_path) == ["report.html"]
    page = _read(path)
    assert len(page.ids) == len(set(page.ids))
    assert not {"link", "iframe", "object", "embed", "img"} & set(page.tags)
    assert "http:" not in page.raw
    assert "https:" not in page.raw
    for name, value in page.attributes:
        assert "//" not in (value or ""), (name, value)
        if name in ("href", "xlink:href") or (value or "").startswith("url("):
            target = re.search(r"#([^)]+)", value)[1]
            assert target in page.ids
    intervals = len([picture for picture in interval_figures(make()) if picture])
    assert page.tags.count("svg") == 6 + len(improvements_of(make())) + intervals
    assert all(value for name, value in page.attributes if name == "aria-label")


def test_only_the_page_s_own_script_may_run_and_nothing_may_be_fetched(tmp_path):
    path = tmp_path / "report.html"
    write_report(path, examples.diagnosis(examples.named(), n=400))
    page = _read(path)
    policy = next(value for name, value in page.attributes if name == "content" and "default-src" in value)
    assert policy.startswith("default-src 'none';")
    data, own = re.findall(r"<script([^>]*)>(.*?)</script>", page.raw, flags=re.DOTALL)
    assert data[0] == ' type="application/json" id="trends"'
    assert set(json.loads(data[1])["charts"]) == {"recording", "residual"}
    assert own[0] == ""
    assert f"script-src 'sha256-{b64encode(sha256(own[1].encode()).digest()).decode()}'" in policy
    assert not any(name.startswith("on") for name, _ in page.attributes)


def test_without_traces_the_page_has_its_words():
    made = SimpleNamespace(to_dict=examples.named, traces={})
    page = render(made)
    assert "seat leakage" in page
    assert "<script" not in page
    # errors, and the interval of the leak
    assert page.count("<svg") == 2


@pytest.mark.slow
def test_where_nothing_was_corrected_there_is_no_before_and_after():
    made = examples.diagnosis(examples.no_mismatch(), n=3000)
    assert "before and after" in render(made)
    made.traces["corrected"] = made.traces["nominal"]
    page = render(made)
    assert "before and after" not in page
    assert "after the correction" not in page
    assert "simulation after" not in page
    assert page.count("<svg") == 6


def test_what_acts_everywhere_shades_nothing():
    made = examples.diagnosis(examples.named(), n=400)
    made.to_dict = lambda: examples.named() | {"location": {"blocks": ["valve"], "regions": []}}
    made.traces["flagged"] = np.ones(400, dtype=bool)
    page = render(made)
    assert "acts in all rows, so none are shaded" in page
    assert '"flagged": []' in page
    made.traces["flagged"][:20] = False
    assert '"flagged": []' not in render(made)


def test_finding_stands_first_then_how_sure_then_what_to_do(tmp_path):
    text = " ".join(_text(render(examples.diagnosis(examples.named(), n=400))).split())
    places = [
        text.index(words)
        for words in (
            "Likely fault: the seat leaks or a bypass is open, in the valve",
            "How sure In blind tests",
            "What to do next Close the valve",
            "What correcting it brings Including it",
            "Where and when",
            "signature",
            "What was found",
            "Error on 1440 unseen rows",
            "Not testable with this recording",
            "steps of 0.5 % of travel",
            "Details",
            "Provenance",
        )
    ]
    assert places == sorted(places)


@pytest.mark.parametrize(
    "lacking", [{"opening": False}, {"pressures": False}, {"flow": False}, {"flow": False, "opening": False}]
)
def test_page_with_signals_missing(lacking, tmp_path):
    made = examples.diagnosis(examples.named(), n=400, **lacking)
    for model in ("nominal", "corrected"):
        made.traces[model] = {
            role: values for role, values in made.traces[model].items() if lacking.get(role, True)
        }
    write_report(tmp_path / "report.html", made)
    assert "seat leakage" in _read(tmp_path / "report.html").text


def test_page_says_on_which_rows_it_proves(tmp_path):
    path = tmp_path / "report.html"
    for until, expected, absent in (
        (2400, "on 1440 unseen rows", "held out in turn"),
        (None, "held out in turn", "unseen rows"),
    ):
        made = examples.named()
        del made["proof"]
        diagnosis = examples.diagnosis(made)
        diagnosis.traces["until"] = until
        write_report(path, diagnosis)
        text = " ".join(_read(path).text.split())
        assert expected in text
        assert absent not in text
    # a loop is not simulated behind the rows used, and nothing was proven there
    diagnosis = examples.diagnosis(made)
    diagnosis.traces["until"] = 2400
    for model in ("nominal", "corrected"):
        diagnosis.traces[model] = {"flow": np.where(np.arange(3000) < 2400, 1.0, np.nan)}
    write_report(path, diagnosis)
    text = " ".join(_read(path).text.split())
    assert "held out in turn" in text
    assert "were not used" in text


def test_a_number_stays_with_its_unit(tmp_path):
    path = tmp_path / "report.html"
    write_report(path, examples.diagnosis(examples.named(), n=400))
    page = path.read_text(encoding="utf-8")
    assert "for 60\N{NO-BREAK SPACE}s." in page
    assert "0.22\N{NO-BREAK SPACE}m3/h" in page
    # the share beside a bar has no room for a second line
    assert re.search(r"\.bars \.value {[^}]*white-space: nowrap", page)


def test_rows_are_shaded_only_while_the_page_says_it_is_there():
    traces = examples.traces(3000) | {"flagged": np.ones(3000, dtype=bool)}
    shown = where_present(traces, {"intervals": [[100.0, 200.0], [2500.0, 2999.0]]})["flagged"]
    assert np.flatnonzero(shown).tolist() == [*range(100, 201), *range(2500, 3000)]
    assert where_present(traces, {"intervals": []}) is traces


def test_words_from_outside_are_escaped(tmp_path):
    evil = "<script>alert(1)</script>"
    made = examples.named()
    made["data"] = [{"finding": evil, "role": evil, "detail": evil}]
    made["provenance"] |= {"note": evil}
    made["next_test"] = evil
    made["not_testable"] = [{"name": evil, "needs": evil}]
    made["effects"] = [
        examples.LEAK
        | {"sentence": evil, "separated_by": evil, "members": [{"name": evil, "probability": 1.0}]}
    ]
    diagnosis = examples.diagnosis(made, n=400)
    diagnosis.traces["units"]["flow"] = evil
    path = tmp_path / "report.html"
    write_report(path, diagnosis, title=evil, source=evil)
    assert evil not in path.read_text(encoding="utf-8")
    page = _read(path)
    assert page.tags.count("script") == 2
    assert page.text.count(evil) >= 6


def test_reports_of_the_same_diagnosis_are_equal(tmp_path):
    for name in ("one.html", "two.html"):
        write_report(tmp_path / name, examples.diagnosis(examples.named(), n=400))
    assert (tmp_path / "one.html").read_bytes() == (tmp_path / "two.html").read_bytes()


def test_failed_writing_leaves_nothing(tmp_path):
    (tmp_path / "report.html").mkdir()
    with pytest.raises(OSError):
        write_report(tmp_path / "report.html", examples.diagnosis(examples.named(), n=400))
    assert os.listdir(tmp_path) == ["report.html"]


def test_long_recording_stays_small(tmp_path):
    path = tmp_path / "report.html"
    write_report(path, examples.diagnosis(examples.named(), n=86_400))
    assert path.stat().st_size < 2_000_000


def test_thinning_keeps_peaks_ends_and_gaps():
    rng = np.random.default_rng(1)
    x = np.arange(20_000.0)
    y = rng.standard_normal(20_000)
    y[7_321], y[15_002] = 40.0, -40.0
    y[3_000:4_000] = np.nan
    thin_x, thin_y = decimate(x, y)
    assert len(thin_x) <= 1501
    assert np.nanmax(thin_y) == 40.0
    assert np.nanmin(thin_y) == -40.0
    assert thin_x[-1] == x[-1]
    assert np.isnan(thin_y[(thin_x > 3_050) & (thin_x < 3_950)]).all()
    assert np.all(np.diff(thin_x) >= 0.0)


def test_short_course_is_kept_as_it_is():
    x = np.arange(100.0)
    assert decimate(x, x)[0] is x


def test_residual_map_falls_and_outlines_what_was_flagged():
    shape = residual_map(examples.traces(6000))
    before, after = (np.nanmean(np.abs(shape.means[model])) for model in ("nominal", "corrected"))
    assert after < 0.5 * before
    assert shape.flagged.any()
    border = {point for segment in outline(shape.x, shape.y, shape.flagged) for point in segment}
    assert min(x for x, _ in border) >= shape.x[0]
    assert max(x for x, _ in border) < 20.0
