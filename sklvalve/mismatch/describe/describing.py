# SPDX-License-Identifier: BSD-3-Clause
"""What was learnt of an unknown effect, said briefly: a short formula, and its curve over one signal.

A description and no law: it says what the learnt residual looks like in the rows that were recorded, chosen
from straight lines, bends, steps, bumps, waves and products of the signals that it hangs on.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.simulation.rest import input_words, learnt_at

if TYPE_CHECKING:
    from sklvalve.recording import Recording

    Scales = dict[str, tuple[float, float, str]]
    Shown = tuple[str, np.ndarray, str]

# of the scatter of the residual a further term must describe so much, and all of them together so much
_LEAST_SHARE, _DESCRIBES = 0.03, 0.6
_MOST_TERMS = 3
_PLACES = 9
# widths of a bump and lengths of a wave, shares of the range of a signal
_WIDTHS, _LENGTHS, _PHASES = (0.06, 0.12), np.geomspace(0.12, 1.0, 14), 8
_BINS = 40
_CYCLE = ("cosine", "sine")
# name -> factor and offset from what the learnt residual is given to what is shown, unit shown; where the
# recording has no unit of its own
_SHOWN = {
    "opening": (100.0, 0.0, "%"),
    "command": (100.0, 0.0, "%"),
    "dp": (100.0, 0.0, "kPa"),
    "temperature": (1.0, -273.15, "degC"),
    "pressure_ratio": (1.0, 0.0, ""),
}
# what the learnt residual is given of a pressure drop [Pa]
_BAR = 1e5


@dataclass(frozen=True, eq=False)
class Term:
    """One term of a description: its values in every row, its words, and the signal it is of."""

    values: np.ndarray
    words: str
    signal: int


def described(
    correction: dict[str, Any], slope: float, unit: str, scales: Scales | None = None
) -> dict[str, Any]:
    """Short formula of a learnt residual, and its curve over the signal that tells most of it.

    Parameters
    ----------
    correction : dict
        As `learnt_rest` takes it.
    slope : float
        From SI to the unit of the signal.
    unit : str
    scales : dict or None, default=None
        As `scales_of` gives them.

    Returns
    -------
    description : dict
        ``formula`` (None where no short one holds six tenths of it), ``share`` of its variance that the
        formula holds [1], and ``curve``: ``signal, unit``, and by its value ``at`` the mean ``rest``.
    """
    residual = slope * learnt_at(correction, correction["support"])
    signals = correction["support"] * correction["scale"] + correction["centre"]
    scales = _SHOWN if scales is None else scales
    pairs = zip(correction["inputs"], signals.T, strict=True)
    shown = [_shown(name, column, scales) for name, column in pairs]
    chosen, coefficients, share = _chosen(residual, _terms(shown))
    main = chosen[0].signal if chosen else 0
    name, values, unit_shown = shown[main]
    formula = None
    if share >= _DESCRIBES:
        left = f"{correction['channel']} residual" + (f" [{unit}]" if unit != "1" else "")
        formula = f"{left} = {_written(coefficients, chosen)}"
    return {
        "formula": formula,
        "share": round(float(share), 3),
        "curve": {"signal": name, "unit": unit_shown} | _curve(values, residual),
    }


def scales_of(recording: Recording) -> Scales:
    """How signals are shown that a learnt residual hangs on: pressures and temperatures as recorded.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    scales : dict
        Signal -> factor and offset from what the residual is given to what is shown, and the unit shown.
    """
    scales = dict(_SHOWN)
    if "p1" in recording:
        scales["dp"] = (_BAR * abs(recording.per_si("p1")), 0.0, recording.unit("p1"))
    if "temperature" in recording:
        zero = float(recording.in_recorded_units("temperature", np.zeros(1))[0])
        scales["temperature"] = (recording.per_si("temperature"), zero, recording.unit("temperature"))
    return scales


def _shown(name: str, column: np.ndarray, scales: Scales) -> Shown:
    """Words for a signal that remembers or not, its values as they are shown, and their unit."""
    signal, _, memory = name.partition(" ")
    if signal in _CYCLE:
        return f"{signal}(360 deg time / {memory})", column, ""
    factor, offset, unit = scales.get(signal, (1.0, 0.0, ""))
    return input_words(name), factor * column + offset, unit


def _terms(shown: list[Shown]) -> list[Term]:
    """Everything that a description may be made of."""
    terms: list[Term] = []
    for i, (name, values, unit) in enumerate(shown):
        there = f"{name} [{unit}]" if unit else name
        terms.append(Term(values, there, i))
        if not name.startswith(_CYCLE):
            terms += [*_bends(values, there, i), *_waves(values, there, i)]
        for j, (other, beside, its) in enumerate(shown[:i]):
            # about their middles, or a product would mostly repeat what either does alone
            middles = _round(values.mean()), _round(beside.mean())
            besides = f"{other} [{its}]" if its else other
            words = f"({_minus(besides, middles[1])}) ({_minus(there, middles[0])})"
            terms.append(Term((values - middles[0]) * (beside - middles[1]), words, j))
    return [term for term in terms if np.ptp(term.values) > 0.0]


def _bends(values: np.ndarray, there: str, signal: int) -> Iterator[Term]:
    """A signal that begins to count at a place, or beyond it alone, or around it alone."""
    places = np.quantile(values, np.linspace(0.0, 1.0, _PLACES + 2)[1:-1])
    widths = [_round(share * np.ptp(values)) for share in _WIDTHS]
    for place in np.unique([_round(each) for each in places]):
        yield Term(np.maximum(values - place, 0.0), f"max(0, {_minus(there, place)})", signal)
        yield Term((values > place).astype(float), f"({there} > {place:.3g})", signal)
        for width in widths:
            bump = np.exp(-(((values - place) / max(width, 1e-300)) ** 2))
            yield Term(bump, f"exp(-(({_minus(there, place)}) / {width:.3g})^2)", signal)


def _waves(values: np.ndarray, there: str, signal: int) -> Iterator[Term]:
    """Waves along a signal, as high everywhere, or growing with it."""
    lengths = [_round(share * np.ptp(values)) for share in _LENGTHS]
    for length in (each for each in lengths if each > 0.0):
        # the other half of the phases is the same wave with the other sign
        for phase in range(_PHASES // 2):
            begin = _round(values.min() + length * phase / _PHASES)
            wave = np.sin(2.0 * np.pi * (values - begin) / length)
            words = f"sin(360 deg ({_minus(there, begin)}) / {length:.3g})"
            yield Term(wave, words, signal)
            yield Term(wave * values, f"{there} {words}", signal)


def _minus(there: str, place: float) -> str:
    return f"{there} {'-' if place >= 0.0 else '+'} {abs(place):.3g}"


def _round(value: float) -> float:
    """A number as it is written, so that what is written is what was meant."""
    return float(f"{value:.3g}")


def _chosen(residual: np.ndarray, terms: list[Term]) -> tuple[list[Term], np.ndarray, float]:
    """Terms taken one after the other, each the one that leaves least, all fitted together each time."""
    chosen: list[Term] = []
    share, spread = 0.0, float(np.sum((residual - residual.mean()) ** 2))
    coefficients = np.array([residual.mean()])
    while len(chosen) < _MOST_TERMS and spread > 0.0:
        tried = [(*_fitted(residual, [*chosen, term]), term) for term in terms if term not in chosen]
        if not tried:
            break
        fitted, left, best = min(tried, key=lambda each: each[1])
        if 1.0 - left / spread < share + _LEAST_SHARE:
            break
        chosen, coefficients, share = [*chosen, best], fitted, 1.0 - left / spread
    return chosen, coefficients, share


def _fitted(residual: np.ndarray, terms: list[Term]) -> tuple[np.ndarray, float]:
    columns = np.column_stack([np.ones(len(residual)), *(term.values for term in terms)])
    scale = np.abs(columns).max(axis=0)
    coefficients = np.linalg.lstsq(columns / scale, residual, rcond=1e-9)[0] / scale
    return coefficients, float(np.sum((residual - columns @ coefficients) ** 2))


def _written(coefficients: np.ndarray, terms: list[Term]) -> str:
    """A formula: its constant, and each term with its factor."""
    text = f"{coefficients[0]:.3g}"
    for factor, term in zip(coefficients[1:], terms, strict=True):
        text += f" {'-' if factor < 0.0 else '+'} {abs(factor):.3g} {term.words}"
    return text


def _curve(values: np.ndarray, residual: np.ndarray) -> dict[str, list[float]]:
    """Mean residual by the value of a signal, in bins of one width as far as they hold rows."""
    edges = np.linspace(values.min(), values.max(), _BINS + 1)
    of = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, _BINS - 1)
    bins = [np.flatnonzero(of == k) for k in np.unique(of)]
    return {
        "at": [float(f"{values[b].mean():.5g}") for b in bins],
        "rest": [float(f"{residual[b].mean():.4g}") for b in bins],
    }
