# SPDX-License-Identifier: BSD-3-Clause
"""A smooth pattern without an equation, beside a hypothesis: how likely the history's noise lets it be.

What only imitates a missing effect leaves such a pattern. It competes with there being none by evidence.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, cast

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.special import expit, logsumexp
from sklearn.kernel_approximation import Nystroem

from sklvalve.mismatch.constants import SHARE_WRONG
from sklvalve.mismatch.residual.low_pass_residual import static_inputs
from sklvalve.mismatch.residual.since_history import FURTHEST, rows_known
from sklvalve.recording.gaps import filled
from sklvalve.simulation.calibration import drop_is_unknown
from sklvalve.simulation.rest import input_words

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.simulation.noise import NoiseModel

# length scales over time, share of all rows, and over signals, in their standard deviations
_OVER_TIME, _OVER_SIGNALS = (0.03, 0.1, 0.3), (0.4, 1.0)
# points that a Gaussian process is spanned by, and the fewest rows that tell one
_POINTS, _FEWEST = 25, 100
# share of the recording in which a simulation settles: what went before is not known
_SETTLING = 0.05
# the largest amplitude, in multiples of what counts or is explained; the smallest is a healthy valve's
_LARGEST = 4.0
_WORDS = {"dp": "pressure drop"}


@dataclass(frozen=True)
class Pattern:
    """A smooth pattern in what a hypothesis leaves over of a channel.

    Attributes
    ----------
    channel : str
    inputs : tuple of str
        Signals that it is likeliest a function of; none of one that is a function of time.
    size : float
        Its rms, share of span [1].
    log_odds : float
        Logarithm of the odds that there is one beyond what the simulation of the effects gets wrong.
    """

    channel: str
    inputs: tuple[str, ...]
    size: float
    log_odds: float

    @property
    def over(self) -> str:
        """What it is a function of, in words."""
        return " and ".join(_WORDS.get(name, input_words(name)) for name in self.inputs) or "time"

    @property
    def posterior(self) -> float:
        """Posterior probability of one, at even odds before [1]."""
        return float(expit(self.log_odds))


def pattern_left(problem: Problem, model: Model, channels: Collection[str]) -> Pattern | None:
    r"""The likeliest smooth pattern that a hypothesis leaves over in some channels since the history.

    The residual w, whitened by the history's noise, is held against Gaussian processes of time, of each
    signal that drives the channel, and of these together, spanned by a few points (Nystroem). With
    :math:`\Phi` their whitened features and s an amplitude the evidence is that of

    .. math:: w \sim N(0, I + D D^T + s^2 \Phi \Phi^T)

    D holds what a simulation gets wrong anyway, in two parts by the same features: the share (`SHARE_WRONG`)
    of what the effects change on the whole, with the share of the span by which a healthy valve may respond
    otherwise (`Allowance.response`), and the same share of what they change more nearby. The odds are those
    of all amplitudes s, on the average, to none. Rows count that are where the history has been. Validity:
    calibration and effects are held at their optimum, so the odds are a lower bound where the noise is the
    history's. Source: Kennedy and O'Hagan (2001) on model discrepancy.

    Parameters
    ----------
    problem : Problem
        With a history.
    model : Model
        Fitted for the least error.
    channels : collection of str
        Those that are looked at.

    Returns
    -------
    pattern : Pattern or None
        That of the highest odds; None without a history, where too few rows are known, or where nothing
        tells the pressure drop that a flow comes of.
    """
    if problem.history is None:
        return None
    # a search may have learnt the noise from this very residual
    problem = problem.with_noise_of(model, cautious=True)
    bare = problem.baseline(model, (), model) if model.terms else model
    seen = (_in_channel(problem, model, bare, c) for c in problem.channels if c in channels)
    return max((p for p in seen if p is not None), key=lambda p: p.log_odds, default=None)


def _in_channel(problem: Problem, model: Model, bare: Model, channel: str) -> Pattern | None:
    """The likeliest pattern in one channel; `bare` is the hypothesis without its effects."""
    if channel == "flow" and drop_is_unknown(problem.recording):
        return None
    left, noise = problem.residuals(model)[channel], problem.noise[channel]
    spans = [(low, high) for low, high, *_ in noise.pieces]
    settled = np.concatenate([np.arange(high - low) >= _SETTLING * (high - low) for low, high in spans])
    seen = np.isfinite(left) & settled
    rows = rows_known(problem, channel) & seen
    if rows.sum() < _FEWEST:
        return None
    changed = np.where(seen, model.predictions[channel] - bare.predictions[channel], 0.0)
    counts = problem.least(channel) * problem.spans[channel]
    healthy = cast("ValveHistory", problem.history).allowed.response * problem.spans[channel]
    explained = _rms(changed[rows])
    # an equation is wrong on the whole where its curve and the true one cross, and beyond that, by itself,
    # where it changes much
    nearby = np.concatenate([_nearby(changed[low:high]) for low, high in spans])
    beyond = SHARE_WRONG * np.sqrt(np.maximum(nearby**2 - explained**2, 0.0))[:, None]
    on_the_whole = np.hypot(healthy, SHARE_WRONG * explained)
    amplitudes = np.append(0.0, _amplitudes(healthy, max(counts, explained)))
    white = partial(_whitened, noise=noise.without(~settled), seen=seen, rows=rows)
    w = np.clip(white(left[:, None])[:, 0], -FURTHEST, FURTHEST)
    none, some, met = [], [], []
    for inputs, features in _processes(static_inputs(model.chain, model.values, channel), len(left)):
        free = white(features)
        wrong = np.hstack([on_the_whole * free, white(beyond * features)])
        log_z, weights = _evidence(free, wrong, w, amplitudes)
        none.append(log_z[0])
        some += list(log_z[1:])
        k = 1 + int(np.argmax(log_z[1:]))
        met.append((log_z[k], inputs, _rms(features[rows] @ weights[k]) / problem.spans[channel]))
    _, inputs, size = max(met)
    return Pattern(channel, inputs, size, _log_mean(some) - _log_mean(none))


def _nearby(changed: np.ndarray) -> np.ndarray:
    """How much effects change around each row: a response that comes late is wrong to either side of it."""
    squares = uniform_filter1d(changed**2, max(int(_OVER_TIME[0] * len(changed)), 1))
    # a running sum may end a rounding error below zero
    return np.sqrt(np.maximum(squares, 0.0))


def _amplitudes(smallest: float, usual: float) -> np.ndarray:
    """Amplitudes of a pattern, each twice the one before."""
    many = np.log2(_LARGEST * usual / smallest)
    return smallest * 2.0 ** np.arange(max(int(np.ceil(many)), 0) + 1)


def _processes(inputs: dict[str, np.ndarray], many: int) -> Iterator[tuple[tuple[str, ...], np.ndarray]]:
    """Names of the inputs of each Gaussian process, and its features, of shape (rows, points)."""
    time = np.linspace(0.0, 1.0, many)[:, None]
    for length in _OVER_TIME:
        yield (), _features(time, length)
    names = tuple(inputs)
    if not names:
        return
    X = np.column_stack([_standard(values) for values in inputs.values()])
    for length in _OVER_SIGNALS:
        for i, name in enumerate(names):
            yield (name,), _features(X[:, [i]], length)
    if len(names) > 1:
        yield names[:2], _features(X[:, :2], 1.0)
    if len(names) > 2:
        yield names, _features(X, float(np.sqrt(len(names))))


def _features(X: np.ndarray, length: float) -> np.ndarray:
    """Features of a Gaussian process of variance 1 whose kernel has this length scale."""
    points = min(_POINTS, len(X))
    return Nystroem(gamma=0.5 / length**2, n_components=points, random_state=0).fit_transform(X)


def _standard(values: np.ndarray) -> np.ndarray:
    """Values without gaps, of mean 0 and variance 1."""
    values = filled(values)
    return (values - values.mean()) / max(float(values.std()), 1e-12)


def _whitened(columns: np.ndarray, noise: NoiseModel, seen: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Columns that have passed the filter which makes noise white, zero in rows that do not count."""
    whitened = np.zeros(columns.shape)
    for k, column in enumerate(columns.T):
        whitened[rows, k] = noise.whiten(np.where(seen, column, np.nan))[rows]
    return whitened


