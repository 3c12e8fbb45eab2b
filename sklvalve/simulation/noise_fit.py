# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a channel fitted to residuals, by the likelihood of its state-space model."""

from __future__ import annotations

import numba as nb
import numpy as np

from sklvalve.simulation.noise import NoiseModel, NoiseParts, movement

# passes of a fit at most, and within how much of all parts and of the likelihood it ends
_PASSES, _NEAR, _FLAT = 500, 0.03, 0.2
# of more rows with a value than these (a day and a half at 1 Hz) so many serve, in blocks spread over all:
# seven numbers are known from them as well, and a block is longer than most wander lasts
_MOST_ROWS, _BLOCK = 131_072, 4_096
# the first simplex: each logarithm times this, and one of zero
_FIRST_STEP, _FIRST_OF_ZERO = 1.05, 0.00025


@nb.njit(cache=True, nogil=True, fastmath={"contract"})
def _loss(
    residuals: np.ndarray,
    step: np.ndarray,
    base: float,
    share: float,
    level: np.ndarray,
    timing: float,
    moving: np.ndarray,
    fast_time: float,
    fast_size: float,
    slow_time: float,
    slow_size: float,
) -> float:
    """Negative robust log likelihood of residuals, in one pass: gains, innovations and their spreads.

    The white variance of a row is ``base + share level + timing moving``. What one row asks of the row before
    is kept short: that chain, and nothing else, is what a pass takes its time for.
    """
    p11, p12, p22 = fast_size, 0.0, slow_size
    a = b = last = f = s = total = 0.0
    aa = ab = bb = added_fast = added_slow = 0.0
    product = 1.0
    for k in range(len(residuals)):
        if step[k] != last:
            last = step[k]
            a = np.exp(-last / fast_time)
            b = np.exp(-last / slow_time)
            aa, ab, bb = a * a, a * b, b * b
            added_fast, added_slow = (1.0 - aa) * fast_size, (1.0 - bb) * slow_size
        white = base + share * level[k] + timing * moving[k]
        v = (aa * p11 + (added_fast + added_slow + white)) + (bb * p22 + 2.0 * (ab * p12))
        p11 = aa * p11 + added_fast
        p22 = bb * p22 + added_slow
        p12 = ab * p12
        f *= a
        s *= b
        e = residuals[k]
        if e != e:
            continue
        of_fast, of_slow, inverse = p11 + p12, p12 + p22, 1.0 / v
        left = e - f - s
        f += of_fast * inverse * left
        s += of_slow * inverse * left
        total += np.sqrt(1.0 + left * left * inverse * (1.0 / 9.0)) - 1.0
        # logarithms are dear: of a product of some rows, before it leaves the range of a number
        product *= v
        if product < 1e-200 or product > 1e200:
            total += (0.5 / 9.0) * np.log(product)
            product = 1.0
        p11 -= of_fast * of_fast * inverse
        p12 -= of_fast * of_slow * inverse
        p22 -= of_slow * of_slow * inverse
    return 9.0 * total + 0.5 * np.log(product)


@nb.njit(cache=True, nogil=True)
def _parts(
    shares: np.ndarray,
    unit: float,
    finest: float,
    largest_share: float,
    cautious: bool,
    timing_least: float,
    dt: float,
    length: float,
) -> tuple[float, ...]:
    """Variances and correlation times of the parts, within their bounds, for shares of the quick noise."""
    base, timing, share = shares[0], shares[1], shares[2]
    fast, fast_time, slow, slow_time = shares[3], shares[4], shares[5], shares[6]
    most = 1.0 if cautious else np.inf
    fast = min(fast, most, largest_share)
    slow = min(slow, 0.3 * most, largest_share)
    base = min(base, 3.0 * most)
    # a sample too early or too late is wrong by the movement itself; more is no matter of timing
    timing = max(min(timing, 0.1 if cautious else 1.0), timing_least)
    # no record of this length can tell a slower wander from an offset, nor a quicker one from the rest
    fast_time = min(max(fast_time, 0.5 * dt), 30.0 * dt)
    slow_time = min(max(slow_time, 40.0 * dt), max(0.25 * length, 80.0 * dt))
    sensor = finest + base * unit
    return sensor, share * unit, timing, fast_time, fast * unit, slow_time, slow * unit


