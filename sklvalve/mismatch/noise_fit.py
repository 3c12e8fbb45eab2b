# SPDX-License-Identifier: BSD-3-Clause
"""Noise of a channel, fitted to what a simulation leaves over of it: the likeliest, by derivatives."""

import numba as nb
import numpy as np
from scipy.optimize import Bounds, minimize

from sklvalve.mismatch.noise import NoiseModel

# how far a number may go from where its prior lies, logarithm
_FURTHEST = 12.0
# A fit begins twice. From where a variance is nearly nothing no slope leads away, so once all are felt; and
# where the quick part is begun as large as the white one it may pass for it, so once nearly all is white.
_FELT, _SMALL = 0.1, np.array([1.0, 30.0, 0.3, 0.1, 1.0, 0.1, 1.0])
_VARIANCES = np.array([True, True, True, True, False, True, False])
# whole variance over that of differences from which on the latter are not trusted alone
_STILL = 1e5
_ENOUGH = {"maxiter": 60, "ftol": 1e-7, "gtol": 0.02}


def fit_noise(residuals, simulated, step, *, quantum=0.0, inadequacy=0.0, largest=np.inf, cautious=False):
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

    Returns
    -------
    noise : NoiseModel
    """
    residuals = np.asarray(residuals, dtype=float)
    seen = np.isfinite(residuals)
    # from differences, so that missing physics, which is mostly slow, does not pass for noise
    quick = np.diff(residuals)
    quick = quick[np.isfinite(quick)]
    size = 1.4826 * float(np.median(np.abs(quick))) / np.sqrt(2.0) if len(quick) else 0.0
    size = max(size, quantum / np.sqrt(12.0), 1e-6 * float(np.nanmax(np.abs(simulated))), 1e-12)
    moving = movement(simulated, step) ** 2
    level = np.nan_to_num(np.asarray(simulated, dtype=float) / max(np.nanmax(np.abs(simulated)), 1e-12)) ** 2
    whole = float(np.nanvar(residuals)) / size**2
    bounds, start = _bounds(step, cautious, (largest / size) ** 2, whole)
    own = quantum**2 / 12.0
    unit = np.array([size**2, 1.0, size**2, size**2, 1.0, size**2, 1.0])

    def loss(z):
        base, *others = numbers = unit * np.exp(z)
        total, slope = _loss(residuals, step, moving, level, own + inadequacy**2 + base, *others)
        # weak priors keep parts that are not there from running off
        away = z - start
        return total + away @ away / 50.0, slope * numbers + away / 25.0

    felt = np.where(_VARIANCES, np.maximum(start, np.log(_FELT)), start)
    white = start + np.log(_SMALL)
    # of residuals that mostly stand still, or are mostly not known, the differences tell next to nothing
    wide = [white + np.log(whole) * np.eye(7)[0]] if whole > _STILL else []
    options = {"jac": True, "method": "L-BFGS-B", "bounds": Bounds(*bounds), "options": _ENOUGH}
    fits = [minimize(loss, np.clip(z, *bounds), **options) for z in (felt, white, *wide)]
    base, timing, share, *correlated = unit * np.exp(min(fits, key=lambda each: each.fun).x)
    fast, fast_time, slow, slow_time = correlated
    sensor = own + base + share * level
    white = np.where(seen, sensor + inadequacy**2 + timing * moving, np.inf)
    return NoiseModel(white, step, fast_time, fast, slow_time, slow, float(np.mean(sensor[seen])))


def _bounds(step, cautious, cap, whole):
    """Least and most of the logarithms of a noise's numbers, and where their weak priors lie.

    In units of the quick noise's variance and in seconds: white part, its growth with movement and with the
    signal's size, size and time constant of the quick part and of the wander. `cap` is the most of what is
    correlated, `whole` the residuals' variance.
    """
    dt, length = max(float(np.median(step)), 1e-9), float(np.sum(step))
    most, cap = 1.0 if cautious else np.inf, max(cap, 1e-30)
    numbers = [
        (0.5, 0.0, 3.0 * most),
        # a sample too early or too late is wrong by the movement itself; more is no matter of timing
        (1e-3, 0.0, 0.1 if cautious else 1.0),
        (0.3, 0.0, np.inf),
        (0.2, 0.0, min(most, cap)),
        # no record of this length can tell a slower wander from an offset, nor a quicker one from the rest
        (3.0 * dt, 0.5 * dt, 30.0 * dt),
        (0.05, 0.0, min(0.3 * most, cap)),
        (max(0.03 * length, 60.0 * dt), 40.0 * dt, max(0.25 * length, 80.0 * dt)),
    ]
    begin, low, high = np.array(numbers).T
    start = np.log(begin)
    reach = max(_FURTHEST, np.log(max(whole, 1.0)) + 3.0)
    high = np.minimum(np.log(high), start + np.where(_VARIANCES, reach, _FURTHEST))
    low = np.maximum(np.log(np.maximum(low, 1e-300)), np.minimum(start, high) - _FURTHEST)
    return (low, high), start


def movement(simulated, step, memory=4.5):
    """How fast a simulated signal moves around each row: where errors of timing and response weigh.

    Parameters
    ----------
    simulated, step : ndarray of shape (n,)
    memory : float, default=4.5
        Time constant with which a movement is forgotten [s]; a healthy response is over after a few.
    """
    signal = np.asarray(simulated, dtype=float)
    known = np.isfinite(signal)
    filled = np.interp(np.arange(len(signal)), np.flatnonzero(known), signal[known])
    slope = np.abs(np.diff(filled, prepend=filled[0]))
    ahead = np.append(slope[1:], 0.0)
    return _forgotten(np.maximum(slope, 0.5 * ahead), np.exp(-step / memory))


@nb.njit(cache=True, nogil=True)
def _forgotten(values, keep):
    out = np.empty_like(values)
    held = 0.0
    for k in range(len(values)):
        held = max(values[k], keep[k] * held)
        out[k] = held
    return out


@nb.njit(cache=True, nogil=True, error_model="numpy")
def _loss(residuals, step, moving, level, base, timing, share, fast_size, fast_time, slow_size, slow_time):
    """Negative robust log likelihood of residuals, and its derivatives by the seven numbers of the noise.

    The white variance of a row is ``base + timing moving + share level``. One pass forward keeps what the
    filter knew before each row, one backward carries what the rows behind make of that.
    """
    n = len(residuals)
    known = np.empty((n, 7))
    p11, p12, p22 = fast_size, 0.0, slow_size
    a = b = last = f = s = total = 0.0
    product = 1.0
    for k in range(n):
        if step[k] != last:
            last = step[k]
            a = np.exp(-last / fast_time)
            b = np.exp(-last / slow_time)
        here = known[k]
        here[0], here[1], here[2], here[3], here[4], here[5], here[6] = p11, p12, p22, f, s, a, b
        p11 = a * a * p11 + (1.0 - a * a) * fast_size
        p22 = b * b * p22 + (1.0 - b * b) * slow_size
        p12 = a * b * p12
        f *= a
        s *= b
        e = residuals[k]
        if e != e:
            continue
        to_fast, to_slow = p11 + p12, p12 + p22
        v = to_fast + to_slow + base + share * level[k] + timing * moving[k]
        g1, g2 = to_fast / v, to_slow / v
        left = e - f - s
        f += g1 * left
        s += g2 * left
        total += 9.0 * (np.sqrt(1.0 + left * left / (9.0 * v)) - 1.0)
        # logarithms are dear: of a product of some rows, before it leaves the range of a number
        product *= v
        if product < 1e-200 or product > 1e200:
            total += 0.5 * np.log(product)
            product = 1.0
        p11 -= g1 * to_fast
        p12 -= g1 * to_slow
        p22 -= g2 * to_slow
    slope = np.zeros(7)
    of_11 = of_12 = of_22 = of_f = of_s = 0.0
    for k in range(n - 1, -1, -1):
        here = known[k]
        p11, p12, p22, f, s, a, b = here[0], here[1], here[2], here[3], here[4], here[5], here[6]
        e = residuals[k]
        if e == e:
            ahead_11 = a * a * p11 + (1.0 - a * a) * fast_size
            ahead_22 = b * b * p22 + (1.0 - b * b) * slow_size
            ahead_12 = a * b * p12
            to_fast, to_slow = ahead_11 + ahead_12, ahead_12 + ahead_22
            u = 1.0 / (to_fast + to_slow + base + share * level[k] + timing * moving[k])
            g1, g2 = to_fast * u, to_slow * u
            left = e - a * f - b * s
            robust = left * u / np.sqrt(1.0 + left * left * u * (1.0 / 9.0))
            of_left = g1 * of_f + g2 * of_s + robust
            of_fast = left * u * of_f - 2.0 * g1 * of_11 - g2 * of_12
            of_slow = left * u * of_s - g1 * of_12 - 2.0 * g2 * of_22
            of_v = g1 * (g1 * of_11 + g2 * of_12) + g2 * g2 * of_22 - left * u * (g1 * of_f + g2 * of_s)
            of_v += 0.5 * (u - left * robust * u)
            slope[0] += of_v
            slope[2] += of_v * level[k]
            slope[1] += of_v * moving[k]
            of_11 += of_fast + of_v
            of_12 += of_fast + of_slow + 2.0 * of_v
            of_22 += of_slow + of_v
            of_f -= of_left
            of_s -= of_left
        of_a = 2.0 * a * (p11 - fast_size) * of_11 + b * p12 * of_12 + f * of_f
        of_b = 2.0 * b * (p22 - slow_size) * of_22 + a * p12 * of_12 + s * of_s
        slope[4] += of_a * a * step[k]
        slope[3] += (1.0 - a * a) * of_11
        slope[6] += of_b * b * step[k]
        slope[5] += (1.0 - b * b) * of_22
        of_11 *= a * a
        of_12 *= a * b
        of_22 *= b * b
        of_f *= a
        of_s *= b
    slope[4] /= fast_time * fast_time
    slope[6] /= slow_time * slow_time
    slope[3] += of_11
    slope[5] += of_22
    return total + 0.5 * np.log(product), slope
