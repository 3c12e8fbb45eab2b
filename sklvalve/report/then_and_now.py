# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of what changed since a history: then and now, one over the other."""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sklvalve.report import signals
from sklvalve.report.displays.base import legend_above
from sklvalve.report.drawing import COLOURS, INK, pyplot_free_figure, styled, thin, to_svg
from sklvalve.report.figures import Picture
from sklvalve.report.words import role_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

_SIZE = (3.1, 2.9)
_BINS, _FEWEST = 30, 5
_WITHIN_95 = 1.96
# rows of a stretch over which a stem is shown, and share of all travel that it makes there at least
_STRETCH, _LEAST_TRAVEL = 90, 0.04


class Curves(NamedTuple):
    """Mean by bins of a signal.

    Parameters
    ----------
    at : ndarray of shape (m,)
    then, now : ndarray of shape (m,)
    half : ndarray of shape (m,)
        Half the width of the band around `then` in which the signal is expected with 95 %.
    """

    at: Array
    then: Array
    now: Array
    half: Array


def then_and_now_figures(d: dict, traces: dict) -> list[Picture]:
    """Installed characteristic, stem response and residuals by opening: those that the recording tells.

    Parameters
    ----------
    d : dict
        A diagnosis with ``since_history``.
    traces : dict
        As `as_shown` gives them; pictures need ``then``.
    """
    if not traces.get("then"):
        return []
    rows = _rows_since(d, traces)
    if not traces.get("then_scatter"):
        traces = traces | {"then_scatter": {r: np.zeros(len(v)) for r, v in traces["then"].items()}}
    # then in the place of the simulation before, now in that of the one after
    both = traces | {"nominal": traces["then"], "corrected": traces["corrected"] or traces["nominal"]}
    made = (_characteristic(both, rows), _stem(both, rows), _residuals(d, both, rows))
    return [picture for picture in made if picture is not None]


def _rows_since(d: dict, traces: dict) -> NDArray[np.bool_]:
    """Rows from the onset on; all where it was there from the start, or nothing was found."""
    time, onset = np.asarray(traces["time"], dtype=float), (d.get("location") or {}).get("onset")
    since = time - time[0] >= (onset or 0.0)
    return since if since.sum() >= _STRETCH else np.ones(len(time), dtype=bool)


def by_bins(x: Array, then: Array, now: Array, scatter: Array) -> Curves | None:
    """Means of signals by bins of another; None where no bin holds enough rows.

    Parameters
    ----------
    x, then, now : ndarray of shape (n,)
    scatter : ndarray of shape (n,)
        Standard deviation of `then`: that of a calibration, so that rows of a bin err alike.
    """
    good = np.isfinite(x) & np.isfinite(then) & np.isfinite(now) & np.isfinite(scatter)
    if good.sum() < _FEWEST:
        return None
    low, high = np.quantile(x[good], [0.001, 0.999]).tolist()
    if high <= low:
        return None
    edges = np.linspace(low, high, _BINS + 1)
    bins = np.clip(np.digitize(x[good], edges) - 1, 0, _BINS - 1)
    many = np.bincount(bins, minlength=_BINS)
    held = many >= _FEWEST
    if not held.any():
        return None
    several = (x, then, now, _WITHIN_95 * scatter)
    return Curves(*(np.bincount(bins, values[good], _BINS)[held] / many[held] for values in several))


