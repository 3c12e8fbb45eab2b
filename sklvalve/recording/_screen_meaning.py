# SPDX-License-Identifier: BSD-3-Clause
"""Screens of what the numbers mean: pressures swapped, units or senses that cannot be right."""

import numpy as np

from sklvalve.recording._screen_tools import Finding, finding, measured, runs
from sklvalve.recording.recording import Recording
from sklvalve.recording.signal import OPENING_ROLES

_WATER = 1000.0  # kg/m3; the order of magnitude is all that is asked of it


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
        *_flow(recording),
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
    if 150.0 <= middle <= 1100.0:
        return []
    written = float(recording.in_recorded_units("temperature", [middle])[0])
    detail = f"around {written:g} {recording.unit('temperature')}, {middle:.0f} K: hardly the right unit"
    return [finding("unit_suspect", "temperature", detail)]


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


def _flow(recording: Recording) -> list[Finding]:
    """Flow far beyond what the rated capacity passes, or far below it with the valve wide open (liquids)."""
    valve = recording.valve
    liquid = valve.fluid.get("name", "water") == "water" or float(valve.fluid.get("density", 0.0)) > 300.0
    if valve.kv_rated is None or not liquid or not {"flow", "p1", "p2"} <= set(recording.signals):
        return []
    density = float(valve.fluid.get("density", _WATER))
    drop = np.maximum(recording["p1"] - recording["p2"], 0.0)
    volume = recording["flow"] / density if recording.mass_flow else recording["flow"]
    with np.errstate(divide="ignore", invalid="ignore"):
        used = 3600.0 * volume / (valve.kv_rated * np.sqrt(drop / 1e5 * _WATER / density))
    used = np.where(drop > 1e3, used, np.nan)
    if np.isfinite(used).sum() < 10:
        return []
    most = float(np.nanquantile(used, 0.99))
    opening = recording.get("opening", recording.get("command"))
    wide = opening is not None and float(np.nanquantile(opening, 0.99)) > 0.8
    check = "check the units of flow and pressures, and kv_rated"
    if most > 3.0:
        detail = f"would take {most:.3g} times the rated capacity: {check}"
    elif wide and most < 0.01:
        detail = (
            f"never takes more than {100.0 * most:.2g} % of the rated capacity, "
            f"although the valve opens wide: {check}"
        )
    else:
        return []
    return [finding("unit_suspect", "flow", detail)]
