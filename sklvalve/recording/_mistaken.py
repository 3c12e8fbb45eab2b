# SPDX-License-Identifier: BSD-3-Clause
"""Signals that are evidently not what the valve.toml calls them: a diagnosis would take them for physics.

The screening speaks of suspicion and goes on; here the evidence must leave no other reading.
"""

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_meaning import against_command, fractions_as_percent
from sklvalve.recording._screen_tools import boiling_point
from sklvalve.recording._tell import column_of, written
from sklvalve.recording.errors import InputError
from sklvalve.recording.recording import Recording

# magnitudes in SI that no plant reaches
_LARGEST = {"pressure": 1e11, "volume flow": 1e7, "mass flow": 1e10, "temperature": 1e5, "fraction": 1e3}
_LEAST_FLOW = 1e-15  # m3/s or kg/s
_LIQUID_WATER = (243.15, 647.1)  # K; with room for a sensor's error below freezing, none above critical
_ABOVE_BOILING = 15.0  # K
_FORMULAS = ("density", "vapour_pressure")
_LONGEST_DELAY = 120.0  # s; the longest dead time that the catalogue knows


def require_likely_signals(recording: Recording) -> None:
    """Refuse signals in another unit or of the other sense, where nothing else can be meant.

    Raises
    ------
    InputError
        Naming the column, and what to write instead.
    """
    require_magnitudes(recording)
    _require_any_flow(recording)
    for role, low, high in fractions_as_percent(recording):
        raise InputError(
            f"{column_of(recording, role)} runs from {low:g} to {high:g} in unit '%', by which the valve "
            f'would hardly move; write unit = "1" in [recording.{role}], or give rows in which it moves'
        )
    _require_sense(recording)
    _require_direction(recording)
    require_liquid_water(recording)


def require_magnitudes(recording: Recording) -> None:
    """Refuse numbers that no plant reaches, whatever they are wanted for.

    Raises
    ------
    InputError
        Naming the column and the row.
    """
    for role, values in recording.signals.items():
        limit = _LARGEST.get(recording.signal(role).quantity, np.inf)
        beyond = np.flatnonzero(np.abs(values) > limit)
        if len(beyond):
            row = int(beyond[0])
            raise InputError(
                f"{column_of(recording, role)}, row {row + 1}: {written(recording, role, values[row])} is "
                "far beyond any plant; correct the value or the unit, or leave the cell empty"
            )


def _require_any_flow(recording: Recording) -> None:
    flow = recording.get("flow")
    if flow is not None and not (np.abs(flow) > _LEAST_FLOW).any():
        raise InputError(
            f"{column_of(recording, 'flow')} never shows any flow; name the column of the flow, correct its "
            "unit, or leave the role out"
        )


def _require_sense(recording: Recording) -> None:
    against = against_command(recording)
    if against is None or _best_when_late(recording) > -against:
        return
    raise InputError(
        f"{column_of(recording, 'opening')} falls where the command rises (correlation {against:.2f}); write "
        'sense = "closing" in [recording.opening], or in [recording.command] if it is the larger command '
        "that shuts the valve"
    )


def _best_when_late(recording: Recording) -> float:
    """Largest correlation with the command of before: half a period late, an opening seems to oppose it."""
    command, opening = recording["command"], recording["opening"]
    longest = min(int(_LONGEST_DELAY / recording.sample_time) + 2, len(command) // 4)
    return max(_correlation(command[:-late], opening[late:]) for late in range(1, longest + 1))


def _correlation(one: NDArray, other: NDArray) -> float:
    both = np.isfinite(one) & np.isfinite(other)
    one, other = one[both], other[both]
    if len(one) < 10 or not np.ptp(one) > 0.0 or not np.ptp(other) > 0.0:
        return 0.0
    return float(np.corrcoef(one, other)[0, 1])


def _require_direction(recording: Recording) -> None:
    """A flow that runs against the pressure drop in nearly every row."""
    if "flow" not in recording:
        return
    flow = recording["flow"]
    rows = np.isfinite(flow)
    beside = ""
    if {"p1", "p2"} <= set(recording.signals):
        rows &= recording["p1"] > recording["p2"]
        beside = " although p1 lies above p2"
    if rows.sum() < 10:
        return
    share = float((flow[rows] < 0.0).mean())
    if share > 0.95:
        raise InputError(
            f"{column_of(recording, 'flow')} is negative in {100.0 * share:.0f} % of the rows{beside}; "
            "give the flow through the valve as positive numbers, or correct the zero of the meter"
        )


def require_liquid_water(recording: Recording) -> None:
    """Refuse water that is no liquid at its temperature, or not under its pressure.

    Raises
    ------
    InputError
        Naming the column, and what it contradicts.
    """
    fluid = recording.valve.fluid
    by_formula = fluid.get("name", "water") == "water" and any(key not in fluid for key in _FORMULAS)
    if "temperature" not in recording or not by_formula:
        return
    low, high = _LIQUID_WATER
    middle = float(np.nanmedian(recording["temperature"]))
    where = "where water is no liquid; correct"
    # a little above boiling may be the error of a sensor, or condensate
    for pressure, what in _pressures_above_boiling(recording):
        boiling = boiling_point(pressure)
        if low <= middle <= high and middle > boiling + _ABOVE_BOILING:
            high = boiling
            where = f"where water boils, for {what} is {pressure / 1e3:.4g} kPa, absolute; correct that,"
    if not low <= middle <= high:
        unit = recording.unit("temperature")
        raise InputError(
            f"{column_of(recording, 'temperature')} lies around {written(recording, 'temperature', middle)}, "
            f"{where} the unit ({unit!r}) or the column, or give density and "
            "vapour_pressure of the liquid in [fluid]"
        )


def _pressures_above_boiling(recording: Recording) -> list[tuple[float, str]]:
    """Pressures [Pa] under which the fluid must be liquid, and what they are called."""
    pressures: list[tuple[float, str]] = []
    if "vapour_pressure" in recording.valve.fluid:
        return pressures
    if "p1" in recording:
        pressures.append((float(np.nanmedian(recording["p1"])), "p1 in the middle"))
    critical = recording.valve.fluid.get("critical_pressure")
    if isinstance(critical, float):
        pressures.append((critical, "[fluid] critical_pressure"))
    return pressures
