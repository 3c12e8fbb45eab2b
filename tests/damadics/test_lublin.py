# SPDX-License-Identifier: BSD-3-Clause
"""Day files of the sugar factory, made here in the same form, and the faults that are in the real ones."""

import datetime
import gzip
import sys

import numpy as np
import pytest

from sklvalve.damadics import FAULTS, LUBLIN_EVENTS, Zone, events_of, lublin_sheet, performance_indices
from sklvalve.damadics import read_lublin as read
from sklvalve.damadics.days import day_of, file_of, iso_day
from sklvalve.recording import Recording, Valve, screen_recording

pd = pytest.importorskip("pandas", reason="needs pandas, of the extra `io`")

ROWS = 60
# columns of CV, P1, P2, T1, X and F, counted from one, as the description of the data lists them
COLUMNS = {1: (6, 2, 3, 4, 7, 5), 2: (22, 18, 19, 20, 23, 21), 3: (28, 24, 25, 26, 29, 27)}
NAMES = ["CV", "P1", "P2", "T1", "X", "F"]


def table():
    """Numbers that tell row and column: 24.007 in column 24 of row 7; likely ones for the third actuator."""
    rows, columns = np.meshgrid(np.arange(ROWS), np.arange(1, 34), indexing="ij")
    numbers = columns + rows / 1000.0
    numbers[:, 0] = np.arange(ROWS)
    swing = np.sin(0.2 * np.arange(ROWS))
    for column, values in zip(
        COLUMNS[3],
        (60 + 10 * swing, 3557 + swing, 2617 - swing, 100.7, 62.5 + 9 * swing, 17 - 5 * swing),
        strict=True,
    ):
        numbers[:, column - 1] = np.round(values, 1)
    return numbers


def write(path, numbers, end="\n"):
    rows = ["\t".join("NaN" if np.isnan(value) else f"{value:.10g}" for value in row) for row in numbers]
    text = (end.join(rows) + end).encode()
    path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)
    return path


@pytest.fixture
def day_file(tmp_path):
    return write(tmp_path / "09112001.txt", table())


@pytest.mark.parametrize("actuator", [1, 2, 3])
def test_each_actuator_has_its_columns(day_file, actuator):
    frame = read(day_file, actuator)
    assert list(frame) == ["time", *NAMES]
    # the first row too, which is no header
    np.testing.assert_array_equal(frame["time"], np.arange(ROWS))
    for name, column in zip(NAMES, COLUMNS[actuator], strict=True):
        np.testing.assert_allclose(frame[name], table()[:, column - 1], rtol=1e-9, err_msg=name)
        assert frame[name].dtype == float


@pytest.mark.parametrize(("actuator", "flow"), [(1, 5.0 / 3600.0), (2, 21.0 / 3600.0)])
def test_roles_are_in_si(day_file, actuator, flow):
    frame = read(day_file, actuator, roles=True)
    assert list(frame) == ["time", "command", "p1", "p2", "temperature", "opening", "flow"]
    command, p1, p2, temperature, stem, _ = COLUMNS[actuator]
    first = frame.iloc[0]
    # in the first row each column holds its own number: percent of closing, kPa, degC, m3/h
    assert first["command"] == pytest.approx(1.0 - command / 100.0)
    assert first["opening"] == pytest.approx(1.0 - stem / 100.0)
    assert (first["p1"], first["p2"]) == (p1 * 1e3, p2 * 1e3)
    assert first["temperature"] == temperature + 273.15
    assert first["flow"] == pytest.approx(flow)


def test_the_flow_of_actuator_three_is_by_mass(day_file):
    # 17 t/h
    assert read(day_file, 3, roles=True)["flow"][0] == pytest.approx(17.0 / 3.6)


@pytest.mark.parametrize("actuator", [1, 2, 3])
def test_the_sheet_leads_to_the_same_as_the_roles(tmp_path, actuator):
    numbers = table()
    # an inlet pressure above the outlet's, where columns count upwards
    for number in COLUMNS.values():
        numbers[:, number[1] - 1] += 1000.0
    path = write(tmp_path / "day.txt", numbers)
    valve = Valve.from_dict(lublin_sheet(actuator))
    recording = Recording.from_frame(read(path, actuator), valve)
    assert recording.mass_flow == (actuator == 3)
    roles = read(path, actuator, roles=True)
    for role in list(roles)[1:]:
        np.testing.assert_allclose(recording[role], roles[role], rtol=1e-12, atol=1e-15, err_msg=role)


def test_sheets_are_ones_own():
    lublin_sheet(3)["actuator"]["spring_range"].append(1.0)
    assert lublin_sheet(3)["actuator"]["spring_range"] == [40.0, 200.0]
    assert [lublin_sheet(each)["valve"]["tag"] for each in (1, 2, 3)] == ["LC51_03", "FC57_03", "LC74_20"]


