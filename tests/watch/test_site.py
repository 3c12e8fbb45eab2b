# SPDX-License-Identifier: BSD-3-Clause
"""What the pages say first, and what they must not claim."""

import datetime as dt

import pytest

from sklvalve.watch.plant import Plant
from sklvalve.watch.record import Finding
from sklvalve.watch.site import write_site
from sklvalve.watch.site.pages import ValvePage, headline_of, in_order
from sklvalve.watch.store import Store
from sklvalve.watch.valve import Watch

PLANT = Plant("North <b>", ())


def test_nothing_to_do_is_said_of_watched_valves_alone():
    pages = [ValvePage("A", "sound", "unchanged"), ValvePage("B", "commissioning", "being learnt")]
    assert headline_of(PLANT, pages) == (
        "Nothing to do today: no change was found in 1 watched valves. Of 1 more nothing is known yet."
    )


def test_what_calls_comes_first_and_the_largest_before_others():
    pages = [
        ValvePage("A", "sound", "unchanged"),
        ValvePage("B", "calls", "calls", what="backlash", since="2026-01-02", weight=0.1),
        ValvePage("C", "calls", "calls", what="clogging", since="2026-01-03", weight=0.2),
    ]
    assert [page.tag for page in in_order(pages)] == ["C", "B", "A"]
    assert headline_of(PLANT, pages).startswith("2 valves call for attention. First: C, clogging, since 2026")


@pytest.fixture
def site(tmp_path):
    """Pages of a valve that called, of whose days nothing is left."""
    store = Store(tmp_path / "state")
    store.prepare("North")
    called = ("A", "first", "2026-01-09", "2026-01-08", "step", 9e3, 7305.0, "backlash")
    store.save_finding(Finding(*called, "named", "Likely fault: <i>play</i>.", ("backlash",)))
    watches = [Watch("A", "calls"), Watch("B", "cannot tell", ("<script>alert(1)</script>",))]
    index = write_site(tmp_path / "site", PLANT, watches, tmp_path / "state")
    return {file.name: file.read_text(encoding="utf-8") for file in index.parent.rglob("*.html")}


def test_two_processes_write_the_same_pages(tmp_path, site):
    watches = [Watch("A", "calls"), Watch("B", "cannot tell", ("<script>alert(1)</script>",))]
    index = write_site(tmp_path / "again", PLANT, watches, tmp_path / "state", n_jobs=2)
    again = {file.name: file.read_text(encoding="utf-8") for file in index.parent.rglob("*.html")}
    assert again == site


def test_a_call_is_shown_even_where_its_days_are_gone(site):
    assert "First: A, " in site["index.html"]
    assert "2026-01-08" in site["A.html"]
    assert "evidence 9,000, where the limit is 7,305" in site["A.html"]
    assert "How large" not in site["A.html"]


def test_nothing_from_a_file_is_taken_for_html(site):
    for page in site.values():
        assert "<script>" not in page
        assert "<i>play" not in page
        assert "North <b>" not in page
        assert "http" not in page.replace("http-equiv", "")


def test_no_page_gives_a_frequency_that_was_not_measured(site):
    assert "How often it\ndoes on plants is not measured yet" in site["index.html"]
    assert "years at most" not in "".join(site.values())
    assert str(dt.date.today()) not in "".join(site.values())


def test_the_demonstration_judges_what_a_watch_tells(tmp_path):
    from sklvalve.cli.demo_plant import judge
    from sklvalve.cli.watch import content_of

    store = Store(tmp_path)
    store.prepare("North")
    called = ("A", "first", "2026-01-09", "2026-01-08", "step", 9e3, 7305.0, "backlash")
    store.save_finding(Finding(*called, "named", "Likely fault: play.", ("backlash/stiction",)))
    calls, sound = content_of(PLANT, [Watch("A", "calls"), Watch("B", "sound")], tmp_path)["valves"]
    fault = {"effect": "backlash", "first_day": "2026-01-05"}
    assert judge(calls, fault) == "called on 2026-01-09, named rightly"
    assert judge(calls, fault | {"effect": "friction"}) == "called on 2026-01-09, named wrongly"
    assert judge(calls, fault | {"first_day": "2026-01-10"}) == "called before it began"
    assert judge(calls, None) == "called without a reason"
    assert (judge(sound, None), judge(sound, fault)) == ("right", "went unnoticed")
