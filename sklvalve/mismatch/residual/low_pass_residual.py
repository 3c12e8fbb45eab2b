# SPDX-License-Identifier: BSD-3-Clause
"""The slow part of what a simulation leaves over of a channel, and the LS-SVM that predicts it best."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.held_out import HeldOutErrors, blocked_errors
from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.rest import rest_inputs

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.residual.unknown import Unknown
    from sklvalve.recording import Recording

_BLOCKS, _GAP = 8, 3
_MOST_POINTS, _FEWEST_POINTS = 700, 60
_MOST_REMEMBERED = 1000
# samples for which a rest of the user's own simulation remembers
_MEMORY = (10, 40)
# time constants with which metal follows the fluid [s]
_WARMING = (150.0, 600.0)


def static_inputs(chain: Chain, model_values: dict[str, float], channel: str) -> dict[str, np.ndarray]:
    """Signals that a residual may depend on: name -> values."""
    names = _names_of_inputs(chain, channel)
    columns = rest_inputs(chain, model_values, names).T
    steady = {}
    for name, values in zip(names, columns, strict=True):
        spread = np.nanstd(values)
        if np.isfinite(spread) and spread > 1e-9:
            steady[name] = values
    return steady


def _names_of_inputs(chain: Chain, channel: str) -> list[str]:
    names = ["command"] if channel == "opening" else ["opening"]
    if f"simulated_{channel}" in chain.recording:
        names = _names_beside_external(chain.recording, channel)
    if channel == "flow" and chain.has_pressures:
        names += ["dp"] + (["pressure_ratio"] if chain.pressure_ratio is not None else [])
    if "temperature" in chain.recording:
        # what is warmed follows late: body and bonnet, stem and packing
        names += ["temperature", *(f"temperature {lag:.6g} s" for lag in _WARMING)]
    return names


def _names_beside_external(recording: Recording, channel: str) -> list[str]:
    """A simulation of the user's own may hold a slow process: a residual of it remembers."""
    driver = "opening" if "opening" in recording and channel == "flow" else "command"
    names = [f"simulated_{channel}", *([driver] if driver in recording else [])]
    return names + [f"{name} {many * recording.sample_time:.6g} s" for name in names for many in _MEMORY]


def cyclic_inputs(
    chain: Chain, model_values: dict[str, float], static: dict[str, np.ndarray], period: float
) -> dict[str, np.ndarray]:
    """Signals that a cycle hangs on: its two waves, and what the simulated signal is driven by."""
    names = [f"cosine {period:.6g} s", f"sine {period:.6g} s"]
    waves = dict(zip(names, rest_inputs(chain, model_values, names).T, strict=True))
    return waves | {name: static[name] for name in ("opening", "command") if name in static}


@dataclass(frozen=True, eq=False)
class SlowResidual:
    """Slow part of a residual, share of span, what it may hang on, and how far apart it is held out."""

    X: np.ndarray
    y: np.ndarray
    names: tuple[str, ...]
    gap: int
    remembers: bool
    cycles: bool = False