def test_gaps_stay_gaps(tmp_path):
    numbers = table()
    numbers[5, 26], numbers[:, 20] = np.nan, np.nan
    path = write(tmp_path / "day.txt", numbers)
    assert np.flatnonzero(read(path, 3)["F"].isna()).tolist() == [5]
    assert read(path, 2)["F"].isna().all()
    assert not read(path, 1).isna().any(axis=None)
    recording = Recording.from_frame(read(path, 3), Valve.from_dict(lublin_sheet(3)))
    assert ("gap", "flow") in {(each["finding"], each["role"]) for each in screen_recording(recording)}


@pytest.mark.parametrize(("name", "end"), [("09112001.txt.gz", "\n"), ("a day.txt", "\r\n")])
def test_other_writings_of_the_same(tmp_path, day_file, name, end):
    pd.testing.assert_frame_equal(read(write(tmp_path / name, table(), end), 3), read(day_file, 3))


def test_columns_may_be_padded(tmp_path):
    numbers = table()
    numbers[5, 26] = np.nan
    plain = write(tmp_path / "plain.txt", numbers)
    padded = tmp_path / "padded.txt"
    padded.write_text("".join(f"  {line}\n" for line in plain.read_text().replace("\t", "\t  ").splitlines()))
    pd.testing.assert_frame_equal(read(padded, 3), read(plain, 3))


def test_stamps_have_the_date_of_the_file(tmp_path, day_file):
    stamps = read(day_file, 3, stamps=True)["time"]
    assert stamps.iloc[0] == pd.Timestamp("2001-11-09 00:00:00")
    assert stamps.iloc[-1] == pd.Timestamp("2001-11-09 00:00:59")
    packed = write(tmp_path / "30102001.txt.gz", table())
    assert read(packed, 3, stamps=True)["time"].iloc[1] == pd.Timestamp("2001-10-30 00:00:01")
    recording = Recording.from_frame(read(day_file, 3, stamps=True), Valve.from_dict(lublin_sheet(3)))
    assert recording.stamps[-1] == "2001-11-09T00:00:59"
    assert recording.time[-1] == 59.0
    nameless = write(tmp_path / "day.txt", table())
    with pytest.raises(ValueError, match=r"named after its day, such as 09112001.txt, got 'day.txt'"):
        read(nameless, 3, stamps=True)


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda text: text.replace("\t", ","), "Expected 33 columns between tabs in row 1 of .*, got 1;"),
        (lambda text: "\t".join(f"c{i}" for i in range(33)) + "\n" + text, r"row 1, column 1 \(time\).*'c0'"),
        (lambda text: text.replace("100.7", "hot", 3), r"row 1, column 26 \(T74_00\) of .*got 'hot'"),
        (lambda text: text.replace("\n", "\t1\n"), "in row 1 of .*, got 34"),
        (lambda text: text + "\t".join("1" * 40) + "\n", "in row 61 of .*, got 40"),
        (lambda text: text + text, "each later than the one before, got 0 after 59 in row 61"),
        (lambda text: text.replace("\n59\t", "\n58\t", 1), "got 58 after 58 in row 60"),
        (lambda text: text.replace("\n59\t", "\n86400\t", 1), "got 86400 after 58 in row 60"),
        (lambda text: text.replace("0\t", "-1\t", 1), "got -1 in row 1"),
        (lambda text: text.replace("\n7\t", "\nNaN\t", 1), "got nan after 6 in row 8"),
        (lambda text: text.replace("100.7", "inf", 1), r"row 1, column 26 \(T74_00\) of .*got 'inf'"),
        (lambda text: text.replace("100.7", "1e999", 1), r"row 1, column 26 \(T74_00\) of .*got 'inf'"),
        # cut in the middle of a number, and in the middle of the file
        (lambda text: text[: text.rindex("100.7") + 2], "in row 60 of .*, got 26;.* not cut"),
        (lambda text: text.replace("\n30\t", "\n30\t1\n31\t", 1), "in row 31 of .*, got 2"),
        (lambda text: text.replace("\t100.7", '\t"100.7', 1), r"row 1, column 26 .*got '\"100.7'"),
        (lambda text: "", "in row 1 of .*, got 1"),
    ],
)
def test_what_is_no_day_file_is_refused(day_file, spoil, message):
    day_file.write_text(spoil(day_file.read_text()))
    with pytest.raises(ValueError, match=message) as told:
        read(day_file, 3)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("end", ["", "\n\n", "\n \n"])
def test_the_end_of_the_last_row_may_be_missing_or_blank(day_file, end):
    known = read(day_file, 3)
    day_file.write_text(day_file.read_text().rstrip("\n") + end)
    pd.testing.assert_frame_equal(read(day_file, 3), known)


