# SPDX-License-Identifier: BSD-3-Clause
"""What the figures draw, computed from the traces of a diagnosis."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording.units import quantity_of, to_si

Array = NDArray[np.float64]


class Clock(NamedTuple):
    """Time from the first sample in a unit that suits its length."""

    values: Array
    unit: str


class ResidualMap(NamedTuple):
    """Binned means of the residual over opening and pressure ratio."""

    x: Array
    y: Array
    means: dict[str, Array]
    flagged: NDArray[np.bool_]


def clock(traces: dict) -> Clock:
    """Seconds, hours or days from the first sample; joined recordings stand close behind each other."""
    time = np.asarray(traces["time"], dtype=float)
    time = time - time[0]
    for row in traces.get("begins", [])[1:]:
        time[row:] -= time[row] - time[row - 1] - (time[row - 1] - time[row - 2])
    for unit, seconds, longest in (("s", 1.0, 36_000.0), ("h", 3600.0, 864_000.0)):
        if time[-1] < longest:
            return Clock(time / seconds, unit)
    return Clock(time / 86_400.0, "days")


def time_words(traces: dict) -> str:
    """What the times of `clock` count from."""
    several = len(traces.get("begins", [])) > 1
    return "time, the recordings one behind the other" if several else "time from the first sample"


def residual(traces: dict, role: str, model: str) -> Array | None:
    """Recorded less simulated, in the recording's unit; None where one of the two is missing."""
    recorded, simulated = traces["recorded"].get(role), traces[model].get(role)
    if recorded is None or simulated is None:
        return None
    return np.asarray(recorded, dtype=float) - np.asarray(simulated, dtype=float)


def position(traces: dict) -> tuple[Array, str] | None:
    """Opening as recorded, or the command where there was no position sensor, and what to call it."""
    for role in ("opening", "command"):
        if traces["recorded"].get(role) is not None:
            return np.asarray(traces["recorded"][role], dtype=float), label(traces, role)
    return None


def label(traces: dict, role: str) -> str:
    """Name of a signal with its unit."""
    names = {"p1": "inlet pressure", "p2": "outlet pressure"}
    unit = traces["units"].get(role, "1")
    return f"{names.get(role, role.replace('_', ' '))} [{unit}]"


def pressure_drop(traces: dict) -> Array | None:
    """Pressure drop [kPa] where it is positive, else NaN; None where it was not recorded."""
    if traces.get("dp") is not None:
        drop = np.asarray(traces["dp"], dtype=float) / 1e3
    else:
        drops = []
        for role in ("p1", "p2"):
            values, unit = traces["recorded"].get(role), traces["units"].get(role)
            if values is None or unit is None or quantity_of(unit) != "pressure":
                return None
            drops.append(to_si(values, unit, "pressure") / 1e3)
        drop = drops[0] - drops[1]
    return np.where(drop > 0.0, drop, np.nan)


def residual_map(traces: dict, bins: tuple[int, int] = (24, 14)) -> ResidualMap | None:
    """Mean residual of flow by opening and pressure ratio, before and after; None where signals lack.

    A bin with fewer than three rows is left empty: a single row shows noise only.
    """
    place, ratio = position(traces), traces.get("pressure_ratio")
    before, after = (residual(traces, "flow", model) for model in ("nominal", "corrected"))
    if place is None or ratio is None or before is None or after is None:
        return None
    x, y = place[0], np.asarray(ratio, dtype=float)
    good = np.isfinite(x) & np.isfinite(y) & np.isfinite(before) & np.isfinite(after)
    if good.sum() < 30:
        return None
    edges = [_edges(x[good], bins[0]), _edges(y[good], bins[1])]
    sums = {
        name: np.histogram2d(x[good], y[good], bins=edges, weights=weights[good])[0]
        for name, weights in {
            "nominal": before,
            "corrected": after,
            "flagged": np.asarray(traces["flagged"], dtype=float),
        }.items()
    }
    count = np.histogram2d(x[good], y[good], bins=edges)[0]
    count = np.where(count >= 3, count, np.nan)
    means = {name: sums[name] / count for name in ("nominal", "corrected")}
    return ResidualMap(edges[0], edges[1], means, np.nan_to_num(sums["flagged"] / count) >= 0.5)


def _edges(values: Array, count: int) -> Array:
    low, high = np.quantile(values, [0.001, 0.999])
    if high <= low:
        low, high = low - 0.5, low + 0.5
    return np.linspace(low, high, count + 1)


def outline(shape: ResidualMap) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Borders between flagged bins and others, as line segments."""
    padded = np.pad(shape.flagged, 1)
    segments = []
    for i, j in np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1]):
        segments.append(((shape.x[i], shape.y[j]), (shape.x[i], shape.y[j + 1])))
    for i, j in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1]):
        segments.append(((shape.x[i], shape.y[j]), (shape.x[i + 1], shape.y[j])))
    return segments
