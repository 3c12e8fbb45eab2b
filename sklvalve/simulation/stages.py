# SPDX-License-Identifier: BSD-3-Clause
"""Stages of the chain that remember: each scans along time, compiled."""

from math import exp

import numba as nb
import numpy as np

# a positioner's swing after a stroke is over in about this time [s]
_SWING = 1.0
# a step of the clock so many times as long as the one before is a jump: samples are missing
_JUMP = 3.0


@nb.njit(cache=True, nogil=True)
def play(inside, width):
    """Play between two parts: the outer one follows when the gap is used up.

    Parameters
    ----------
    inside : ndarray of shape (n,)
        Movement of the driving part [1].
    width : float
        Whole gap [1].

    Returns
    -------
    outside : ndarray of shape (n,)
        Movement of the driven part, in the middle of its gap at the beginning [1].
    """
    half = 0.5 * width
    out = np.empty_like(inside)
    y = np.nan
    for k in range(len(inside)):
        v = inside[k]
        if v == v:
            if y != y:
                y = v
            y = min(max(y, v - half), v + half)
            out[k] = y
        else:
            out[k] = np.nan
    return out


@nb.njit(cache=True, nogil=True)
def play_with_overshoot(inside, step, width, overshoot, first_side):
    """Play whose driving part swings beyond its samples after a stroke.

    Parameters
    ----------
    inside, step : ndarray of shape (n,)
        Recorded movement of the driving part [1], and time since the sample before [s]. What moved in a gap
        (NaN) or in a jump of the clock moved all the time.
    width : float
        Whole gap [1].
    overshoot : float
        How far the driving part goes beyond where it is next seen, share of the movement just made [1].
    first_side : float
        Where in its gap the driven part stands at the beginning, -1 to 1 [1].

    Returns
    -------
    outside : ndarray of shape (n,)
        Movement of the driven part [1].
    """
    half = 0.5 * width
    out = np.empty_like(inside)
    y = np.nan
    before = moved = passed = 0.0
    for k in range(len(inside)):
        v = inside[k]
        passed += step[k]
        if v != v:
            out[k] = np.nan
            continue
        if y != y:
            y = v + half * first_side
            before = v
        keep = exp(-passed / _SWING)
        if passed > step[k] or (k > 0 and passed > _JUMP * step[k - 1]):
            moved = moved * keep + (v - before) * (1.0 - keep) * _SWING / passed
        else:
            moved = moved * keep + v - before
        before, passed = v, 0.0
        peak = v + overshoot * moved
        y = min(max(y, peak - half), peak + half)
        y = min(max(y, v - half), v + half)
        out[k] = y
    return out


@nb.njit(cache=True, nogil=True)
def first_order_lag(values, step, time_constant, ahead):
    """First-order lag of a sampled signal.

    Parameters
    ----------
    values : ndarray of shape (n,)
        What the sensor sees. Gaps (NaN) stay gaps; over one, or where the clock jumps, it went straight from
        the value before to the one after.
    step : ndarray of shape (n,)
        Time since the sample before [s].
    time_constant : float
        Time constant [s].
    ahead : float
        How much of a step between two samples has taken place by the time of the second: 1 it jumped right
        after the first, 0 right before the second.

    Returns
    -------
    lagged : ndarray of shape (n,)
    """
    out = np.empty_like(values)
    y = before = last = np.nan
    keep = passed = 0.0
    for k in range(len(values)):
        v = values[k]
        passed += step[k]
        if v != v:
            out[k] = np.nan
            continue
        if y != y:
            y = v
        else:
            if passed != last:
                last = passed
                keep = exp(-last / time_constant) if time_constant > 0.0 else 0.0
            if passed > step[k] or passed > _JUMP * step[k - 1]:
                behind = (v - before) / passed * time_constant
                y = v - behind + keep * (y - before + behind)
            else:
                seen = ahead * v + (1.0 - ahead) * before
                y = keep * y + (1.0 - keep) * seen
        before, passed = v, 0.0
        out[k] = y
    return out


@nb.njit(cache=True, nogil=True)
def limited_rate(values, step, up, down):
    """Signal that follows another one no faster than `up` and `down` [1/s].

    In gaps (NaN) it holds; behind one it has had the time of the gap as well.
    """
    out = np.empty_like(values)
    y, passed = np.nan, 0.0
    for k in range(len(values)):
        v = values[k]
        passed += step[k]
        if v == v:
            y = v if y != y else min(max(v, y - down * passed), y + up * passed)
            passed = 0.0
        out[k] = y
    return out


@nb.njit(cache=True, nogil=True)
def from_table(at, grid, table):
    """Linear interpolation in a table over even steps: `numpy.interp` to the last digit, and quicker.

    Parameters
    ----------
    at : ndarray of shape (n,)
        Gaps (NaN) stay gaps; beyond the ends those of the table hold.
    grid, table : ndarray of shape (m,)
        Even steps, and the values there.

    Returns
    -------
    found : ndarray of shape (n,)
    """
    out, last = np.empty_like(at), len(grid) - 1
    slopes, steps = np.empty(last), last / (grid[last] - grid[0])
    for j in range(last):
        slopes[j] = (table[j + 1] - table[j]) / (grid[j + 1] - grid[j])
    for k in range(len(at)):
        v = at[k]
        if grid[0] < v < grid[last]:
            # a number that cannot be negative needs no look at the end of the table
            j = np.uint32((v - grid[0]) * steps)
            j = min(j, np.uint32(last - 1))
            # the end of a step may be rounded either way
            if v < grid[j]:
                j = np.uint32(j - 1)
            elif v >= grid[j + 1]:
                j = np.uint32(j + 1)
            out[k] = slopes[j] * (v - grid[j]) + table[j]
        elif v >= grid[last]:
            out[k] = table[last]
        else:
            out[k] = table[0] if v == v else v
    return out


def delayed(values, time, dead_time):
    """Signal as it was `dead_time` [s] ago, linear between samples; the first value holds before the first.

    Parameters
    ----------
    values, time : ndarray of shape (n,)
        Signal, and its times [s].
    dead_time : float
        Delay [s].
    """
    known = np.isfinite(values)
    if dead_time <= 0.0 or not known.any():
        return values
    return np.interp(time - dead_time, time[known], values[known])


def choked_drop(drop, span, fl, knee):
    """Pressure drop that drives a flow: a choked one passes no more for a larger drop, by a soft corner.

    Parameters
    ----------
    drop, span : ndarray of shape (n,)
        Drop, either way, and p1 - FF pv [Pa].
    fl, knee : ndarray of shape (n,)
        Pressure recovery factor, infinite where nothing chokes, and hardness of the corner [1].

    Returns
    -------
    driving : ndarray of shape (n,)
        Its size [Pa].
    """
    size = np.abs(drop)
    # by logarithms, which numpy takes of many numbers at once: five times as fast as powers one by one
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        most = np.where(fl < np.inf, np.maximum(fl * fl * span, 1.0), np.inf)
        steep = knee * np.log(size / most)
        return size * np.exp(-np.maximum(np.log(1.0 + np.exp(steep)), steep) / knee)