@nb.njit(cache=True, nogil=True)
def _cost(logarithms: np.ndarray, problem: tuple) -> float:
    """Negative log likelihood of residuals and priors, for logarithms of the parts' shares.

    `problem` is where the priors stand, the bounds of `_parts`, the variance of the inadequacy, and what
    `_loss` takes: residuals, steps, level and movement.
    """
    start, bounds, inadequacy, residuals, step, level, moving = problem
    sensor, share, timing, fast_time, fast, slow_time, slow = _parts(np.exp(logarithms), *bounds)
    # weak priors keep parts that are not there from running off
    prior = np.sum((logarithms - start) ** 2) / 50.0
    base = sensor + inadequacy
    left = _loss(residuals, step, base, share, level, timing, moving, fast_time, fast, slow_time, slow)
    return prior + left


@nb.njit(cache=True, nogil=True)
def _by_simplex(problem: tuple) -> np.ndarray:
    """Logarithms of the shares that cost least, by a simplex from where the priors stand."""
    start = problem[0]
    n = len(start)
    corners, costs, passes = np.empty((n + 1, n)), np.empty(n + 1), n + 1
    for k in range(n + 1):
        corners[k] = start
        if k > 0:
            corners[k, k - 1] = _FIRST_STEP * start[k - 1] if start[k - 1] != 0.0 else _FIRST_OF_ZERO
        costs[k] = _cost(corners[k], problem)
    while True:
        # stable, as that of numpy is for so few
        order = np.argsort(costs, kind="mergesort")
        corners, costs = corners[order], costs[order]
        near = np.max(np.abs(corners[1:] - corners[0])) <= _NEAR
        if passes >= _PASSES or (near and np.max(np.abs(costs[0] - costs[1:])) <= _FLAT):
            return corners[0]
        passes = _moved(corners, costs, passes, problem)


@nb.njit(cache=True, nogil=True)
def _moved(corners: np.ndarray, costs: np.ndarray, passes: int, problem: tuple) -> int:
    """Move the worst corner through the middle of the others, or all towards the best, in place."""
    n = len(corners) - 1
    middle = np.zeros(n)
    for k in range(n):
        middle += corners[k]
    middle /= n
    far, near = 1.0 + 2.0 / n, 0.75 - 1.0 / (2.0 * n)
    worst = corners[n].copy()
    mirrored = 2.0 * middle - worst
    cost = _cost(mirrored, problem)
    passes += 1
    if costs[0] <= cost < costs[n - 1]:
        corners[n], costs[n] = mirrored, cost
        return passes
    if passes >= _PASSES:
        return passes
    if cost < costs[0]:
        other, least, keeps = (1.0 + far) * middle - far * worst, cost, True
    elif cost < costs[n]:
        other, least, keeps = (1.0 + near) * middle - near * worst, cost, False
    else:
        other, least, keeps = (1.0 - near) * middle + near * worst, costs[n], False
    moved = _cost(other, problem)
    passes += 1
    if moved < least or (moved == least and costs[0] <= cost < costs[n]):
        corners[n], costs[n] = other, moved
    elif keeps:
        corners[n], costs[n] = mirrored, cost
    else:
        for k in range(1, n + 1):
            if passes >= _PASSES:
                break
            corners[k] = corners[0] + (1.0 - 1.0 / n) * (corners[k] - corners[0])
            costs[k] = _cost(corners[k], problem)
            passes += 1
    return passes


