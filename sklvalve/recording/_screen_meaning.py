# SPDX-License-Identifier: BSD-3-Clause
"""Screens of what the numbers mean: pressures swapped, units or senses that cannot be right."""

import numpy as np

from sklvalve.recording._screen_capacity import screen_capacity
from sklvalve.recording._screen_tools import Finding, boiling_point, finding, measured
from sklvalve.recording.recording import Recording
from sklvalve.recording.runs import runs
from sklvalve.recording.signal import OPENING_ROLES

_MOST_BAR = 400.0


def screen_swapped(recording: Recording) -> list[Finding]:
    """Outlet pressure above inlet pressure in a good part of the rows."""
    if not {"p1", "p2"} <= set(recording.signals):
        return []
    drop = recording["p1"] - recording["p2"]
    against = drop < 0.0
    share = against.sum() / max(1, np.isfinite(drop).sum())
    if share < 0.2:
        return []
    detail = (
        f"p2 lies above p1 in {100.0 * share:.0f} % of the rows: swapped, one of them gauge, or a zero off"
    )
    return [finding("swapped", "p2", detail, runs(against))]


def screen_units(recording: Recording) -> list[Finding]:
    """Values that are possible, but hardly in the unit or sense that the valve.toml gives."""
    return [
        *_percent(recording),
        *_sense(recording),
        *_temperature(recording),
        *_vacuum(recording),
        *_beyond_bar(recording),
        *screen_capacity(recording),
    ]


def fractions_as_percent(recording: Recording) -> list[tuple[str, float, float]]:
    """Openings that never leave 0 to 1 in their unit '%': role, lowest and highest value."""
    found = []
    for role in OPENING_ROLES:
        if role not in recording or role in recording.constants or recording.unit(role) != "%":
            continue
        written = recording.in_recorded_units(role, recording[role])
        low, high = np.nanmin(written), np.nanmax(written)
        if low >= -0.01 and high <= 1.0 and high - low > 0.05:
            found.append((role, float(low), float(high)))
    return found


def _percent(recording: Recording) -> list[Finding]:
    return [
        finding("unit_suspect", role, f"runs from {low:g} to {high:g} in unit '%': is its unit '1'?")
        for role, low, high in fractions_as_percent(recording)
    ]


def against_command(recording: Recording) -> float | None:
    """Correlation of opening and command where it is strongly negative, else None."""
    if not {"command", "opening"} <= set(recording.signals) or {"command", "opening"} & recording.constants:
        return None
    command, opening = recording["command"], recording["opening"]
    both = np.isfinite(command) & np.isfinite(opening)
    if both.sum() < 10 or np.ptp(command[both]) < 0.05 or np.ptp(opening[both]) < 0.05:
        return None
    alike = float(np.corrcoef(command[both], opening[both])[0, 1])
    return alike if alike <= -0.7 else None


def _sense(recording: Recording) -> list[Finding]:
    alike = against_command(recording)
    if alike is None:
        return []
    detail = f"moves against the command (correlation {alike:.2f}): is the sense of one of them 'closing'?"
    return [finding("unit_suspect", "opening", detail)]


def _temperature(recording: Recording) -> list[Finding]:
    if "temperature" not in recording:
        return []
    middle = float(np.nanmedian(recording["temperature"]))
    if 150.0 <= middle <= _boiling(recording):
        return []
    written = float(recording.in_recorded_units("temperature", [middle])[0])
    detail = f"around {written:g} {recording.unit('temperature')}, {middle:.0f} K: hardly the right unit"
    return [finding("unit_suspect", "temperature", detail)]


def _boiling(recording: Recording) -> float:
    """Temperature [K] beyond which the fluid is no liquid: for water, 15 K above boiling at p1."""
    water = (
        recording.valve.fluid.get("name", "water") == "water"
        and "vapour_pressure" not in recording.valve.fluid
    )
    if not water or "p1" not in recording:
        return 1100.0
    return min(1100.0, boiling_point(float(np.nanmedian(recording["p1"]))) + 15.0)


def _vacuum(recording: Recording) -> list[Finding]:
    found = []
    for role in (*measured(recording), *sorted(recording.constants)):
        if recording.signal(role).quantity != "pressure":
            continue
        below = recording[role] <= 0.0
        if below.mean() > 0.01 or (role in recording.constants and below.all()):
            detail = f"at or below absolute vacuum in {100.0 * below.mean():.2g} % of the rows: is it gauge?"
            found.append(finding("unit_suspect", role, detail, runs(below)))
    return found


def _beyond_bar(recording: Recording) -> list[Finding]:
    """Pressures in bar that would rather be kPa; a rated capacity tells more surely, also of a wellhead."""
    if recording.valve.kv_rated is not None:
        return []
    found = []
    for role in ("p1", "p2"):
        if role not in recording or recording.unit(role) != "bar":
            continue
        middle = float(np.nanmedian(recording.in_recorded_units(role, recording[role])))
        if middle > _MOST_BAR:
            detail = f"around {middle:.3g} bar, more than {_MOST_BAR:g}: is it kPa? if not, give kv_rated"
            found.append(finding("unit_suspect", role, detail))
    return found
