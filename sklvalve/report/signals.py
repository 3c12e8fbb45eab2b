# SPDX-License-Identifier: BSD-3-Clause
"""What the figures draw, computed from the traces of a diagnosis."""

from collections.abc import Mapping
from datetime import datetime
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.recording.units import from_si, quantity_of, to_si
from sklvalve.report.words import number, role_words

Array = NDArray[np.float64]

MODELS = ("nominal", "corrected")


class Clock(NamedTuple):
    """Time from the first sample in a unit that suits its length, and the stamp of the first sample."""

    values: Array
    unit: str
    seconds: float = 1.0
    begins: datetime | None = None

    @property
    def stamps(self) -> NDArray[np.datetime64]:
        """Times by the calendar, where the first sample has a stamp."""
        if self.begins is None:
            raise ValueError("this clock counts from the first sample only; it has no calendar")
        since = np.round(1e3 * self.seconds * self.values).astype("timedelta64[ms]")
        return np.datetime64(self.begins.replace(tzinfo=None), "ms") + since


class ResidualMap(NamedTuple):
    """Binned means of residuals over two signals.

    Parameters
    ----------
    x, y : ndarray of shape (n_columns + 1,), (n_rows + 1,)
        Edges of the bins.
    means : dict of ndarray of shape (n_columns, n_rows)
        By model; NaN where a bin holds too few rows.
    flagged : ndarray of bool of shape (n_columns, n_rows)
        Bins of which half the rows or more are flagged.
    """

    x: Array
    y: Array
    means: dict[str, Array]
    flagged: NDArray[np.bool_]


class Signature(NamedTuple):
    """One signal over another, as recorded and as simulated.

    Parameters
    ----------
    x_label, y_label : str
    x : ndarray of shape (n,)
    recorded : ndarray of shape (n,)
    nominal, corrected : ndarray of shape (n,) or None
        Simulated without and with what was found.
    """

    x_label: str
    y_label: str
    x: Array
    recorded: Array
    nominal: Array | None = None
    corrected: Array | None = None


def where_present(traces: dict, location: dict) -> dict:
    """Traces whose rows are flagged only within the times that the page names.

    Parameters
    ----------
    traces : dict
    location : dict
        Its ``intervals`` are those at which what was found is there [s from the first sample].
    """
    intervals = location.get("intervals")
    if not intervals or "time" not in traces:
        return traces
    time = np.asarray(traces["time"], dtype=float)
    begun = time - time[0]
    inside = np.any([(begun >= start) & (begun <= stop) for start, stop in intervals], axis=0)
    return traces | {"flagged": np.asarray(traces["flagged"], dtype=bool) & inside}


def as_shown(traces: dict, location: dict) -> dict:
    """Traces flagged only where present, and without a corrected simulation that corrects nothing.

    Parameters
    ----------
    traces : dict
    location : dict
        Of the same diagnosis.
    """
    traces = where_present(traces, location)
    pairs = [(values, traces["nominal"].get(role)) for role, values in traces.get("corrected", {}).items()]
    idle = all(
        before is not None and np.array_equal(after, before, equal_nan=True) for after, before in pairs
    )
    return traces | {"corrected": {}} if pairs and idle else traces


def clock(traces: dict) -> Clock:
    """Time by the calendar where there is one, else seconds, hours or days from the first sample.

    Joined recordings are drawn close behind each other, where no calendar applies.
    """
    time = np.asarray(traces["time"], dtype=float)
    time = time - time[0]
    several = list(traces.get("begins", []))[1:]
    for row in several:
        time[row:] -= time[row] - time[row - 1] - (time[row - 1] - time[row - 2])
    begins = None if len(several) else _first_stamp(traces)
    for unit, seconds, longest in (("s", 1.0, 36_000.0), ("h", 3600.0, 864_000.0)):
        if time[-1] < longest:
            return Clock(time / seconds, unit, seconds, begins)
    return Clock(time / 86_400.0, "days", 86_400.0, begins)


def _first_stamp(traces: dict) -> datetime | None:
    try:
        return datetime.fromisoformat(traces.get("first_stamp") or "")
    except ValueError:
        return None


def time_words(traces: dict) -> str:
    """What the times of `clock` are."""
    if len(traces.get("begins", [])) > 1:
        return "time, the recordings one after the other"
    return "time from the first sample" if clock(traces).begins is None else "time"


def residual(traces: dict, role: str, model: str) -> Array | None:
    """Recorded minus simulated, in the recording's unit; None where one of the two is missing."""
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
    return f"{role_words(role)} [{traces['units'].get(role, '1')}]"


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


def travel_signature(traces: dict) -> Signature | None:
    """Opening against command; None without a position sensor."""
    command, opening = (traces["recorded"].get(role) for role in ("command", "opening"))
    if command is None or opening is None:
        return None
    simulated = {model: _floats(traces[model].get("opening")) for model in MODELS}
    return Signature(
        label(traces, "command"), label(traces, "opening"), _float(command), _float(opening), **simulated
    )