def fit_noise(
    residuals: np.ndarray,
    simulated: np.ndarray,
    step: np.ndarray,
    *,
    quantum: float = 0.0,
    inadequacy: float = 0.0,
    largest: float = np.inf,
    cautious: bool = False,
    timing: float = 0.0,
) -> NoiseModel:
    """Noise model of residuals, by maximum likelihood.

    Parameters
    ----------
    residuals : ndarray of shape (n,)
        Recorded minus simulated; NaN in gaps.
    simulated : ndarray of shape (n,)
        The simulated signal: the white part may grow with its movement and with its size.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    quantum : float, default=0.0
        Resolution of the recorded signal; its variance is a floor of the white part.
    inadequacy : float, default=0.0
        Standard deviation of what a healthy simulation gets wrong; it keeps a very quiet sensor from making
        a giant of every small error.
    largest : float, default=inf
        Largest standard deviation of a correlated part: what is larger is no noise of a sensor.
    cautious : bool, default=False
        Hold the wander to the size of the quick noise. For residuals that may still hold missing physics,
        which a free wander would take up.
    timing : float, default=0.0
        Least variance of errors of timing, share of the square of the movement from row to row [1].

    Returns
    -------
    noise : NoiseModel

    Notes
    -----
    Of more than 131,072 rows with a value blocks of so many serve, with the time that lies between them.
    By an adaptive simplex [1]_, compiled: `scipy.optimize.minimize` makes the same steps to the last bit, and
    spends as long beside the likelihood as in it, a fifteenth of a diagnosis.

    References
    ----------
    .. [1] Gao, F., L. Han, Implementing the Nelder-Mead simplex algorithm with adaptive parameters, Comput.
       Optim. Appl. 51 (2012) 259.
    """
    residuals = np.asarray(residuals, dtype=float)
    size = quick_size(residuals, simulated, quantum)
    largest_share = (largest / size) ** 2
    # the square of the signal, as share of its largest
    peak = max(float(np.nanmax(np.abs(simulated))), 1e-3 * size)
    moving, level = movement(simulated, step) ** 2, np.nan_to_num(np.asarray(simulated) / peak) ** 2
    length = float(np.sum(step))
    dt = float(np.median(step))
    bounds = (
        float(size**2),
        float(quantum**2 / 12.0),
        float(largest_share),
        bool(cautious),
        float(timing),
        dt,
        length,
    )

    start = np.log([0.5, 1e-3, 0.3, 0.2, 3.0 * dt, 0.05, max(0.03 * length, 60.0 * dt)])
    asked = residuals, step, level, moving
    if np.isfinite(residuals).sum() > _MOST_ROWS:
        rows = _spread_rows(np.flatnonzero(np.isfinite(residuals)))
        # the time since the row before that is kept: what is left out is a gap
        since = np.diff(np.cumsum(step)[rows], prepend=0.0)
        asked = residuals[rows], since, level[rows], moving[rows]
    best = _by_simplex((start, bounds, float(inadequacy**2), *asked))
    base, share, timing, fast_time, fast, slow_time, slow = _parts(np.exp(best), *bounds)
    parts = NoiseParts(base, share, peak, timing, fast_time, fast, slow_time, slow, size, float(inadequacy))
    return parts.model(np.isfinite(residuals), simulated, step)


def _spread_rows(rows: np.ndarray) -> np.ndarray:
    """Blocks of rows, `_MOST_ROWS` in all, spread evenly over more of them."""
    first = np.linspace(0, len(rows) - _BLOCK, _MOST_ROWS // _BLOCK).astype(int)
    return rows[(first[:, None] + np.arange(_BLOCK)).ravel()]


def quick_size(residuals: np.ndarray, simulated: np.ndarray, quantum: float) -> float:
    """Standard deviation of the quick noise.

    From differences, so that missing physics, which is mostly slow, does not pass for noise.

    Parameters
    ----------
    residuals, simulated, quantum
        As `fit_noise` takes them.
    """
    quick = np.diff(residuals)
    quick = quick[np.isfinite(quick)]
    size = 1.4826 * float(np.median(np.abs(quick))) / np.sqrt(2.0) if len(quick) else 0.0
    return max(size, quantum / np.sqrt(12.0), 1e-6 * float(np.nanmax(np.abs(simulated))), 1e-12)
