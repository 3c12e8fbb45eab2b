# SPDX-License-Identifier: BSD-3-Clause
"""Channels exchanged, or read in another unit: which reading makes the flow agree absurdly better."""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_lags import Values, rising_curve
from sklvalve.recording._screen_tools import Finding, boiling_point, equal_runs, finding
from sklvalve.recording.noise import noise_floor
from sklvalve.recording.recording import Recording

_ROLES = ("command", "opening", "p1", "p2", "temperature", "flow")
_ROWS = 4000
_BETTER = 20.0  # times less unexplained variance; no physics that a simulation leaves out gives that
_GOOD = 1e-3  # unexplained share of a reading that is right
_RESCALED = 4.0  # the same for the unit of one pressure
_LIKE_STILL = 10.0  # times the unexplained share: a fit as good as by a pressure that keeps still
_WORST = 4.0  # unexplained share given to readings that no plant can have
_FACTORS = {1e3: "MPa", 1e2: "bar", 6.894757: "psi"}  # kPa per unit


def screen_readings(recording: Recording) -> list[Finding]:
    """Two columns exchanged, or the outlet pressure in another unit, where that mends what does not fit.

    Each reading is judged by the share of the flow that a rising curve of the opening times sqrt(p1 - p2)
    leaves open, and the share of the opening that the command leaves open.
    """
    roles = [role for role in _ROLES if role in recording and role not in recording.constants]
    if not {"flow", "opening"} <= set(roles) or len(recording) < 300:
        return []
    rows = _steady_rows({role: recording[role] for role in roles})
    if len(rows) < 200:
        return []
    rows = rows[np.linspace(0, len(rows) - 1, min(_ROWS, len(rows))).astype(int)]
    signals = {role: recording[role][rows] for role in recording.signals}
    known = np.all([np.isfinite(signals[role]) for role in roles], axis=0)
    if known.sum() < 200:
        return []
    signals = {role: values[known] for role, values in signals.items()}
    written = {role: recording.in_recorded_units(role, signals[role]) for role in roles}
    water = recording.valve.fluid.get("name", "water") == "water"
    if _reversed(signals):
        return []  # pressures exchanged, or against each other: said already
    # a temperature that no liquid has is another screen's
    now = _open_share({role: signals[role] for role in signals if role != "temperature"}, water)
    best, told = min(now / _BETTER, _GOOD), []
    rescaled, mended = now / _RESCALED, []
    for first, second in combinations(roles, 2):
        if {first, second} == {"command", "opening"}:  # told by their order in time
            continue
        to_first, to_second = recording.signal(first).to_si, recording.signal(second).to_si
        other = signals | {first: to_first(written[second]), second: to_second(written[first])}
        share = _open_share(other, water)
        if share < best and not _only_seems(signals, {first, second}, noise_floor(recording["flow"]), share):
            detail = f"{second} and {first} fit {_times(now, share)} better if their columns change places"
            best, told = share, [finding("swapped", second, detail)]
    # an inlet pressure made larger, or an outlet pressure made smaller, would only imitate choking
    for factor, unit in _FACTORS.items() if "p2" in roles else ():
        share = _open_share(signals | {"p2": signals["p2"] * factor}, water)
        if not told and share < rescaled:
            detail = f"fits {_times(now, share)} better if its numbers are {factor:g} times larger"
            rescaled, mended = share, [finding("unit_suspect", "p2", f"{detail} ({unit} read as kPa?)")]
    return told or mended


def _only_seems(signals: dict[str, Values], pair: set[str], noise: float, share: float) -> bool:
    """Whether a pair fits better exchanged though nothing says that it is.

    A flow that as written agrees to its noise, as where a short recording hardly moves it, needs no other
    column; and where the valve chokes, anything that keeps still fits better than its outlet pressure.
    """
    if not {"p1", "p2"} <= set(signals):
        return False
    if "flow" in pair:
        return _left(signals) < 3.0 * noise
    still = signals | {"p2": np.full_like(signals["p2"], np.median(signals["p2"]))}
    return pair == {"p2", "temperature"} and _open_share(still, False) < _LIKE_STILL * share


def _left(signals: dict[str, Values]) -> float:
    """Standard deviation of the flow about the best rising curve of the opening."""
    root = np.sqrt(np.maximum(signals["p1"] - signals["p2"], 1.0))
    return float(np.std(signals["flow"] - root * rising_curve(signals["opening"], signals["flow"] / root)))


def _steady_rows(signals: dict[str, Values]) -> NDArray[np.intp]:
    """Rows about which nothing moves far, so that lags do not matter, and where no sensor stands still."""
    keep = np.ones(len(signals["flow"]), dtype=bool)
    for role, values in signals.items():
        if role != "command":
            for start, stop in equal_runs(values):
                keep[start:stop] &= stop - start < 20
        move = np.abs(values[8:] - values[:-8])
        far = 0.02 * np.nanquantile(np.abs(values - np.nanmedian(values)), 0.95) + 4.0 * noise_floor(values)
        keep[4:-4] &= ~(move > far)
    return np.flatnonzero(keep[4:-4]) + 4


def _reversed(signals: dict[str, Values]) -> bool:
    return {"p1", "p2"} <= set(signals) and 0.2 < (signals["p1"] < signals["p2"]).mean() < 0.9


def _times(now: float, then: float) -> str:
    return f"{now / then:.0f} times"


def _open_share(signals: dict[str, Values], water: bool) -> float:
    """Product of the shares of flow and opening that stay unexplained; large for what no plant can be."""
    opening, flow = signals["opening"], signals["flow"]
    share = 1.0
    if "command" in signals and np.ptp(signals["command"]) > 0.0:
        share *= _unexplained(opening, signals["command"])
    for role in ("command", "opening"):
        if role in signals and ((signals[role] < -0.06) | (signals[role] > 1.06)).mean() > 0.02:
            return _WORST
    if "temperature" in signals:
        hottest = (
            boiling_point(float(np.median(signals["p1"]))) + 15.0 if water and "p1" in signals else 1100.0
        )
        if not 230.0 < np.median(signals["temperature"]) < hottest:
            return _WORST
    if not {"p1", "p2"} <= set(signals):
        return share * _unexplained(flow, rising_curve(opening, flow))
    drop = signals["p1"] - signals["p2"]
    if (drop < 0.0).mean() > 0.02 or min(np.median(signals["p1"]), np.median(signals["p2"])) < 0.0:
        return _WORST
    root = np.sqrt(np.maximum(drop, 1e-3 * max(float(np.median(drop)), 1e-9)))
    return share * _unexplained(flow, root * rising_curve(opening, flow / root))


def _unexplained(values: Values, by: Values) -> float:
    """Share of the variance left, with a floor: below a thousandth nothing is told apart."""
    spread = float(np.var(values))
    return min(1.0, float(np.var(values - by)) / spread) + 1e-3 if spread > 0.0 else 1.0
