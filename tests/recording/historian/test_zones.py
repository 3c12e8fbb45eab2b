# SPDX-License-Identifier: BSD-3-Clause
"""Local time on the nights when clocks are changed: what order tells is told, the rest is said."""

from zoneinfo import ZoneInfo

import numpy as np
import pytest

from sklvalve.recording import InputError
from sklvalve.recording.historian import ImportSettings, import_export
from sklvalve.recording.historian.moments import HOUR, SECOND
from sklvalve.recording.historian.zones import ClockChanges, offsets_at, read_zone, to_utc
from tests.recording.historian.exports import course, local, moments, wide_text

WARSAW = read_zone("Europe/Warsaw")
# the night of 2024-10-27: 02:00 to 03:00 comes twice, first at +02:00, from 00:00 UTC
AUTUMN = moments("2024-10-26 23:00:00", 480, 30)
SPRING = moments("2024-03-31 00:00:00", 360, 30)


def _ticks(times):
    return np.array([int(time.timestamp()) * SECOND for time in times])


def _wall(times):
    ticks = _ticks(times)
    return ticks + offsets_at(ticks, WARSAW)


def _read(times, order=None):
    changes = ClockChanges()
    order = np.arange(len(times)) if order is None else order
    utc = to_utc(_wall(times)[order], WARSAW, "line {}".format, changes)
    return utc - _ticks(times)[order], changes


@pytest.mark.parametrize("times", [AUTUMN, SPRING, AUTUMN[::-1], SPRING[::-1]])
def test_regular_stamps_come_back_exactly(times):
    wrong, changes = _read(times)
    assert not wrong.any()
    assert changes.assumed == {}
    assert changes.late == {}
    assert sum(changes.told_apart.values()) == (240 if times in (AUTUMN, AUTUMN[::-1]) else 0)


@pytest.mark.parametrize("seed", range(5))
def test_uneven_stamps_are_told_apart_by_order(seed):
    rng = np.random.default_rng(seed)
    kept = np.sort(rng.choice(480, 120, replace=False))
    wrong, _ = _read([AUTUMN[row] for row in kept])
    assert not wrong.any()


def test_stamps_sorted_by_the_wall_clock_stand_twice():
    order = np.argsort(_wall(AUTUMN), kind="stable")
    wrong, changes = _read(AUTUMN, order)
    assert not wrong.any()
    assert changes.assumed == {}


@pytest.mark.parametrize(
    "rows",
    [range(60, 200), range(250, 480), range(130, 300), range(200, 300)],
    ids=["ends in the first", "begins in the second", "ends in the second", "begins in the first"],
)
def test_part_of_the_two_hours_is_placed_by_what_it_joins(rows):
    part = [AUTUMN[row] for row in rows]
    wrong, changes = _read(part)
    assert not wrong.any()
    assert changes.assumed == {}


def test_a_pass_that_nothing_places_is_assumed_and_said():
    alone = [AUTUMN[row] for row in range(150, 200)]
    wrong, changes = _read(alone)
    assert not wrong.any()
    assert changes.assumed == {"2024-10-27 02:00": 50}
    second = [AUTUMN[row] for row in range(270, 320)]
    wrong, changes = _read(second)
    assert set(wrong) == {-HOUR}
    assert changes.assumed == {"2024-10-27 02:00": 50}


def test_a_clock_set_forward_late_is_read_as_the_clock_of_before():
    wall = _wall(SPRING)
    wall[120:140] -= HOUR  # ten minutes went by before somebody set it
    changes = ClockChanges()
    utc = to_utc(wall, WARSAW, "line {}".format, changes)
    assert (utc == _ticks(SPRING)).all()
    assert changes.late == {"2024-03-31 02:00": 20}


@pytest.mark.parametrize("newest_first", [False, True])
def test_a_clock_without_daylight_saving_is_refused_with_the_mend(newest_first):
    winter = _ticks(SPRING) + HOUR
    order = np.arange(360)[::-1] if newest_first else np.arange(360)
    with pytest.raises(InputError, match=r"line 239: .* 02:59:30 does not .*\+01:00|line 120: .* 02:59:30"):
        to_utc(winter[order], WARSAW, "line {}".format, ClockChanges())
    fixed = to_utc(winter, read_zone("+01:00"), "line {}".format, ClockChanges())
    assert (fixed == _ticks(SPRING)).all()


def test_both_nights_are_right_in_whole_imports(tmp_path):
    for name, times, ends in (
        ("a.csv", AUTUMN, ("+02:00", "+01:00")),
        ("s.csv", SPRING, ("+01:00", "+02:00")),
    ):
        values = course(len(times))
        (tmp_path / name).write_text(wide_text(["F"], local(times), [values]))
        imported = import_export([tmp_path / name], ImportSettings(zone="Europe/Warsaw"))
        np.testing.assert_allclose(imported.columns["F"], values)
        assert (imported.stamps[0][-6:], imported.stamps[-1][-6:]) == ends


def test_autumn_without_a_zone_is_refused(tmp_path):
    (tmp_path / "a.csv").write_text(wide_text(["F"], local(AUTUMN), [course(480)]))
    with pytest.raises(InputError, match=r"line 242: the time 2024-10-27T02:00:00 comes after .* --timezone"):
        import_export([tmp_path / "a.csv"])


@pytest.mark.parametrize("name", ["UTC", "GMT", "Z", "+00:00", "Etc/UTC"])
def test_names_of_utc(name):
    assert offsets_at(np.zeros(1, dtype=np.int64), read_zone(name)).tolist() == [0]


@pytest.mark.parametrize(
    ("name", "hours"), [("+5:30", 5.5), ("-03", -3.0), ("UTC+2", 2.0), ("Asia/Kolkata", 5.5)]
)
def test_offsets(name, hours):
    assert offsets_at(_ticks(SPRING[:1]), read_zone(name)).tolist() == [hours * HOUR]


def test_unknown_zone_names_the_nearest():
    with pytest.raises(InputError, match="did you mean 'Europe/Warsaw'"):
        read_zone("Europe/Warsawa")
    with pytest.raises(InputError, match="give one like Europe/Warsaw"):
        read_zone("xyzzy")


def test_computer_without_a_table_of_zones(monkeypatch):
    import zoneinfo

    from sklvalve.recording.historian import zones

    def absent(name):
        raise zoneinfo.ZoneInfoNotFoundError(name)

    monkeypatch.setattr(zones, "ZoneInfo", absent)
    monkeypatch.setattr(zones, "available_timezones", set)
    with pytest.raises(InputError, match="no table of time zones; pip install tzdata, or give the offset"):
        read_zone("Europe/Warsaw")
    assert read_zone("+01:00") is not None


def test_a_zone_is_given_by_its_name():
    with pytest.raises(InputError, match=r"name of a time zone, as 'Europe/Warsaw'; got zoneinfo"):
        read_zone(ZoneInfo("Europe/Warsaw"))
