# SPDX-License-Identifier: BSD-3-Clause
"""What no effect of the catalogue explains: whether the rest can be predicted, from what, and how much."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sklvalve.lssvm import LSSVMRegressor

_BLOCKS = 8
_MOST_POINTS = 700
_MOST_SHIFTS = 100


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
    found = {}
    if channel == "flow":
        found["opening"] = chain.drive(model_values)
        if chain.has_pressures:
            found["dp"] = chain.dp / 1e5
        if chain.pressure_ratio is not None:
            found["pressure_ratio"] = chain.pressure_ratio
    else:
        found["command"] = chain.command
    if "temperature" in chain.recording:
        found["temperature"] = chain.temperature
    steady = {}
    for name, values in found.items():
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


def find_unknown(workbench, model, *, alpha, random_state=0):
    """Look for a predictable rest in each channel.

    The rest is averaged over short stretches in which nothing moves fast, and predicted from slow signals by
    an LS-SVM on contiguous blocks that it was not fitted to. Chance is judged by the same prediction from
    inputs shifted in time against the rest, which keeps every correlation but the one in question.

    Parameters
    ----------
    workbench : Workbench
    model : Model
    alpha : float
        Level of the test.
    random_state : int

    Returns
    -------
    unknown : Unknown or None
        The largest one that is significant and large enough to count.
    """
    rng = np.random.default_rng(random_state)
    best = None
    for channel in workbench.channels:
        found = _in_channel(workbench, model, channel, alpha, rng)
        if found is not None and (best is None or found.size > best.size):
            best = found
    return best


def _in_channel(workbench, model, channel, alpha, rng):
    chain = model.chain
    inputs = static_inputs(chain, model.values, channel)
    if not inputs:
        return None
    rest = workbench.residuals(model)[channel] / workbench.spans[channel]
    shown = model.predictions[channel] / workbench.spans[channel]
    quiet = np.abs(np.gradient(np.nan_to_num(shown))) < 0.01
    width = max(int(np.ceil(len(rest) / _MOST_POINTS)), 3)
    y = _thinned(rest, quiet, width)
    X = np.column_stack([_thinned(v, quiet, width) for v in inputs.values()])
    keep = np.isfinite(y) & np.isfinite(X).all(axis=1)
    y, X = y[keep], X[keep]
    if len(y) < 60:
        return None
    names = tuple(inputs)
    centre, scale = X.mean(axis=0), X.std(axis=0) + 1e-12
    Z = (X - centre) / scale
    chosen, regressor, skill, predicted = _tuned(Z, y)
    Z, names, centre, scale = Z[:, chosen], tuple(names[i] for i in chosen), centre[chosen], scale[chosen]
    size = _acting_rms(predicted)
    least = workbench.tolerance.opening_effect if channel == "opening" else workbench.tolerance.flow_effect
    if size < least or skill < 0.1:
        return None
    shifts = np.unique(rng.integers(len(y) // 8, len(y) - len(y) // 8, size=_MOST_SHIFTS))
    chance = [_held_out(regressor, np.roll(Z, s, axis=0), y)[0] for s in shifts]
    p_value = (1.0 + np.sum(np.asarray(chance) >= skill)) / (1.0 + len(chance))
    # no number of shifts that is cheap can show less than one in their number
    if p_value > max(alpha, 1.5 / (1.0 + len(chance))):
        return None
    regressor.fit(Z, y)
    correction = {
        "channel": channel,
        "inputs": names,
        "centre": centre,
        "scale": scale,
        "support": Z,
        "coefficients": np.asarray(regressor.dual_coef_, dtype=float),
        "intercept": float(regressor.intercept_),
        "gamma": float(regressor.gamma),
        "span": float(workbench.spans[channel]),
    }
    matter = _inputs_that_matter(regressor, Z, y, names, skill)
    return Unknown(channel, matter, size, float(skill), float(p_value), correction)


def _acting_rms(predicted):
    size = np.abs(predicted)
    acting = size > 0.25 * np.quantile(size, 0.99)
    return float(np.sqrt(np.mean(predicted[acting] ** 2))) if acting.any() else 0.0


def _held_out(regressor, Z, y):
    edges = np.linspace(0, len(y), _BLOCKS + 1).astype(int)
    predicted = np.empty(len(y))
    for low, high in pairwise(edges):
        train = np.ones(len(y), dtype=bool)
        train[max(low - 3, 0) : high + 3] = False
        regressor.fit(Z[train], y[train])
        predicted[low:high] = regressor.predict(Z[low:high])
    return 1.0 - np.sum((y - predicted) ** 2) / np.sum((y - y.mean()) ** 2), predicted


def _tuned(Z, y):
    """Inputs and LS-SVM that predict held-out blocks best: each input alone, finely, or all, smoothly."""
    d = Z.shape[1]
    trials = [([i], gamma) for i in range(d) for gamma in (1.0, 8.0)]
    trials += [(list(range(d)), gamma) for gamma in (0.1, 0.5, 2.0) if d > 1]
    best = None
    for chosen, gamma in trials:
        regressor = LSSVMRegressor(gamma=gamma, C=10.0)
        skill, predicted = _held_out(regressor, Z[:, chosen], y)
        if best is None or skill > best[2]:
            best = chosen, regressor, skill, predicted
    return best


def _inputs_that_matter(regressor, Z, y, names, skill):
    """Inputs whose loss costs a good part of the skill."""
    if len(names) == 1:
        return names
    lost = []
    for i in range(len(names)):
        without = Z.copy()
        without[:, i] = 0.0
        lost.append(skill - _held_out(regressor, without, y)[0])
    return tuple(n for n, gone in zip(names, lost, strict=True) if gone > 0.2 * skill) or (
        names[int(np.argmax(lost))],
    )
