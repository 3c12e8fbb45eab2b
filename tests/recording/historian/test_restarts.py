# SPDX-License-Identifier: BSD-3-Clause
"""A clock that starts again begins another run; late reports, overlaps and a night in autumn do not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sklvalve.recording import InputError
from sklvalve.recording.historian import ImportSettings, import_export, import_runs
from sklvalve.recording.historian.restarts import restarts
from tests.recording.historian.exports import course, iso, local, long_text, moments, wide_text

A = np.arange(100)
JITTER = np.random.default_rng(0)
STREAMS = {
    "from nought": ([A, A, A], [100, 200]),
    "a longer one between": ([A[:20], A, A[:50]], [20, 120]),
    "short ones": ([A[:5], A[:5]], [5]),
    "half a minute shared": ([A[:50], A[:50] + 20], [50]),
    "three rows shared": ([A[:50], A[:50] + 47], [50]),
    "the later first": ([A[50:], A[:50]], [50]),
    "newest first": ([A[::-1], A[:30][::-1]], [100]),
    "stamps twice": ([np.repeat(A, 2), np.repeat(A, 2)], [200]),
    "one run": ([A], []),
    "one run, newest first": ([A[::-1]], []),
    "two stamps exchanged": ([A[:10], [11, 10], A[12:]], []),
    "a late report": ([A, [20]], []),
    "three late reports": ([A, [20, 21, 22]], []),
    "a late block": ([A[:30], A[60:80], A[30:60], A[80:]], []),
    "unsteady stamps": ([A + JITTER.normal(0.0, 0.8, 100)], []),
    "no order": ([JITTER.permutation(A)], []),
}
TIMES = moments("2024-06-28 10:00:00", 60, 5)
VALUES = course(60)


def _ticks(parts):
    return (1e6 * np.concatenate(parts)).astype(np.int64)


@pytest.mark.parametrize(("parts", "starts"), STREAMS.values(), ids=STREAMS)
def test_where_a_clock_starts_again(parts, starts):
    assert restarts(_ticks(parts), local=False) == starts


@given(st.lists(st.integers(30, 90), min_size=1, max_size=6), st.integers(1, 20))
def test_runs_from_nought_are_parted_at_their_joints(rows, step):
    parts = [step * np.arange(count) for count in rows]
    assert restarts(_ticks(parts), local=False) == np.cumsum(rows)[:-1].tolist()


@pytest.fixture
def made(tmp_path):
    """Import a text as an export, with its runs."""

    def run(*texts, **settings):
        paths = [tmp_path / f"export{number}.csv" for number in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text)
        return import_runs(paths, ImportSettings(**settings))

    return run


def _seconds(count, values, names=("FIC1.PV", "FIC1.OP")):
    return wide_text(names, [f"{5 * row}" for row in range(count)], [values] * len(names))


def _joined(*texts):
    """Rows of several wide tables under the names of the first."""
    return texts[0] + "".join(text.split("\n", 1)[1] for text in texts[1:])


def _are_the_courses(imported, courses):
    assert len(imported.runs) == len(courses)
    for run, values in zip(imported.runs, courses, strict=True):
        np.testing.assert_allclose(run.columns["FIC1.PV"], values, atol=1e-9)


def test_runs_of_seconds_are_recordings_of_their_own(made):
    other = course(40, 20.0, 30.0)
    imported = made(_joined(_seconds(60, VALUES), _seconds(40, other)))
    _are_the_courses(imported, [VALUES, other])
    assert [run["line"] for run in imported.account["runs"]] == [2, 62]
    assert "base" not in imported.account


def test_a_header_that_is_there_again_is_no_row(made):
    text = _seconds(60, VALUES)
    _are_the_courses(made(text + text), [VALUES, VALUES])


def test_dated_runs_that_overlap(made):
    early, late = iso(TIMES), iso(moments("2024-06-28 10:04:00", 60, 5))
    texts = [wide_text(["FIC1.PV"], stamps, [VALUES + shift]) for shift, stamps in ((0, late), (9, early))]
    _are_the_courses(made(_joined(*texts)), [VALUES, VALUES + 9])


def test_the_same_rows_twice_on_one_clock_are_one_recording(made):
    header, *rows = wide_text(["FIC1.PV"], iso(TIMES), [VALUES]).splitlines()
    imported = made("\n".join([header, *rows[:40], *rows[20:]]))
    _are_the_courses(imported, [VALUES])
    assert imported.account["tags"]["FIC1.PV"]["doubled"] == 20


def test_a_name_of_the_run_parts_what_its_clock_does_not(made):
    first, second, third = (moments(f"2024-06-28 {hour}:00:00", 60, 5) for hour in (12, 10, 14))
    rows = ["time,run,FIC1.PV"]
    for name, times in (("b", first), ("a", second), ("c", third)):
        rows += [f"{stamp},{name},{value:.2f}" for stamp, value in zip(iso(times), VALUES, strict=True)]
    _are_the_courses(made("\n".join(rows)), [VALUES] * 3)
    without = "\n".join(row.split(",")[0] + "," + row.split(",")[2] for row in rows)
    _are_the_courses(made(without), [VALUES] * 3)


@pytest.mark.parametrize("turn_by_turn", [False, True])
def test_runs_in_long_format(made, turn_by_turn):
    rows = []
    for tag in ("FIC1.PV", "FIC1.OP"):
        for run in range(2):
            rows += [(run, 5 * k, f"{tag};{5 * k};{value + run:.2f};Good") for k, value in enumerate(VALUES)]
    if turn_by_turn:
        rows.sort(key=lambda row: row[:2])
    text = "\n".join(["Tag;Time;Value;Quality", *(row for *_, row in rows)])
    _are_the_courses(made(text), [VALUES, VALUES + 1.0])


def test_a_tag_that_one_run_lacks_is_empty_there(made):
    rows = [f"{5 * k},{value},{value}" for k, value in enumerate(VALUES)]
    rows += [f"{5 * k},{value}," for k, value in enumerate(VALUES)]
    imported = made("\n".join(["time,FIC1.PV,TT1", *rows]))
    _are_the_courses(imported, [VALUES, VALUES])
    assert np.isnan(imported.runs[1].columns["TT1"]).all()


def test_all_runs_have_one_period(made):
    rows = [f"{1.0 * k:g},{value}" for k, value in enumerate(VALUES)]
    rows += [f"{5.0 * k:g},{value}" for k, value in enumerate(course(300)[:100])]
    imported = made("\n".join(["time,FIC1.PV", *rows]))
    assert {run["base"]["period"] for run in imported.account["runs"]} == {1.0}


def test_runs_that_nobody_can_put_together_are_refused(made):
    text = long_text(["A"], [f"{k}" for k in range(30)] * 2, course(60), comma=False)
    text += long_text(["B"], [f"{k}" for k in range(60)], VALUES, comma=False).split("\n", 1)[1]
    with pytest.raises(
        InputError, match="the clock of A starts again 1 times, but that of B 0 times; export each run"
    ):
        made(text)


def test_runs_in_one_of_several_files_are_refused(made):
    with pytest.raises(InputError, match="line 62: the clock starts again, so this file holds 2 runs"):
        made(_joined(_seconds(60, VALUES), _seconds(40, VALUES[:40])), _seconds(60, VALUES, ["TT1"]))


def test_runs_of_a_row_each_are_refused(made):
    rows = [f"{k},{'' if k else 1},AUTO" for _ in range(3) for k in range(40)]
    with pytest.raises(InputError, match="no run holds values at two different times"):
        made("\n".join(["time,FIC1.PV,MODE", *rows]))


def test_one_recording_is_asked_for_and_there_are_two(tmp_path):
    path = tmp_path / "export.csv"
    path.write_text(_joined(_seconds(60, VALUES), _seconds(40, VALUES[:40])))
    with pytest.raises(InputError, match="line 62: the clock starts again, so these are 2 recordings"):
        import_export([path])


def test_the_hour_that_comes_twice_is_no_run(made):
    stamps = local(moments("2024-10-26 23:00:00", 480, 30))
    imported = made(wide_text(["FIC1.PV"], stamps, [course(480)]), zone="Europe/Warsaw")
    _are_the_courses(imported, [course(480)])
