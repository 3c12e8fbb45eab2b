# SPDX-License-Identifier: BSD-3-Clause
"""Flow that the sheet's trim cannot pass: a unit that is not what the valve.toml says."""

import numpy as np

from sklvalve.recording._screen_lags import Values
from sklvalve.recording._screen_tools import Finding, finding
from sklvalve.recording.recording import Recording
from sklvalve.recording.valve import Valve

_WATER = 1000.0  # kg/m3; the order of magnitude is all that is asked of it
_CHECK = "check the units of flow and pressures, and kv_rated"
# a factor that no wear, play or choking gives; over little travel a wrong trim may give more
_WIDE, _LOW, _HIGH = 1.9, 2.3, 3.0


def screen_capacity(recording: Recording) -> list[Finding]:
    """Flow far beyond what the rated capacity passes, or far from what the sheet's trim passes (liquids)."""
    used = used_capacity(recording)
    if used is None:
        return []
    most = float(np.nanquantile(used, 0.99))
    opening = recording.get("opening", recording.get("command"))
    wide = opening is not None and float(np.nanquantile(opening, 0.99)) > 0.8
    if most > 3.0:
        return [finding("unit_suspect", "flow", f"would take {most:.3g} times the rated capacity: {_CHECK}")]
    if wide and most < 0.01:
        detail = (
            f"never takes more than {100.0 * most:.2g} % of the rated capacity, "
            f"although the valve opens wide: {_CHECK}"
        )
        return [finding("unit_suspect", "flow", detail)]
    factor = _factor(recording.valve, opening, used) if opening is not None else None
    if factor is None:
        return []
    detail = f"about {factor:.2g} times what the sheet's trim passes at every opening: {_CHECK}"
    return [finding("unit_suspect", "flow", detail)]


def used_capacity(recording: Recording) -> Values | None:
    """Share of the rated capacity that each row's flow takes, NaN without pressure drop; None for gases."""
    valve = recording.valve
    liquid = valve.fluid.get("name", "water") == "water" or float(valve.fluid.get("density", 0.0)) > 300.0
    if valve.kv_rated is None or not liquid or not {"flow", "p1", "p2"} <= set(recording.signals):
        return None
    density = float(valve.fluid.get("density", _WATER))
    drop = np.maximum(recording["p1"] - recording["p2"], 0.0)
    volume = recording["flow"] / density if recording.mass_flow else recording["flow"]
    with np.errstate(divide="ignore", invalid="ignore"):
        used = 3600.0 * volume / (valve.kv_rated * np.sqrt(drop / 1e5 * _WATER / density))
    used = np.where(drop > 1e3, used, np.nan)
    return used if np.isfinite(used).sum() >= 10 else None


def _factor(valve: Valve, opening: Values, used: Values) -> float | None:
    """Used capacity over the sheet's, where it is far from one alike at all openings; else None."""
    inside = np.isfinite(opening) & np.isfinite(used) & (opening > 0.15) & (opening < 0.95)
    sheet = _trim(valve, opening[inside])
    if sheet is None or inside.sum() < 100:
        return None
    place = (opening[inside] / 0.1).astype(int)
    ratios = np.array(
        [
            np.median(used[inside][place == box] / sheet[place == box])
            for box in np.unique(place)
            if (place == box).sum() >= 20
        ]
    )
    if not len(ratios) or (ratios <= 0.0).any():
        return None
    low, high = float(ratios.min()), float(ratios.max())
    far = (low > _WIDE or high < 1.0 / _WIDE) and high < 1.8 * low
    if len(ratios) < 4:
        far = low > _HIGH or high < 1.0 / _LOW
    return float(np.median(ratios)) if far else None


def _trim(valve: Valve, opening: Values) -> Values | None:
    """Capacity over the rated one as the sheet has it, for the forms that leave no doubt."""
    form = valve.characteristic
    if isinstance(form, str):
        if form == "equal_percentage" and valve.rangeability:
            return valve.rangeability ** (opening - 1.0)
        return opening if form == "linear" else None
    if form is None:
        return None
    table = np.asarray(form, dtype=float)
    return np.maximum(np.interp(opening, table[:, 0], table[:, 1]), 1e-6)