def low_pass_residual(
    problem: Problem, model: Model, channel: str, rows: np.ndarray | None = None, period: float | None = None
) -> SlowResidual | None:
    """Residual and inputs, thinned to stretches in which nothing moves fast; None if there are few."""
    inputs = static_inputs(model.chain, model.values, channel)
    if period is not None:
        inputs = cyclic_inputs(model.chain, model.values, inputs, period)
    if not inputs:
        return None
    residual = problem.residuals(model)[channel] / problem.spans[channel]
    shown = model.predictions[channel] / problem.spans[channel]
    quiet = np.abs(np.gradient(np.nan_to_num(shown))) < 0.01
    width = max(int(np.ceil(len(residual) / _MOST_POINTS)), 3)
    gap, remembers = _GAP, f"simulated_{channel}" in problem.recording and period is None
    if remembers:
        # inputs that remember know of movement, and are held out with their past
        quiet, width = np.ones(len(residual), dtype=bool), max(len(residual) // _MOST_REMEMBERED, 1)
        gap = int(np.ceil(0.25 * max(_MEMORY) / width))
    if rows is not None:
        quiet &= rows
    y = _thinned(residual, quiet, width)
    X = np.column_stack([_thinned(v, quiet, width) for v in inputs.values()])
    keep = np.isfinite(y) & np.isfinite(X).all(axis=1)
    if keep.sum() < _FEWEST_POINTS:
        return None
    return SlowResidual(X[keep], y[keep], tuple(inputs), gap, remembers, period is not None)


def _thinned(values: np.ndarray, keep: np.ndarray, width: int) -> np.ndarray:
    """Means over stretches of `width` rows, rows outside `keep` left out."""
    n = len(values) // width
    table = np.where(keep, values, np.nan)[: n * width].reshape(n, width)
    with np.errstate(invalid="ignore"):
        count = np.isfinite(table).sum(axis=1)
        mean = np.nansum(table, axis=1) / np.maximum(count, 1)
    return np.where(count > 0.6 * width, mean, np.nan)


@dataclass(frozen=True, eq=False)
class TunedResidual:
    """An LS-SVM of chosen inputs, scaled, and how it predicts blocks that it was not fitted to."""

    names: tuple[str, ...]
    centre: np.ndarray
    scale: np.ndarray
    Z: np.ndarray
    slow: SlowResidual
    regressor: LSSVMRegressor
    held_out: HeldOutErrors
    skill: float
    predicted: np.ndarray

    def correction(self, channel: str, span: float) -> dict[str, Any]:
        """Fitted to every row, as plain data."""
        self.regressor.fit(self.Z, self.slow.y)
        return {
            "channel": channel,
            "inputs": self.names,
            "centre": self.centre,
            "scale": self.scale,
            "support": self.Z,
            "coefficients": np.asarray(self.regressor.dual_coef_, dtype=float),
            "intercept": float(self.regressor.intercept_),
            "gamma": float(self.regressor.gamma),
            "span": float(span),
        }


def tuned(slow: SlowResidual) -> TunedResidual:
    """Inputs and LS-SVM that predict held-out blocks best."""
    X, y, names = slow.X, slow.y, slow.names
    centre, scale = X.mean(axis=0), X.std(axis=0) + 1e-12
    Z = (X - centre) / scale
    best: TunedResidual | None = None
    for chosen, gamma, C in _trials(slow):
        regressor = LSSVMRegressor(gamma=gamma, C=C)
        held_out = held_out_errors(regressor, Z[:, chosen], slow)
        (skill,), predicted = skills(held_out, y[:, None])
        if best is None or skill > best.skill:
            kept, scaled = tuple(names[i] for i in chosen), (centre[chosen], scale[chosen], Z[:, chosen])
            best = TunedResidual(kept, *scaled, slow, regressor, held_out, float(skill), predicted[:, 0])
    assert best is not None
    return best


def _trials(slow: SlowResidual) -> list[tuple[list[int], float, float]]:
    """Inputs, width of the kernel and weight of the errors to be tried."""
    every = list(range(slow.X.shape[1]))
    if slow.cycles:
        # the smoothest are near to products of wave and opening, which go on beyond the rows learnt from
        settings = ((0.02, 100.0), (0.1, 10.0), (0.5, 10.0))
        return [(inputs, *setting) for inputs in (every[:2], every) for setting in settings]
    if slow.remembers:
        # the simulated signal with its own past, and what drives it now; smoothly, and without a choice that
        # a few long stretches could not support: a block that is held out may lie beyond all others
        external = [i for i in every if slow.names[i].startswith("simulated_")]
        now = [i for i in every if not slow.names[i].endswith(" s")]
        return [(sorted({*external, *now}), 0.03, 100.0)]
    return _trials_of_signals(slow, every)


def _trials_of_signals(slow: SlowResidual, every: list[int]) -> list[tuple[list[int], float, float]]:
    # each alone, finely, or all, smoothly; or how far something lags behind the temperature
    late = [i for i in every if slow.names[i].endswith(" s")]
    now = [i for i in every if i not in late]
    trials = [([i], gamma, 10.0) for i in now for gamma in (1.0, 8.0)]
    trials += [(now, gamma, 10.0) for gamma in (0.1, 0.5, 2.0) if len(now) > 1]
    first = [i for i in now if slow.names[i] == "temperature"]
    return trials + [([*first, i], 0.1, 100.0) for i in late]


def held_out_errors(regressor: LSSVMRegressor, Z: np.ndarray, slow: SlowResidual) -> HeldOutErrors:
    edges = np.linspace(0, len(Z), _BLOCKS + 1).astype(int)
    blocks = [slice(low, high) for low, high in pairwise(edges)]
    return blocked_errors(Z, C=regressor.C, gamma=regressor.gamma, blocks=blocks, gap=slow.gap)


def skills(held_out: HeldOutErrors, Y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Share of each target's variance that is predicted on held-out blocks, and the predictions."""
    left = held_out(Y)
    spread = np.sum((Y - Y.mean(axis=0)) ** 2, axis=0)
    # of a target that never moves nothing is left to be predicted
    share = np.divide(np.sum(left**2, axis=0), spread, out=np.ones_like(spread), where=spread > 0.0)
    return 1.0 - share, Y - left


def learn_residual(
    problem: Problem, model: Model, unknown: Unknown, rows: np.ndarray | None = None
) -> dict[str, Any] | None:
    """The residual of a channel as an LS-SVM of slow signals, tuned and fitted on some rows and no others.

    Parameters
    ----------
    problem : Problem
    model : Model
        Fitted to the same rows.
    unknown : Unknown
        Whose channel, and period if it has one, are taken.
    rows : ndarray of bool, default=None
        All of them unless given.

    Returns
    -------
    correction : dict or None
        As `learnt_rest` takes it; None where the rows are too few.
    """
    slow = low_pass_residual(problem, model, unknown.channel, rows, unknown.period)
    return None if slow is None else tuned(slow).correction(unknown.channel, problem.spans[unknown.channel])
