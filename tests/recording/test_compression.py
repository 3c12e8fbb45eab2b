# SPDX-License-Identifier: BSD-3-Clause
"""Compression as fine as the noise is told, and what only looks like it is not."""

import numpy as np
import pytest

from benchmarks.data_defects import box_car, swinging_door
from tests.recording.planted import N, healthy, names, screened, smooth


@pytest.mark.parametrize("share", [1.0, 2.0])
@pytest.mark.parametrize(
    "redrawn",
    [
        swinging_door,
        lambda values, band: box_car(values, band, hold=False),
        lambda values, band: box_car(values, band, hold=True),
    ],
)
@pytest.mark.parametrize(("column", "role", "noise"), [("F", "flow", 0.2), ("P1", "p1", 1.0)])
def test_band_as_large_as_the_noise(column, role, noise, redrawn, share):
    columns = healthy()
    columns[column] = np.round(redrawn(columns[column], share * noise), 3)
    assert names(screened(columns)) == {("compressed", role)}


def test_few_changes_above_a_wide_band():
    columns = healthy()
    columns["P1"] = box_car(columns["P1"], 8.0, hold=True)
    (found,) = screened(columns)
    assert (found["finding"], found["role"]) == ("compressed", "p1")
    assert "changes of less than 8" in found["detail"]


def test_levels_that_come_back_are_steps_of_the_reading():
    # steps that differ a little, as those of a converter do
    levels = 400.0 + np.cumsum(np.random.default_rng(1).uniform(15.0, 18.0, 60))
    columns = healthy()
    columns["P1"] = np.round(levels[np.abs(columns["P1"][:, None] - levels).argmin(axis=1)], 1)
    assert ("compressed", "p1") not in names(screened(columns))


@pytest.mark.parametrize("rows", [3.0, 10.0, 30.0])
def test_signals_without_noise_are_not_compressed(rows):
    rng = np.random.default_rng(2)
    stem = smooth(np.repeat(rng.uniform(20.0, 80.0, N // 60), 60), rows)
    columns = healthy() | {"CV": np.round(stem, 2), "X": np.round(stem, 2), "F": np.round(0.9 * stem, 3)}
    assert not {each for each in names(screened(columns)) if each[0] == "compressed"}


def test_noise_of_a_few_steps_is_not_compressed():
    rng = np.random.default_rng(3)
    columns = healthy()
    for steps in (0.3, 0.6, 1.0, 2.0, 4.0):
        columns["T"] = np.round(
            40.0 + smooth(rng.normal(0.0, 3.0, N), 100.0) + rng.normal(0.0, 0.1 * steps, N), 1
        )
        assert ("compressed", "temperature") not in names(screened(columns))


def test_one_long_standstill_makes_no_grid():
    columns = healthy()
    columns["F"][1000:2000] = columns["F"][1000]
    assert names(screened(columns)) == {("frozen", "flow")}


@pytest.mark.parametrize("shift", [6, -6])
@pytest.mark.parametrize(("column", "role"), [("P1", "p1"), ("P2", "p2")])
def test_clock_of_a_pressure(column, role, shift):
    columns = healthy()
    columns[column] = np.roll(columns[column], shift)
    (found,) = screened({name: values[10:-10] for name, values in columns.items()})
    assert (found["finding"], found["role"]) == ("clock_shift", role)
    assert abs(found["size"] - shift) <= 2.0


def test_pressure_that_lags_a_little_is_no_clock():
    columns = healthy()
    columns["P1"] = np.round(smooth(columns["P1"], 2.0), 1)
    assert names(screened(columns)) == set()


@pytest.mark.parametrize(("span", "bits", "digits"), [(104.0, 12, 4), (104.0, 12, 3), (80.0, 10, 2)])
def test_steps_of_a_converter_written_with_more_digits_are_no_lines(span, bits, digits):
    # bends of a moving stem are whole steps, and some are none
    columns = healthy()
    step = span / 2**bits
    stem = smooth(columns["CV"], 20.0) + np.random.default_rng(4).normal(0.0, 1.2 * step, N)
    columns["X"] = np.round(np.round(stem / step) * step, digits)
    assert ("compressed", "opening") not in names(screened(columns))


def test_dead_band_is_told():
    columns = healthy()
    columns["X"] = np.round(box_car(columns["X"], 0.3, hold=True), 2)
    (found,) = screened(columns)
    assert (found["finding"], found["role"]) == ("compressed", "opening")
    assert found["size"] == pytest.approx(0.003, rel=0.1)
