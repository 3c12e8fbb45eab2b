# SPDX-License-Identifier: BSD-3-Clause
"""What the values themselves tell: percent or fraction, sense of closing, unit of a pressure, gauge."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.draft.columns import Column
from sklvalve.recording.tags import is_documented
from sklvalve.recording.units import quantity_of, to_si

# a correlation of ranks this strong leaves no doubt of the sense
_CLEAR = 0.7
_FEWEST = 20
# a fraction of travel, overrange and all; above the second, numbers are percent beyond doubt
_LARGEST_FRACTION, _DOUBTLESS = 1.1, 12.0
# medians between which numbers without a unit are taken for one
_KPA, _PA = 60.0, 2e4


class Told(NamedTuple):
    """What a value of the sheet is, why, and whether the data leave no doubt; None where they do not tell."""

    value: str | None
    why: str
    sure: bool = True


def fraction_unit(column: Column) -> Told:
    """Percent or fraction, or a length as its name says."""
    held = column.values[np.isfinite(column.values)]
    low, high = float(held.min()), float(held.max())
    span = f"values from {low:.4g} to {high:.4g}"
    named = column.unit.unit if column.unit else None
    if named in ("mm", "m"):
        return Told(named, "in the name")
    if named not in (None, "%", "1"):
        return Told(
            None, f"it is in {named}, by its name: a signal of what, or which share of travel?", False
        )
    if low < -30.0 or high > 130.0:
        return Told(None, f"{span} are neither percent nor a fraction: a raw count, another signal?", False)
    if high > _DOUBTLESS or (high > _LARGEST_FRACTION and named == "%"):
        return Told("%", f"{'in the name, and ' if named == '%' else ''}{span}")
    if high > _LARGEST_FRACTION:
        return Told("%", f"{span} are no fraction of travel: percent, or a voltage or current?", False)
    if high - low > 0.05 or named == "1":
        contrary = ", although the name says percent" if named == "%" else ""
        return Told("1", f"{span}{contrary}", named != "%")
    return Told(named or "1", f"{span} hardly move: percent, or a fraction?", False)


def sense(column: Column, rising_with: NDArray[np.float64], what: str) -> Told:
    """Whether larger numbers are further open, by what must rise with the opening."""
    if is_documented(column.name):
        return Told("closing", "so documented for the benchmark")
    alike = rank_correlation(column.values, rising_with)
    if alike is None or abs(alike) < _CLEAR:
        weak = "nothing moves enough with it" if alike is None else f"correlation {alike:.2f} with {what}"
        return Told(None, f"{weak} does not tell", False)
    return Told("opening" if alike > 0.0 else "closing", f"correlation {alike:.2f} with {what}")


def rank_correlation(one: NDArray[np.float64], other: NDArray[np.float64]) -> float | None:
    """Correlation of ranks over the rows that hold both; None where one of them does not move."""
    both = np.isfinite(one) & np.isfinite(other)
    if both.sum() < _FEWEST or not np.ptp(one[both]) > 0.0 or not np.ptp(other[both]) > 0.0:
        return None
    return float(np.corrcoef(_ranks(one[both]), _ranks(other[both]))[0, 1])


def _ranks(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ranks of values, the middle one of all places for those that are equal."""
    _, place, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - 0.5 * (count - 1.0))[place]


def freed_flow(flow: Column, p1: Column | None, p2: Column | None) -> NDArray[np.float64]:
    """Flow divided by the root of the pressure drop, where both pressures are there in one unit."""
    if p1 is None or p2 is None:
        return flow.values
    drop = p1.values - p2.values
    with np.errstate(invalid="ignore", divide="ignore"):
        freed = flow.values / np.sqrt(np.where(drop > 0.0, drop, np.nan))
    return freed if np.isfinite(freed).mean() > 0.5 else flow.values


def pressure_unit(column: Column, largest: float, other: Column | None) -> Told:
    """Unit of a pressure: named, as the other pressure's, or by the size of the numbers."""
    named = _named_unit(column, "pressure")
    if named is not None:
        return Told(named, "in the name")
    if column.unit is not None:
        return Told(None, f"it is in {column.unit.unit}, by its name: which pressure is that?", False)
    beside = None if other is None else _named_unit(other, "pressure")
    if other is not None and beside is not None:
        return Told(beside, f"as that of {other.name!r}: is it?", False)
    guess = "Pa" if largest >= _PA else "kPa" if largest >= _KPA else "bar"
    return Told(guess, f"no unit in the name; guessed from numbers around {largest:.4g}: correct it", False)


def gauge(column: Column, unit: str) -> Told:
    """Whether a pressure is above the atmosphere: as named, or because it could not lie so low else."""
    if column.unit is not None and column.unit.gauge is not None:
        return Told("true" if column.unit.gauge else "false", "in the name")
    middle = float(np.nanmedian(column.values))
    if to_si(middle, unit, "pressure") < 2e3:
        return Told("true", f"around {middle:.4g} {unit} it would be a vacuum if it were absolute")
    return Told(None, "", False)


def temperature_unit(column: Column) -> Told:
    """Unit of a temperature: named, or by the size of the numbers."""
    named = _named_unit(column, "temperature")
    if named is not None:
        return Told(named, "in the name")
    if column.unit is not None:
        return Told(None, f"it is in {column.unit.unit}, by its name: which temperature is that?", False)
    middle = float(np.nanmedian(column.values))
    guess = "K" if 273.15 <= middle <= 400.0 else "degC"
    return Told(guess, f"no unit in the name; guessed from numbers around {middle:.4g}: correct it", False)


def _named_unit(column: Column, quantity: str) -> str | None:
    """Unit in the name of a column, where it is one of this quantity."""
    unit = column.unit.unit if column.unit is not None else None
    return unit if unit is not None and quantity_of(unit) == quantity else None