def _evidence(
    free: np.ndarray, wrong: np.ndarray, white: np.ndarray, amplitudes: np.ndarray
) -> tuple[np.ndarray, list[np.ndarray]]:
    """Log evidence of a pattern of each amplitude on white noise alone, and its weights' posterior means.

    What the effects get wrong has weights of its own, of variance 1, and is there whatever the amplitude.
    """
    gram = np.eye(wrong.shape[1]) + wrong.T @ wrong
    across, projected = free.T @ wrong, wrong.T @ white
    solved = np.linalg.solve(gram, np.column_stack([across.T, projected]))
    shared = 0.5 * projected @ solved[:, -1] - 0.5 * np.linalg.slogdet(gram)[1]
    values, vectors = np.linalg.eigh(free.T @ free - across @ solved[:, :-1])
    values, along = np.maximum(values, 0.0), vectors.T @ (free.T @ white - across @ solved[:, -1])
    shrunk = [along * s**2 / (1.0 + s**2 * values) for s in amplitudes]
    log_z = [
        shared + 0.5 * along @ each - 0.5 * np.sum(np.log1p(s**2 * values))
        for s, each in zip(amplitudes, shrunk, strict=True)
    ]
    return np.array(log_z), [vectors @ each for each in shrunk]


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _log_mean(values: list[float]) -> float:
    return float(logsumexp(values) - np.log(len(values)))
