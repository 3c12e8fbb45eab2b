# SPDX-License-Identifier: BSD-3-Clause
"""Defects of data, planted in the columns of a recording: what a historian, a converter or a wiring does."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np


@dataclass(frozen=True)
class Defect:
    """One defect of one size."""

    label: str
    findings: tuple  # names by which it counts as found
    columns: tuple  # the channels that may be named
    plant: Callable  # (columns, rng) -> columns
    excused: tuple = ()  # further findings that the defect really causes
    band: float = 0.0  # of a compression, in the column's unit


def swinging_door(values, band):
    """Lines between the points that a swinging door keeps."""
    kept, start = [0], 0
    low, high = -np.inf, np.inf
    for row in range(1, len(values)):
        low = max(low, (values[row] - band - values[start]) / (row - start))
        high = min(high, (values[row] + band - values[start]) / (row - start))
        if low > high:
            start = row - 1
            kept.append(start)
            low, high = values[row] - band - values[start], values[row] + band - values[start]
    kept.append(len(values) - 1)
    return np.interp(np.arange(len(values)), kept, values[kept])


def box_car(values, band, *, hold):
    """Values kept when they leave a band about the last kept one; held, or joined by lines."""
    kept = [0]
    for row in range(1, len(values)):
        if abs(values[row] - values[kept[-1]]) > band:
            kept.append(row)
    rows = np.arange(len(values))
    if hold:
        return values[np.array(kept)[np.searchsorted(kept, rows, side="right") - 1]]
    return np.interp(rows, kept, values[kept])


def shifted(values, rows):
    """Values that stand `rows` rows later than they should (negative: earlier); the ends are repeated."""
    places = np.clip(np.arange(len(values)) - rows, 0, len(values) - 1)
    return values[places]


def _on(name, change, columns, rng):
    digits = decimals(columns[name])
    columns[name] = np.round(change(columns[name], rng), digits)
    return columns


def decimals(values):
    """Decimals that a recording writes a channel with, six at most."""
    for digits in range(6):
        if np.abs(values - np.round(values, digits)).max() < 1e-9 * max(1.0, np.abs(values).max()):
            return digits
    return 6


def _freeze(values, rng, *, rows, times):
    for _ in range(times):
        start = int(rng.integers(60, len(values) - rows - 60))
        values[start : start + rows] = values[start]
    return values


def _clip(values, rng, *, share, top, within=(-np.inf, np.inf)):
    limit = np.clip(np.quantile(values, 1.0 - share if top else share), *within)
    return np.minimum(values, limit) if top else np.maximum(values, limit)


def _jitter(values, rng, *, rows):
    places = np.arange(len(values)) + rng.integers(-rows, rows + 1, len(values))
    return values[np.clip(places, 0, len(values) - 1)]


def _gaps(values, rng, *, rows):
    start = int(rng.integers(60, len(values) - rows - 60))
    values[start : start + rows] = np.nan
    return values


def _swap(first, second, columns, rng):
    columns[first], columns[second] = columns[second], columns[first]
    return columns


def _shift(name, rows, columns, rng):
    columns[name] = shifted(columns[name], rows)
    inside = slice(abs(rows), len(columns[name]) - abs(rows))
    return {column: values[inside] for column, values in columns.items()}


def defects(made):
    """All defects at several sizes for a recording of the plant (its sheet gives the flow span)."""
    span = {"CV": 100.0, "X": 100.0, "P1": 1000.0, "P2": 1000.0, "F": 1.5 * made.valve["valve"]["kv_rated"]}
    return [
        *_compression(span),
        *_steps(span),
        *_stops(),
        *_clocks(),
        *_wiring(),
        *_scales(),
    ]


def _compression(span):
    out = []
    for percent in (0.1, 0.25, 0.5, 1.0, 2.0):
        for name in ("X", "F", "P1", "P2"):
            band = percent / 100.0 * span[name]
            kinds = {
                "swinging door": lambda v, rng, band=band: swinging_door(v, band),
                "box-car held": lambda v, rng, band=band: box_car(v, band, hold=True),
                "box-car lines": lambda v, rng, band=band: box_car(v, band, hold=False),
            }
            for kind, change in kinds.items():
                plant = partial(_on, name, change)
                out.append(Defect(f"{kind} {name} {percent:g} %", ("compressed",), (name,), plant, band=band))
    for rows in (3, 10):
        plant = partial(_on, "F", lambda v, rng, rows=rows: np.repeat(v[::rows], rows)[: len(v)])
        out.append(Defect(f"scan F {rows} s", ("compressed",), ("F",), plant))
    return out


def _steps(span):
    out = []
    for percent in (0.1, 0.2, 0.5, 1.0):
        for name in ("X", "F", "P1"):
            step = percent / 100.0 * span[name]
            plant = partial(_on, name, lambda v, rng, step=step: step * np.round(v / step))
            out.append(Defect(f"quantised {name} {percent:g} %", ("quantised",), (name,), plant))
    return out


def _stops():
    out = []
    for name in ("X", "F", "P1", "P2", "T1"):
        for label, rows, times in (
            ("30 s", 30, 1),
            ("60 s", 60, 1),
            ("300 s", 300, 1),
            ("5x30 s", 30, 5),
            ("third", 1920, 1),
        ):
            plant = partial(_on, name, partial(_freeze, rows=rows, times=times))
            out.append(Defect(f"frozen {name} {label}", ("frozen",), (name,), plant))
    for rows in (120, 300, 900):
        plant = partial(_on, "CV", partial(_freeze, rows=rows, times=1))
        out.append(Defect(f"frozen CV {rows} s", ("frozen",), ("CV",), plant))
    for name in ("X", "F", "P1", "P2"):
        for share in (0.02, 0.05, 0.15):
            for top in (True, False):
                if name == "F" and not top and share < 0.15:
                    continue
                # at its stops a stem stands still anyway
                within = (10.0, 90.0) if name == "X" else (-np.inf, np.inf)
                plant = partial(_on, name, partial(_clip, share=share, top=top, within=within))
                end = "top" if top else "bottom"
                out.append(Defect(f"saturated {name} {end} {share:g}", ("saturated",), (name,), plant))
    for name in ("X", "F"):
        for rows in (1, 60):
            plant = partial(_on, name, partial(_gaps, rows=rows))
            out.append(Defect(f"gap {name} {rows} s", ("gap",), (name,), plant))
    return out


def _clocks():
    out = []
    for name in ("CV", "X", "F", "P1", "P2"):
        for rows in (2, 5, 10, 30, -2, -5, -10, -30):
            plant = partial(_shift, name, rows)
            others = tuple({"CV", "X", "F", "P1", "P2"} - {name}) if abs(rows) < 5 else ()
            out.append(Defect(f"clock {name} {rows:+d} s", ("clock_shift",), (name, *others), plant))
        plant = partial(_on, name, partial(_jitter, rows=3))
        out.append(Defect(f"jitter {name} 3 s", ("clock_shift",), (name,), plant))
    return out


def _wiring():
    pairs = [("P1", "P2"), ("CV", "X"), ("F", "P1"), ("F", "P2"), ("F", "X"), ("F", "CV"), ("T1", "P2")]
    pairs += [("T1", "P1"), ("T1", "F"), ("P1", "X"), ("P2", "X"), ("T1", "X")]
    bad = ("swapped", "unit_suspect")
    return [
        Defect(f"swapped {a}<->{b}", bad, (a, b), partial(_swap, a, b), (*bad, "clock_shift"))
        for a, b in pairs
    ]


def _scales():
    out = []
    cases = [
        ("F l/s", ("F",), 1 / 3.6),
        ("F gpm", ("F",), 4.403),
        ("F l/min", ("F",), 1000.0 / 60.0),
        ("P1 psi", ("P1",), 0.145),
        ("P2 psi", ("P2",), 0.145),
        ("P1 bar", ("P1",), 0.01),
        ("P2 bar", ("P2",), 0.01),
        ("P1 P2 psi", ("P1", "P2"), 0.145),
        ("P1 P2 bar", ("P1", "P2"), 0.01),
        ("X fraction", ("X",), 0.01),
        ("CV fraction", ("CV",), 0.01),
    ]
    for label, names, factor in cases:

        def plant(columns, rng, names=names, factor=factor):
            for name in names:
                columns[name] = np.round(columns[name] * factor, 5)
            return columns

        out.append(
            Defect(
                f"scaled {label}",
                ("unit_suspect",),
                (*names, "F", "P1", "P2"),
                plant,
                ("swapped", "quantised"),
            )
        )

    def kelvin(columns, rng):
        columns["T1"] = np.round(columns["T1"] + 273.15, 2)
        return columns

    out.append(Defect("scaled T1 kelvin", ("unit_suspect",), ("T1",), kelvin))
    return out