def capacity_signature(traces: dict) -> Signature | None:
    """Flow against opening, divided by the root of the pressure drop [bar] where that was recorded."""
    place, flow = position(traces), traces["recorded"].get("flow")
    if place is None or flow is None:
        return None
    drop = pressure_drop(traces)
    root = np.ones(len(place[0])) if drop is None else np.sqrt(drop / 100.0)
    simulated = {model: _floats(traces[model].get("flow")) for model in MODELS}
    per_bar = "" if drop is None else f" at a drop of {_one_bar(traces['units'].get('p1'))}"
    return Signature(
        place[1],
        f"flow{per_bar} [{traces['units'].get('flow', '1')}]",
        place[0],
        _float(flow) / root,
        **{model: None if values is None else values / root for model, values in simulated.items()},
    )


def _one_bar(unit: str | None) -> str:
    """A drop of 1 bar in the unit of the recorded pressures."""
    if unit is None or quantity_of(unit) != "pressure":
        return "1 bar"
    zero, one = from_si([0.0, 1e5], unit, "pressure")
    return f"{number(float(one - zero))} {unit}"


def residual_map(traces: dict) -> ResidualMap | None:
    """Mean residual of flow by opening and pressure ratio, before and after; None where signals lack."""
    place, ratio = position(traces), traces.get("pressure_ratio")
    told = {model: left for model in MODELS if (left := residual(traces, "flow", model)) is not None}
    if place is None or ratio is None or "nominal" not in told:
        return None
    return binned(place[0], ratio, told, traces["flagged"])


def binned(
    x: ArrayLike,
    y: ArrayLike,
    residuals: Mapping[str, ArrayLike],
    flagged: ArrayLike | None = None,
    bins: tuple[int, int] = (24, 14),
) -> ResidualMap | None:
    """Mean residuals by two signals; None where fewer than thirty rows are whole.

    A bin with fewer than three rows is left empty: a single row shows noise only.

    Parameters
    ----------
    x, y : array-like of shape (n,)
    residuals : dict of array-like of shape (n,)
        By model.
    flagged : array-like of bool of shape (n,) or None, default=None
    bins : tuple of int, default=(24, 14)
        Along x and y.
    """
    x, y = _float(x), _float(y)
    left = {model: _float(values) for model, values in residuals.items()}
    good = np.isfinite(x) & np.isfinite(y) & np.all([np.isfinite(values) for values in left.values()], axis=0)
    if good.sum() < 30:
        return None
    acts = np.zeros(len(x)) if flagged is None else _float(flagged)
    edges = [_edges(x[good], bins[0]), _edges(y[good], bins[1])]
    sums = {
        name: np.histogram2d(x[good], y[good], bins=edges, weights=weights[good])[0]
        for name, weights in (left | {"flagged": acts}).items()
    }
    count = np.histogram2d(x[good], y[good], bins=edges)[0]
    count = np.where(count >= 3, count, np.nan)
    means = {name: sums[name] / count for name in left}
    return ResidualMap(edges[0], edges[1], means, np.nan_to_num(sums["flagged"] / count) >= 0.5)


def flagged_spans(time: Array, flagged: ArrayLike, buckets: int = 1200) -> list[tuple[float, float]]:
    """Times between which rows are flagged, as fine as a screen shows.

    A bucket with one flagged row counts as a whole: rare events must not vanish from the picture.

    Parameters
    ----------
    time : ndarray of shape (n,)
    flagged : array-like of bool of shape (n,)
    buckets : int, default=1200
    """
    flagged = np.asarray(flagged, dtype=bool)
    if not flagged.any():
        return []
    starts = np.unique(np.linspace(0, len(time), min(buckets, len(time)) + 1).astype(int))[:-1]
    edges = np.append(time[starts], time[-1])
    turns = np.diff(np.maximum.reduceat(flagged, starts).astype(int), prepend=0, append=0)
    begins, ends = edges[np.flatnonzero(turns == 1)], edges[np.flatnonzero(turns == -1)]
    return list(zip(begins.tolist(), ends.tolist(), strict=True))


def _float(values: ArrayLike) -> Array:
    return np.asarray(values, dtype=float)


def _floats(values: ArrayLike | None) -> Array | None:
    return None if values is None else _float(values)


def _edges(values: Array, count: int) -> Array:
    low, high = np.quantile(values, [0.001, 0.999])
    if high <= low:
        low, high = low - 0.5, low + 0.5
    return np.linspace(low, high, count + 1)


def outline(
    x_edges: Array, y_edges: Array, flagged: NDArray[np.bool_]
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Borders between flagged bins and others, as line segments."""
    padded = np.pad(flagged, 1)
    segments = []
    for i, j in np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1]):
        segments.append(((x_edges[i], y_edges[j]), (x_edges[i], y_edges[j + 1])))
    for i, j in np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1]):
        segments.append(((x_edges[i], y_edges[j]), (x_edges[i + 1], y_edges[j])))
    return segments