def stretch(both: dict, rows: NDArray[np.bool_]) -> slice | None:
    """Where then and now lie furthest apart for the travel of the stem, of stretches in which it moves.

    Over much travel a response shows no difference: what is looked for is the small move that is missed.
    """
    opening = both["recorded"].get("opening")
    if opening is None or any(both[model].get("opening") is None for model in signals.MODELS):
        return None
    shown = np.flatnonzero(rows)
    first, last = int(shown[0]), int(shown[-1]) + 1
    if last - first <= _STRETCH:
        return slice(first, last)
    apart = np.abs(_whole(both, "nominal") - _whole(both, "corrected"))
    best, most = None, -1.0
    recorded = np.asarray(opening, dtype=float)
    least = _LEAST_TRAVEL * _travel(recorded[rows])
    for begin in range(first, last - _STRETCH + 1, _STRETCH // 6):
        part = slice(begin, begin + _STRETCH)
        travel = _travel(recorded[part])
        if travel >= least and np.isfinite(apart[part]).any():
            score = float(np.nanmean(apart[part])) / max(travel, 1e-300)
            best, most = (part, score) if score > most else (best, most)
    return best


def _travel(opening: Array) -> float:
    known = opening[np.isfinite(opening)]
    return float(np.ptp(known)) if len(known) else 0.0


def _characteristic(both: dict, rows: NDArray[np.bool_]) -> Picture | None:
    """Flow against opening at one pressure drop, where that was recorded."""
    signature = signals.capacity_signature(both)
    if signature is None or signature.nominal is None or signature.corrected is None:
        return None
    x = np.where(rows, signature.x, np.nan)
    # linear in the flow, so that its scatter is that of what is drawn
    scatter = signals.capacity_signature(both | {"nominal": both["then_scatter"]})
    if scatter is None or scatter.nominal is None:
        return None
    curves = by_bins(x, signature.nominal, signature.corrected, scatter.nominal)
    if curves is None:
        return None
    place = signature.x_label.split(" [")[0]
    alt = f"Installed characteristic then and now: flow against {place}"
    with styled():
        figure = pyplot_free_figure(*_SIZE)
        ax = figure.subplots()
        shown = thin(int(rows.sum()), 500)
        _cloud(ax, x[rows][shown], signature.recorded[rows][shown])
        _both(ax, curves)
        _labelled(ax, signature.x_label, signature.y_label)
        caption = (
            f"{alt}. Points: recorded. Lines: means by {place} of the simulation. "
            "Band: where then is expected with 95 %, allowances included."
        )
        return Picture(to_svg(figure, "since-characteristic", alt), alt, caption)


def _stem(both: dict, rows: NDArray[np.bool_]) -> Picture | None:
    """Opening over time, recorded and simulated, where then and now differ most."""
    part = stretch(both, rows)
    if part is None:
        return None
    clock = signals.clock(both)
    time = clock.values[part]
    alt = "Stem response then and now: opening over time, recorded and simulated from the command"
    with styled():
        figure = pyplot_free_figure(*_SIZE)
        ax = figure.subplots()
        recorded = np.asarray(both["recorded"]["opening"], dtype=float)[part]
        ax.plot(time, recorded, color=COLOURS["recorded"], linewidth=2.6, alpha=0.45, label="recorded")
        then, now, scatter = (_whole(both, key)[part] for key in ("nominal", "corrected", "then_scatter"))
        _both(ax, Curves(time, then, now, _WITHIN_95 * scatter))
        _labelled(ax, f"time from the first sample [{clock.unit}]", signals.label(both, "opening"))
        caption = "Stem response then and now, where the two lie furthest apart for the travel there."
        return Picture(to_svg(figure, "since-stem", alt), alt, caption)


def _residuals(d: dict, both: dict, rows: NDArray[np.bool_]) -> Picture | None:
    """Mean residual by opening, against what was left over in the history."""
    role, place = _furthest(d["since_history"]), signals.position(both)
    left = None if role is None else [signals.residual(both, role, m) for m in signals.MODELS]
    if role is None or left is None or place is None or left[0] is None or left[1] is None:
        return None
    curves = by_bins(np.where(rows, place[0], np.nan), left[0], left[1], both["then_scatter"][role])
    if curves is None:
        return None
    item = d["since_history"]["residuals"][role]
    alt = f"Mean residual of {role_words(role)} by {place[1].split(' [')[0]}, then and now"
    with styled():
        figure = pyplot_free_figure(*_SIZE)
        ax = figure.subplots()
        ax.axhline(0.0, color=INK, linewidth=0.6)
        _both(ax, curves, around=np.zeros(len(curves.at)))
        _labelled(ax, place[1], f"recorded minus simulated [{item['unit']}]")
        caption = f"{alt}. Band: where then is expected with 95 %, allowances included."
        return Picture(to_svg(figure, "since-residual", alt), alt, caption)


def _furthest(since: dict) -> str | None:
    """The channel whose residual grew most beside what it was in the history."""
    grown = {
        role: item["by_then"] / max(item["history"], 1e-300)
        for role, item in (since.get("residuals") or {}).items()
        if item.get("by_then") is not None and item.get("history")
    }
    return max(grown, key=grown.__getitem__, default=None)


def _both(ax: "Axes", curves: Curves, around: Array | None = None) -> None:
    middle = curves.then if around is None else around
    ax.fill_between(
        curves.at,
        middle - curves.half,
        middle + curves.half,
        color=COLOURS["nominal"],
        alpha=0.2,
        linewidth=0.0,
        label="expected, 95 %",
    )
    # told apart by width and dashes as well: colours alone do not reach everyone
    ax.plot(curves.at, curves.then, color=COLOURS["nominal"], linewidth=2.2, label="then")
    ax.plot(curves.at, curves.now, color=COLOURS["corrected"], linewidth=1.4, linestyle="--", label="now")


def _cloud(ax: "Axes", x: Array, y: Array) -> None:
    ax.plot(
        x,
        y,
        linestyle="none",
        marker="o",
        markersize=2.4,
        markeredgewidth=0.0,
        color=COLOURS["recorded"],
        alpha=0.4,
        label="recorded",
    )


def _labelled(ax: "Axes", x: str, y: str) -> None:
    ax.set_xlabel(x)
    ax.set_ylabel(y)
    legend_above(ax, columns=2, columnspacing=1.2)


def _whole(both: dict, key: str) -> Array:
    return np.asarray(both[key]["opening"], dtype=float)
