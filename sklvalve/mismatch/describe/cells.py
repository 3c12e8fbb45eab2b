# SPDX-License-Identifier: BSD-3-Clause
"""Cells of the operating range: rows by opening, pressure ratio, temperature, rate and direction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.simulation.stages import first_order_lag

if TYPE_CHECKING:
    from sklvalve.simulation.chain import Chain

# bins by rows and by width together: what acts on few rows near a seat has bins of its own
_FINE, _ROUGH = 12, 6
_FEWEST_ROWS = 25
_LEAST_SHARE = 0.004
_SLIVER = 0.1
# a signal that moves by less, relative to its size, says nothing of where
_STANDS_STILL = 1e-3
# travel [1] after which a stem has turned, and how long its rate remembers [s]
_TURNED = 0.004
_REMEMBERS = 8.0


@dataclass(frozen=True, eq=False)
class Cells:
    """One partition of the rows.

    Attributes
    ----------
    signals : tuple of str
        One, or two for boxes; ``("opening", "direction")`` where each direction of travel has its own cells.
    edges : tuple of ndarray
        Edges of the bins of each signal, in SI; of a direction -1, 0, 1.
    cell : ndarray of int, shape (n,)
        Number of each row's cell; -1 where a signal is a gap.
    at : ndarray of int, shape (n_cells, n_signals)
        Bins of each cell that has rows enough, in the order of the signals.
    """

    signals: tuple[str, ...]
    edges: tuple[np.ndarray, ...]
    cell: np.ndarray
    at: np.ndarray

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.at)


def cells_of(chain: Chain, values: dict[str, float], channel: str, simulated: np.ndarray) -> list[Cells]:
    """Partitions of the rows in which a residual of one channel may stand out.

    Parameters
    ----------
    chain : Chain
    values : dict
        Values of the simulation's parameters.
    channel : {"opening", "flow"}
        Whose residual is looked at.
    simulated : ndarray of shape (n,)
        The channel, simulated. Its own residual is sorted by what was simulated: sorted by what was recorded,
        the noise of a row would choose its cell.

    Returns
    -------
    partitions : list of Cells
    """
    return cells_of_signals(signals_of(chain, values, channel, simulated), channel)


def cells_of_signals(signals: dict[str, np.ndarray], channel: str) -> list[Cells]:
    """Partitions by each signal, by opening and direction, and for a flow by opening and pressure together.

    Parameters
    ----------
    signals : dict
        Name -> ndarray of shape (n,), in SI.
    channel : {"opening", "flow"}

    Returns
    -------
    partitions : list of Cells
    """
    partitions = []
    for name, signal in signals.items():
        edges = _edges(signal, _FINE)
        if len(edges) > 2:
            partitions.append(_partition((name,), (signal,), (edges,)))
    if "opening" in signals:
        partitions += _by_direction(signals["opening"])
        if channel == "flow":
            partitions += _by_pressure(signals)
    return [cells for cells in partitions if cells.count > 1]


def _by_direction(opening: np.ndarray) -> list[Cells]:
    """The partition by opening and direction; none where the stem does not travel both ways."""
    way = direction_of_travel(opening)
    edges = _edges(opening, _ROUGH)
    if len(edges) <= 2 or not np.any(way > 0) or not np.any(way < 0):
        return []
    ways = np.array([-1.0, 0.0, 1.0])
    return [_partition(("opening", "direction"), (opening, way), (edges, ways))]


def _by_pressure(signals: dict[str, np.ndarray]) -> list[Cells]:
    """The partition by opening and pressure together; none where no pressure is known."""
    beside = next((s for s in ("pressure_ratio", "dp") if s in signals), None)
    if beside is None:
        return []
    edges = tuple(_edges(signals[s], _ROUGH, by_width=False) for s in ("opening", beside))
    if min(map(len, edges)) <= 2:
        return []
    return [_partition(("opening", beside), (signals["opening"], signals[beside]), edges)]


def signals_of(
    chain: Chain, values: dict[str, float], channel: str, simulated: np.ndarray
) -> dict[str, np.ndarray]:
    """Signals by which a channel's residual is sorted, by name, in SI, without those that stand still."""
    # beside a flow that the user simulated the command stands for an opening that was not recorded
    external = "simulated_flow" in chain.recording
    signals: dict[str, np.ndarray] = {}
    if channel == "opening":
        signals["opening"] = simulated
    elif chain.measured is not None or chain.command is not None:
        driven = chain.measured is not None or external
        signals["opening"] = chain.drive(values) if driven else chain.opening(values)
    if channel == "flow":
        if chain.pressure_ratio is not None:
            signals["pressure_ratio"] = chain.pressure_ratio
        elif chain.has_pressures:
            signals["dp"] = chain.dp
        signals["flow"] = simulated
    if "temperature" in chain.recording:
        signals["temperature"] = chain.recording["temperature"]
    if "opening" in signals:
        signals["rate"] = rate_of_travel(signals["opening"], chain.time)
    return {name: signal for name, signal in signals.items() if _moves(signal)}


