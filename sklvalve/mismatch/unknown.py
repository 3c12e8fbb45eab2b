# SPDX-License-Identifier: BSD-3-Clause
"""What no effect of the catalogue explains: whether the rest can be predicted, from what, and how much."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.lssvm.held_out import BlockedErrors
from sklvalve.simulation.rest import rest_inputs

_BLOCKS = 8
_MOST_POINTS = 700
_MOST_SHIFTS = 100
_FEWEST_POINTS = 60
_GAP = 3
_MOST_REMEMBERED = 1000
# samples for which a rest of the user's own simulation remembers
_MEMORY = (10, 40)


@dataclass(frozen=True, eq=False)
class Unknown:
    """A predictable rest.

    Attributes
    ----------
    channel : str
    inputs : tuple of str
        Signals it depends on.
    size : float
        Rms of its prediction on held-out blocks where it acts, share of span [1].
    skill : float
        Share of the rest's slow variance that is predicted on held-out blocks [1].
    p_value : float
        Share of time-shifted inputs that predict as well.
    correction : dict
        Plain arrays of the fitted LS-SVM: centre, scale, support, coefficients, intercept, gamma.
    """

    channel: str
    inputs: tuple
    size: float
    skill: float
    p_value: float
    correction: dict


def static_inputs(chain, model_values, channel):
    """Signals that a rest may hang on: name -> values."""
    recording, given = chain.recording, f"simulated_{channel}"
    names = ["command"] if channel == "opening" else ["opening"]
    if given in recording:
        # what the user simulated may hold a slow process: a rest of it remembers
        driver = "opening" if "opening" in recording and channel == "flow" else "command"
        names = [given, *([driver] if driver in recording else [])]
        names += [f"{name} {many * recording.sample_time:.6g} s" for name in names for many in _MEMORY]
    if channel == "flow" and chain.has_pressures:
        names += ["dp"] + (["pressure_ratio"] if chain.pressure_ratio is not None else [])
    if "temperature" in chain.recording:
        names.append("temperature")
    columns = rest_inputs(chain, model_values, names).T
    steady = {}
    for name, values in zip(names, columns, strict=True):
        spread = np.nanstd(values)
        if np.isfinite(spread) and spread > 1e-9:
            steady[name] = values
    return steady


def _thinned(values, keep, width):
    """Means over stretches of `width` rows, rows outside `keep` left out."""
    n = len(values) // width
    table = np.where(keep, values, np.nan)[: n * width].reshape(n, width)
    with np.errstate(invalid="ignore"):
        count = np.isfinite(table).sum(axis=1)
        mean = np.nansum(table, axis=1) / np.maximum(count, 1)
    return np.where(count > 0.6 * width, mean, np.nan)


def find_unknown(workbench, model, *, alpha, random_state=0, channels=None):
    """Look for a predictable rest in each channel.

    The rest is averaged over short stretches in which nothing moves fast, and predicted from slow signals by
    an LS-SVM on contiguous blocks that it was not fitted to. Chance is judged by the same prediction from
    inputs shifted in time against it, which keeps every correlation but the one in question.

    Parameters
    ----------
    workbench : Workbench
    model : Model
    alpha : float
        Level of the test.
    random_state : int
    channels : sequence of str, default=None
        Where to look; in all channels of the workbench unless given.

    Returns
    -------
    unknown : Unknown or None
        The largest one that is significant and large enough to count.
    """
    rng = np.random.default_rng(random_state)
    best = None
    for channel in workbench.channels if channels is None else channels:
        found = _in_channel(workbench, model, channel, alpha, rng)
        if found is not None and (best is None or found.size > best.size):
            best = found
    return best


def learn_rest(workbench, model, channel, rows=None):
    """The rest of a channel as an LS-SVM of slow signals, tuned and fitted on some rows and no others.

    Parameters
    ----------
    workbench : Workbench
    model : Model
        Fitted to the same rows.
    channel : str
    rows : ndarray of bool, default=None
        All of them unless given.

    Returns
    -------
    correction : dict or None
        As `learnt_rest` takes it; None where the rows are too few.
    """
    slow = _slow(workbench, model, channel, rows)
    return None if slow is None else _tuned(slow).correction(channel, workbench.spans[channel])


@dataclass(frozen=True, eq=False)
class _Slow:
    """Slow part of a rest, share of span, what it may hang on, and how far apart it is held out."""

    X: np.ndarray
    y: np.ndarray
    names: tuple
    gap: int
    remembers: bool


def _slow(workbench, model, channel, rows=None):
    """The rest and its inputs, thinned to stretches in which nothing moves fast; None if there are few."""
    inputs = static_inputs(model.chain, model.values, channel)
    if not inputs:
        return None
    rest = workbench.residuals(model)[channel] / workbench.spans[channel]
    shown = model.predictions[channel] / workbench.spans[channel]
    quiet = np.abs(np.gradient(np.nan_to_num(shown))) < 0.01
    width = max(int(np.ceil(len(rest) / _MOST_POINTS)), 3)
    gap, remembers = _GAP, f"simulated_{channel}" in workbench.recording
    if remembers:
        # inputs that remember know of movement, and are held out with their past
        quiet, width = np.ones(len(rest), dtype=bool), max(len(rest) // _MOST_REMEMBERED, 1)
        gap = int(np.ceil(0.25 * max(_MEMORY) / width))
    if rows is not None:
        quiet &= rows
    y = _thinned(rest, quiet, width)
    X = np.column_stack([_thinned(v, quiet, width) for v in inputs.values()])
    keep = np.isfinite(y) & np.isfinite(X).all(axis=1)
    if keep.sum() < _FEWEST_POINTS:
        return None
    return _Slow(X[keep], y[keep], tuple(inputs), gap, remembers)


def _in_channel(workbench, model, channel, alpha, rng):
    slow = _slow(workbench, model, channel)
    if slow is None:
        return None
    y, best = slow.y, _tuned(slow)
    size = _acting_rms(best.predicted)
    if size < workbench.least(channel) or best.skill < 0.1:
        return None
    # the rest shifted against its inputs: the inputs, and all that is dear about them, stay
    possible = np.arange(len(y) // 8, len(y) - len(y) // 8)
    shifts = rng.choice(possible, size=min(_MOST_SHIFTS, len(possible)), replace=False)
    chance = _skills(best.held_out, np.column_stack([np.roll(y, s) for s in shifts]))[0]
    p_value = (1.0 + np.sum(chance >= best.skill)) / (1.0 + len(chance))
    # no number of shifts that is cheap can show less than one in their number
    if p_value > max(alpha, 1.5 / (1.0 + len(chance))):
        return None
    matter = _inputs_that_matter(best)
    correction = best.correction(channel, workbench.spans[channel])
    return Unknown(channel, matter, size, float(best.skill), float(p_value), correction)


@dataclass(frozen=True, eq=False)
class _Tuned:
    """An LS-SVM of chosen inputs, scaled, and how it predicts blocks that it was not fitted to."""

    names: tuple
    centre: np.ndarray
    scale: np.ndarray
    Z: np.ndarray
    slow: _Slow
    regressor: LSSVMRegressor
    held_out: BlockedErrors
    skill: float
    predicted: np.ndarray

    def correction(self, channel, span):
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


def _trials(slow):
    """Inputs, width of the kernel and weight of the errors to be tried."""
    every = list(range(slow.X.shape[1]))
    if slow.remembers:
        # the simulated signal with its own past, and what drives it now; smoothly, and without a choice that
        # a few long stretches could not support: a block that is held out may lie beyond all others
        own = [i for i in every if slow.names[i].startswith("simulated_")]
        now = [i for i in every if not slow.names[i].endswith(" s")]
        return [(sorted({*own, *now}), 0.03, 100.0)]
    # each alone, finely, or all, smoothly
    trials = [([i], gamma, 10.0) for i in every for gamma in (1.0, 8.0)]
    return trials + [(every, gamma, 10.0) for gamma in (0.1, 0.5, 2.0) if len(every) > 1]


def _tuned(slow):
    """Inputs and LS-SVM that predict held-out blocks best."""
    X, y, names = slow.X, slow.y, slow.names
    centre, scale = X.mean(axis=0), X.std(axis=0) + 1e-12
    Z, best = (X - centre) / scale, None
    for chosen, gamma, C in _trials(slow):
        regressor = LSSVMRegressor(gamma=gamma, C=C)
        held_out = _held_out(regressor, Z[:, chosen], slow)
        (skill,), predicted = _skills(held_out, y[:, None])
        if best is None or skill > best.skill:
            kept, own = tuple(names[i] for i in chosen), (centre[chosen], scale[chosen], Z[:, chosen])
            best = _Tuned(kept, *own, slow, regressor, held_out, float(skill), predicted[:, 0])
    return best


def _acting_rms(predicted):
    size = np.abs(predicted)
    acting = size > 0.25 * np.quantile(size, 0.99)
    return float(np.sqrt(np.mean(predicted[acting] ** 2))) if acting.any() else 0.0


def _held_out(regressor, Z, slow):
    edges = np.linspace(0, len(Z), _BLOCKS + 1).astype(int)
    blocks = [slice(low, high) for low, high in pairwise(edges)]
    return BlockedErrors(Z, C=regressor.C, gamma=regressor.gamma, blocks=blocks, gap=slow.gap)


def _skills(held_out, Y):
    """Share of each target's variance that is predicted on held-out blocks, and the predictions."""
    left = held_out(Y)
    spread = np.sum((Y - Y.mean(axis=0)) ** 2, axis=0)
    # of a target that never moves nothing is left to be predicted
    share = np.divide(np.sum(left**2, axis=0), spread, out=np.ones_like(spread), where=spread > 0.0)
    return 1.0 - share, Y - left


def _inputs_that_matter(tuned):
    """Inputs whose loss costs a good part of the skill."""
    names, skill = tuned.names, tuned.skill
    if len(names) == 1:
        return names
    lost = []
    for i in range(len(names)):
        without = tuned.Z.copy()
        without[:, i] = 0.0
        lost.append(
            skill - _skills(_held_out(tuned.regressor, without, tuned.slow), tuned.slow.y[:, None])[0][0]
        )
    return tuple(n for n, gone in zip(names, lost, strict=True) if gone > 0.2 * skill) or (
        names[int(np.argmax(lost))],
    )
