# SPDX-License-Identifier: BSD-3-Clause
"""A day-by-day curve as SVG, with its interval, a limit, and marks on days."""

from __future__ import annotations

import datetime as dt
from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import ArrayLike

_WIDTH, _HEIGHT = 640, 190
_LEFT, _RIGHT, _TOP, _BOTTOM = 58, 12, 12, 28


def chart(
    days: Sequence[dt.date],
    values: ArrayLike,
    *,
    label: str,
    deviation: ArrayLike | None = None,
    limit: float | None = None,
    marks: Sequence[tuple[dt.date, str]] = (),
    unit: str = "",
) -> str:
    """Draw a curve over days.

    Parameters
    ----------
    days : sequence of date
    values : array-like of shape (n,)
        NaN on days without one.
    label : str
        What the picture shows, for a screen reader.
    deviation : array-like of shape (n,), default=None
        Standard deviations; the band is twice as wide to each side.
    limit : float, default=None
        Drawn as a dashed line.
    marks : sequence of (date, str)
        Days with a word each.
    unit : str, default=""

    Returns
    -------
    svg : str
        Empty where no day has a value.
    """
    series = np.asarray(values, dtype=float)
    if not np.isfinite(series).any():
        return ""
    spread = np.zeros(len(series)) if deviation is None else 2.0 * np.asarray(deviation, dtype=float)
    numbers = [day.toordinal() for day in days]
    low, high = float(np.nanmin(series - spread)), float(np.nanmax(series + spread))
    if limit is not None:
        low, high = min(low, limit), max(high, limit)
    ticks = _ticks(min(low, 0.0), high)
    low, high = min(ticks[0], low), max(ticks[-1], high)
    first, last = numbers[0], max(numbers[-1], numbers[0] + 1)

    def x(number: float) -> float:
        return _LEFT + (_WIDTH - _LEFT - _RIGHT) * (number - first) / (last - first)

    def y(value: float) -> float:
        return _TOP + (_HEIGHT - _TOP - _BOTTOM) * (high - value) / (high - low)

    parts = [_gridline(y(t), f"{t:g}{unit}") for t in ticks]
    for number in sorted({first, (first + last) // 2, last}):
        anchor = "start" if number == first else "end" if number == last else "middle"
        day = dt.date.fromordinal(number)
        parts.append(f'<text x="{x(number):.1f}" y="{_HEIGHT - 8}" text-anchor="{anchor}">{day}</text>')
    if spread.any():
        parts.append(_band(numbers, series, spread, x, y))
    parts += _curve(numbers, series, x, y)
    if limit is not None:
        parts.append(_level(y(limit), "limit"))
    for day, word in marks:
        at = x(day.toordinal())
        anchor = "end" if at > 0.7 * _WIDTH else "start"
        shift = -4 if anchor == "end" else 4
        parts.append(f'<line class="mark" x1="{at:.1f}" x2="{at:.1f}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}"/>')
        parts.append(
            f'<text x="{at + shift:.1f}" y="{_TOP + 10}" text-anchor="{anchor}">{escape(word)}</text>'
        )
    inside = "".join(parts)
    return f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(label)}">{inside}</svg>'


def _level(at: float, name: str) -> str:
    return f'<line class="{name}" x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{at:.1f}" y2="{at:.1f}"/>'


def _gridline(at: float, text: str) -> str:
    return (
        f'{_level(at, "grid")}<text x="{_LEFT - 6}" y="{at + 4:.1f}" text-anchor="end">{escape(text)}</text>'
    )


def _band(numbers, series, spread, x, y) -> str:
    known = np.flatnonzero(np.isfinite(series) & np.isfinite(spread))
    up = [f"{x(numbers[i]):.1f},{y(series[i] + spread[i]):.1f}" for i in known]
    down = [f"{x(numbers[i]):.1f},{y(series[i] - spread[i]):.1f}" for i in known[::-1]]
    return f'<polygon class="band" points="{" ".join(up + down)}"/>'


def _curve(numbers, series, x, y) -> list[str]:
    """Lines between days that follow each other, and a dot on each."""
    parts, run = [], []
    for k, value in enumerate(series):
        if np.isfinite(value):
            run.append(f"{x(numbers[k]):.1f},{y(value):.1f}")
            parts.append(f'<circle cx="{x(numbers[k]):.1f}" cy="{y(value):.1f}" r="2.2"/>')
        if run and (not np.isfinite(value) or k == len(series) - 1):
            parts.append(f'<polyline points="{" ".join(run)}"/>')
            run = []
    return parts


def _ticks(low: float, high: float) -> list[float]:
    """About four round numbers that span a range."""
    span = max(high - low, 1e-12)
    step = 10.0 ** np.floor(np.log10(span / 3.0))
    step *= min((m for m in (1.0, 2.0, 5.0, 10.0) if span / (step * m) <= 5.0), default=10.0)
    first, last = np.floor(low / step), np.ceil(high / step)
    return [float(round(k * step, 12)) for k in np.arange(first, last + 1)]