def rate_of_travel(opening: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Rate of travel [1/s], a mean that forgets within some seconds: errors of a response go with that."""
    known = np.isfinite(opening)
    if not known.any():
        return np.full(len(opening), np.nan)
    usual = float(np.median(np.diff(time)))
    step = np.diff(time, prepend=time[0] - usual)
    forgets = max(_REMEMBERS, 3.0 * usual)
    filled = np.interp(time, time[known], opening[known])
    behind = first_order_lag(filled, step, forgets, 0.0)
    return np.where(known, (filled - behind) / forgets, np.nan)


def direction_of_travel(opening: np.ndarray) -> np.ndarray:
    """Way of the last travel that was no noise: 0.5 opening, -0.5 closing; NaN before the first."""
    way, last = np.full(len(opening), np.nan), np.nan
    high, low = -np.inf, np.inf
    for k, x in enumerate(opening.tolist()):
        # a gap compares with nothing: the way goes on
        if last != -0.5 and x > high:
            high = x
        if last != 0.5 and x < low:
            low = x
        if last != 0.5 and x > low + _TURNED:
            last, high = 0.5, x
        elif last != -0.5 and x < high - _TURNED:
            last, low = -0.5, x
        way[k] = last
    return way


def _moves(signal: np.ndarray) -> bool:
    known = signal[np.isfinite(signal)]
    if len(known) < 2 * _FEWEST_ROWS:
        return False
    low, high = np.quantile(known, [0.01, 0.99])
    return high - low > _STANDS_STILL * max(abs(low), abs(high))


def _edges(signal: np.ndarray, many: int, *, by_width: bool = True) -> np.ndarray:
    """Edges of bins by rows, and by width where wished, with rows enough in each."""
    known = np.sort(signal[np.isfinite(signal)])
    fewest = max(_FEWEST_ROWS, _LEAST_SHARE * len(known))
    share = np.linspace(0.0, 1.0, many + 1)
    low, high = known[0], known[-1]
    wanted = np.quantile(known, share)
    if by_width:
        wanted = np.unique(np.concatenate([wanted, low + share * (high - low)]))
    # many rows at one value make no bin beside it
    sliver = _SLIVER * (high - low) / many
    kept, below = [low], 0
    for edge in wanted[1:-1]:
        until = int(np.searchsorted(known, edge))
        if edge - kept[-1] < sliver:
            continue
        if until - below >= fewest and len(known) - until >= fewest:
            kept.append(edge)
            below = until
    return np.array([*kept, high])


def _partition(
    names: tuple[str, ...], signals: tuple[np.ndarray, ...], edges: tuple[np.ndarray, ...]
) -> Cells:
    """Cells of one or two signals; those with few rows are left out."""
    known = np.all([np.isfinite(s) for s in signals], axis=0)
    shape = tuple(len(e) - 1 for e in edges)
    bins = [
        np.clip(np.searchsorted(e, np.nan_to_num(s), side="right") - 1, 0, many - 1)
        for s, e, many in zip(signals, edges, shape, strict=True)
    ]
    flat = np.where(known, np.ravel_multi_index(bins, shape), -1)
    rows = np.bincount(flat[known], minlength=int(np.prod(shape)))
    kept = np.flatnonzero(rows >= _FEWEST_ROWS)
    number = np.full(len(rows) + 1, -1)
    number[kept] = np.arange(len(kept))
    every = np.array(list(product(*(range(many) for many in shape))))
    return Cells(tuple(names), tuple(edges), number[flat], every[kept])