@pytest.mark.parametrize(
    "spoil",
    [lambda packed: packed[:200], lambda packed: packed[:60] + b"\0\0\0" + packed[63:], lambda packed: b"no"],
)
def test_a_damaged_archive_is_refused(tmp_path, spoil):
    path = write(tmp_path / "09112001.txt.gz", table())
    path.write_bytes(spoil(path.read_bytes()))
    with pytest.raises(ValueError, match=r"Expected a whole gzip file in .*, got one that is cut or damaged"):
        read(path, 3)


@pytest.mark.parametrize("name", ["09112001.zip", "09112001.txt.xz", "09112001.txt.bz2"])
def test_other_archives_are_refused(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(b"PK\x03\x04\xff\xfe" * 20)
    with pytest.raises(ValueError, match=r"row 1 of .*, got 1; .* plain or as \.gz"):
        read(path, 3)


def test_a_file_that_may_not_be_read_is_told(day_file, monkeypatch):
    def denied(path):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("sklvalve.damadics.lublin.Path.read_bytes", denied)
    with pytest.raises(OSError, match=r"09112001\.txt' cannot be read \(Permission denied\); allow it"):
        read(day_file, 3)


def test_missing_seconds_are_told(tmp_path):
    path = write(tmp_path / "day.txt", np.delete(table(), [7, 8, 30], axis=0))
    with pytest.warns(UserWarning, match=r"lacks 3 seconds at 2 places, first after 6 s; there are no rows"):
        frame = read(path, 3)
    assert len(frame) == ROWS - 3


def test_what_is_not_there_is_told(tmp_path, day_file):
    with pytest.raises(
        FileNotFoundError, match=r"Expected the day file '.*10112001.txt', which is not there"
    ):
        read(tmp_path / "10112001.txt", 3)
    for ask in (lambda: read(day_file, 4), lambda: lublin_sheet(4), lambda: events_of("2001-11-09", 4)):
        with pytest.raises(ValueError, match=r"actuator must be 1, 2.*got 4"):
            ask()


def test_without_pandas_the_extra_is_named(day_file, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match=r'pip install "sklvalve\[io\]"'):
        read(day_file, 3)


def test_there_are_nineteen_events():
    assert [event.item for event in LUBLIN_EVENTS] == list(range(1, 20))
    assert {event.fault for event in LUBLIN_EVENTS} == {"f16", "f17", "f18", "f19"} <= set(FAULTS)
    assert [sum(event.actuator == each for event in LUBLIN_EVENTS) for each in (1, 2, 3)] == [7, 6, 6]
    # the lengths that the list of the benchmark gives itself [s]
    lengths = [event.ends - event.begins for event in LUBLIN_EVENTS]
    assert lengths[:12] == [1000, 275, 100, 105, 100, 100, 620, 14, 22, 35, 38, 42]
    assert lengths[12] == np.inf
    assert lengths[13:] == [550, 50, 90, 55, 125, 175]
    assert all(0.0 <= event.begins < event.ends for event in LUBLIN_EVENTS)


def test_the_clock_of_the_events():
    # as the list writes them
    for item, clock in {1: "16:20:00", 7: "10:29:40", 13: "12:20:00", 19: "16:09:10"}.items():
        event = LUBLIN_EVENTS[item - 1]
        midnight = datetime.datetime.fromisoformat(event.day)
        assert f"{midnight + datetime.timedelta(seconds=event.begins):%H:%M:%S}" == clock


def test_events_of_a_day():
    assert [event.item for event in events_of("09112001")] == [2, 4, 3, 15, 16]
    assert [event.item for event in events_of(datetime.date(2001, 11, 17), 2)] == [8, 9, 10, 11, 12]
    assert [event.item for event in events_of(datetime.datetime(2001, 10, 30, 16, 0), actuator=3)] == [14]
    assert events_of("2001-11-10") == ()


@pytest.mark.parametrize("day", ["2001-11-24", "26102001", "31112001", "today", "", 9, None, "20011109"])
def test_days_outside_the_period_are_refused(day):
    with pytest.raises(ValueError, match="A day must be a date from 2001-10-27 to 2001-11-23"):
        events_of(day)


def test_files_are_named_after_their_days():
    assert file_of("2001-11-09") == "09112001.txt"
    assert day_of("09112001.txt") == iso_day("09112001") == "2001-11-09"
    assert [day_of(name) for name in ("09112001.zip", "notes.txt", "31112001.txt", "09111999.txt")] == [
        None
    ] * 4


def test_decisions_on_an_event_are_judged():
    event = LUBLIN_EVENTS[13]
    t = np.arange(86400.0)
    zone = Zone(set_up=55000.0, begins=event.begins, ends=event.ends, horizon=58000.0)
    found = performance_indices(t, (t >= 57350.0) & (t < 57900.0), fault=event.fault, zone=zone)
    # from 57340 s to 57890 s: 10 s late, and 10 s too long within 2340 + 110 s without it
    assert (found.t_dt, found.t_drt, found.t_dm) == (10.0, 10.0, 57350.0)
    assert (found.r_td, found.r_fd) == pytest.approx((540.0 / 550.0, 10.0 / 2450.0))
