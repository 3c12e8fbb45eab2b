# SPDX-License-Identifier: BSD-3-Clause
"""A historian's straight lines, with the digits that a recording is written in."""

import numpy as np
import pytest

from benchmarks.data_defects import swinging_door
from tests.recording.planted import healthy, names, screened, smooth


@pytest.mark.parametrize("column", ["P1", "P2"])
def test_long_shallow_lines_written_to_one_decimal(column):
    columns = healthy()
    columns[column] = np.round(swinging_door(columns[column], 8.0), 1)
    found = screened(columns)
    assert names(found) == {("compressed", column.lower())}
    assert "straight lines" in found[0]["detail"]


def test_smooth_course_without_noise_is_no_compression():
    columns = healthy()
    columns["P2"] = np.round(
        300.0 + 60.0 * np.sin(columns["time"] / 97.0 + np.cos(columns["time"] / 61.0)), 1
    )
    assert ("compressed", "p2") not in names(screened(columns))


def test_opening_exchanged_with_a_command_that_rests_exactly():
    columns = healthy()
    columns["CV"] = np.round(np.repeat(np.random.default_rng(3).uniform(20.0, 80.0, 30), 100), 2)
    rng, late = np.random.default_rng(4), np.concatenate([columns["CV"][:1], columns["CV"][:-1]])
    columns["X"] = np.round((late + rng.normal(0.0, 0.06, 3000)) / 0.05) * 0.05
    assert not names(screened(columns)) & {("swapped", "opening")}
    columns["CV"], columns["X"] = columns["X"], columns["CV"]
    assert ("swapped", "opening") in names(screened(columns))


def test_order_in_a_short_window_needs_both_its_ends():
    columns = healthy(5)
    columns["F"] = np.roll(columns["F"], -7)
    assert ("clock_shift", "flow") in names(screened({name: v[20:1520] for name, v in columns.items()}))
    columns["F"][:1000] = np.roll(columns["F"], 7)[:1000]
    short = {name: v[20:1520] for name, v in columns.items()}
    assert ("clock_shift", "flow") not in names(screened(short))


def stroked():
    columns = healthy()
    columns["X"] = np.round(smooth(columns["CV"], 4.0) + np.random.default_rng(6).normal(0.0, 0.15, 3000), 2)
    return columns


def test_command_that_rests_while_the_stem_strokes():
    columns = stroked()
    columns["CV"][700:1600] = columns["CV"][700]
    (found,) = [each for each in screened(columns) if each["finding"] == "frozen"]
    assert found["role"] == "command"
    ((start, stop),) = found["rows"]
    assert abs(start - 700) <= 60
    assert abs(stop - 1600) <= 60


def test_command_that_rests_while_the_stem_drifts_or_hunts_is_not_blamed():
    columns = stroked()
    columns["CV"][700:1600] = 50.0
    columns["X"][700:1600] = np.round(50.0 + np.linspace(0.0, 20.0, 900) + 0.1 * np.sin(np.arange(900)), 2)
    assert ("frozen", "command") not in names(screened(columns))
    columns = stroked()
    columns["CV"][:] = np.repeat(np.random.default_rng(7).uniform(30.0, 70.0, 3), 1000)
    columns["X"] = np.round(columns["CV"] + 5.0 * np.sin(columns["time"] / 20.0), 2)
    assert ("frozen", "command") not in names(screened(columns))


def test_flow_that_hardly_moves_is_not_exchanged_for_a_pressure():
    columns = healthy(8)
    for name in ("CV", "X"):
        columns[name] = np.round(50.0 + 0.03 * (columns[name] - 50.0), 2)
    root = np.sqrt((columns["P1"] - columns["P2"]) / 100.0)
    rng = np.random.default_rng(9)
    columns["F"] = np.round(0.4 * columns["X"] * np.mean(root) + rng.normal(0.0, 0.2, 3000), 3)
    columns["P2"] = np.round(300.0 + 60.0 * (columns["X"] - 50.0) + rng.normal(0.0, 1.0, 3000), 1)
    assert not {each for each in names(screened(columns)) if each[0] == "swapped"}
