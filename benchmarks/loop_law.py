# SPDX-License-Identifier: BSD-3-Clause
"""The law of the noise of a drawn loop, as a linear system, and what it leaves unforeseen in every row.

What disturbs a drawn loop is a sum of Gaussian courses, of regular waves whose phase drifts, and of jumps.
All pass through the process and the filter of the sensor, so together they are one linear system driven by
white noise, and Kalman's filter foresees of each row what the rows before tell. Jumps are taken as a random
walk of their variance, a wave by its harmonics.
"""

import numba as nb
import numpy as np
from scipy.linalg import block_diag

#: Harmonics of a wave of size one, and their sizes.
_WAVES = {"sine": {1: 1.0}}
_WAVES["square"] = {h: 4.0 / np.pi / h for h in (1, 3, 5, 7, 9)}
_WAVES["triangle"] = {h: 8.0 / np.pi**2 / h**2 for h in (1, 3, 5)}


def law_of(plant, rounding):
    """The noise as a linear system in steps: transition, spread of what is new, start, and what is seen."""
    noise, lag, follow = plant.noise, plant.process["lag"], plant.process["follow"]
    large = 10.0 * np.ptp(plant.value) ** 2
    blocks, spreads, starts = [], [], []

    def add(block, spread, start):
        blocks.append(block)
        spreads.extend(spread)
        starts.extend(start)

    time, size = noise["load"]
    keep = np.exp(-1.0 / time)
    add([[keep]], [size**2 * (1.0 - keep**2)], [size**2])
    if noise["jumps"]:
        add([[1.0]], [noise["jumps"] ** 2], [large])
    if noise["wave"]:
        shape, period, size, drift = noise["wave"]
        for harmonic, share in _WAVES[shape].items():
            angle, stays = 2.0 * np.pi * harmonic / period, np.exp(-0.5 * (harmonic * drift) ** 2)
            power = 0.5 * (size * share) ** 2
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            add(stays * turn, [power * (1.0 - stays**2)] * 2, [power] * 2)
    loads = len(spreads)
    time, size = noise["colour"]
    keep = np.exp(-1.0 / time)
    add([[keep]], [size**2 * (1.0 - keep**2)], [size**2])
    within = block_diag(*blocks)
    pushes = np.zeros(loads + 1)
    pushes[:loads] = 1.0
    if noise["wave"]:  # a wave is the first of its two states
        behind = 1 + bool(noise["jumps"])
        pushes[behind + 1 : loads : 2] = 0.0
    size = loads + 3  # loads, colour, deviation of the process, deviation of what is seen
    move, new = np.zeros((size, size)), np.zeros((size, size + 1))
    move[: loads + 1, : loads + 1] = within
    new[: loads + 1, : loads + 1] = np.diag(np.sqrt(spreads))
    stay = 1.0 if plant.process["integrates"] else 1.0 - 1.0 / lag
    # the load of the same step moves the process, and its value of the step before is seen
    move[loads + 1] = np.concatenate([-(pushes @ within) / lag, [stay, 0.0]])
    new[loads + 1] = -np.concatenate([pushes, [0.0, 0.0]]) @ new[:size] / lag
    move[loads + 2, loads] = follow * keep
    move[loads + 2, loads + 1], move[loads + 2, loads + 2] = follow, 1.0 - follow
    new[loads + 2, loads] = follow * new[loads, loads]
    new[loads + 2, size] = follow * noise["white"]
    start = np.diag([*starts, large, large])
    return move, new @ new.T, start, max(rounding, 1e-9 * np.ptp(plant.value)) ** 2


def by_rows(law, steps):
    """The same system from row to row."""
    move, new, start, seen = law
    whole, spread = np.eye(len(move)), np.zeros_like(move)
    for _ in range(steps):
        whole, spread = move @ whole, move @ spread @ move.T + new
    return whole, spread, start, seen


@nb.njit(cache=True)
def _gains(move, new, start, seen, n):
    """Gain of Kalman's filter and spread of what is new, in each row; the last state is seen."""
    size = len(move)
    gains, spreads = np.empty((n, size)), np.empty(n)
    before = start.copy()
    for k in range(n):
        spreads[k] = before[-1, -1] + seen
        gains[k] = before[:, -1] / spreads[k]
        after = before - np.outer(gains[k], before[-1])
        before = move @ after @ move.T + new
        before = 0.5 * (before + before.T)
    return gains, spreads


@nb.njit(cache=True)
def _innovations(rows, ahead, move, gains, spreads):
    """What is new in every row of each, over its spread: by `ahead`; the state is corrected by `rows`."""
    out = np.empty(rows.shape)
    size = len(move)
    for g in range(len(rows)):
        state = np.zeros(size)
        for k in range(rows.shape[1]):
            new = rows[g, k] - state[-1]
            out[g, k] = (ahead[g, k] - state[-1]) / np.sqrt(spreads[k])
            state = move @ (state + gains[k] * new)
    return out


def whitened(rows, law, extra=0.0, ahead=None):
    """What is new in every row by a law of noise, over its spread, and the spreads.

    Parameters
    ----------
    rows : ndarray of shape (..., n)
        Value less what the stem explains.
    law : tuple
        As `by_rows` has it.
    extra : float
        Added to the variance of what is seen, in parts of that of a row.
    ahead : ndarray of shape (..., n), optional
        The same with the command of the row as the rows before foresee it.
    """
    move, new, start, seen = law
    gains, spreads = _gains(move, new, start, seen, rows.shape[-1])
    if extra:
        gains, spreads = _gains(move, new, start, seen + extra * float(np.median(spreads)), rows.shape[-1])
    flat = np.ascontiguousarray(rows.reshape(-1, rows.shape[-1]))
    foreseen = flat if ahead is None else np.ascontiguousarray(ahead)
    return _innovations(flat, foreseen, move, gains, spreads).reshape(rows.shape), spreads
