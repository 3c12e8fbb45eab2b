# SPDX-License-Identifier: BSD-3-Clause
"""The fused pass behind `rate_liquid`: rows go through all stages in blocks that stay in the nearest cache.

The compiled code is kept on disk under the date of this file alone: after a change in one of the files it
calls, this one needs a new date too.
"""

import numpy as np

from sklvalve.mechanism._constants import MM, N18
from sklvalve.mechanism._rating_stages import (
    BLOCK,
    BOIL,
    CRITICAL_TEMPERATURE,
    FD,
    FL,
    FLOW,
    FREEZING,
    INLET,
    KV,
    NU,
    OUTLET,
    P1,
    P2,
    PLACE,
    PV,
    RATED,
    RHO,
    ROW,
    SIZE,
    VISCOSITY_LIMIT,
    WORK,
    T,
    boiling,
    compiled,
    keep_fast,
    literal,
    no_pipes,
    pipes,
    reduce,
    reynolds,
    smaller,
    transitional,
    turbulent,
    turn_fast,
    water,
    water_viscosity,
)

# what is counted
TROUBLES = ("temperature", "cold", "boils", "kv", "density", "viscosity", "wide", "lost")


@compiled
def _load(flat, steps, shape, first, many, w, at):
    """Copy `many` values of a broadcast array, from flat position `first` on, into the work array."""
    last = len(shape) - 1
    inner, step = shape[last], steps[last]
    outer, column = first // inner, first % inner
    done = 0
    while done < many:
        position = column * step
        rest = outer
        for axis in range(last - 1, -1, -1):
            position += (rest % shape[axis]) * steps[axis]
            rest //= shape[axis]
        run = min(many - done, inner - column)
        if step == 1:
            for k in range(run):
                w[at + done + k] = flat[position + k]
        else:
            for k in range(run):
                w[at + done + k] = flat[position + k * step]
        done += run
        outer += 1
        column = 0


@compiled
def _count_lost(w, n, choking, counts):
    """Rows without a flow, though a valve without pipes and viscosity would have one."""
    for i in range(n):
        p1, p2, kv = w[P1 + i], w[P2 + i], w[KV + i]
        entering = (p1 if p1 > p2 else p2) > (w[BOIL + i] if choking else -np.inf)
        known = (kv == kv) & (p1 == p1) & (p2 == p2) & (w[RHO + i] > 0.0) & (w[NU + i] > 0.0)
        known &= (w[FL + i] > 0.0) & (w[FD + i] > 0.0) & ((w[RATED + i] > 0.0) | (w[RATED + i] == kv))
        known &= (w[SIZE + i] > 0.0) & (w[INLET + i] > 0.0) & (w[OUTLET + i] > 0.0)
        counts[7] += (w[FLOW + i] != w[FLOW + i]) & entering & known


@compiled
def _count(w, n, of_water, choking, piping, viscous, counts):
    for i in range(n):
        counts[3] += w[KV + i] < 0.0
        counts[4] += w[RHO + i] <= 0.0
    if of_water:
        for i in range(n):
            counts[0] += (w[T + i] < FREEZING) | (w[T + i] > CRITICAL_TEMPERATURE)
    if choking:
        for i in range(n):
            counts[2] += (w[P1 + i] <= w[PV + i]) & (w[P2 + i] <= w[PV + i])
    if viscous:
        for i in range(n):
            counts[5] += w[NU + i] <= 0.0
        if of_water:
            for i in range(n):
                counts[1] += (w[T + i] < FREEZING) | (w[T + i] > VISCOSITY_LIMIT)
    if piping or viscous:
        for i in range(n):
            size = MM * w[SIZE + i]
            counts[6] += abs(w[KV + i]) > 0.047 * N18 * size * size
        _count_lost(w, n, choking, counts)


@compiled
def rate(first, end, shape, inputs, steps, wanted, out, counts, of_water, choking, piping, viscous, strict):
    """Rate the rows from `first` to `end`.

    Parameters
    ----------
    first, end : int
        Flat positions in the broadcast shape.
    shape : ndarray of shape (n_axes,)
        The broadcast shape.
    inputs : tuple of ndarrays
        Flat memory of each of `INPUTS`; empty where it is not given.
    steps : ndarray of shape (n_inputs, n_axes)
        How far the next element along an axis lies in it.
    wanted : ndarray of shape (n_outputs,)
        Which of `OUTPUTS` to write.
    out : ndarray of shape (n_outputs, n)
        Where to.
    counts : ndarray of shape (n_troubles,)
        Gains the number of rows with each of `TROUBLES`.
    of_water, choking, piping, viscous, strict : bool
        Properties by temperature instead of read ones; choking; reducers; viscosity, by the letter.
    """
    w = np.ones(WORK)
    # what is the same for all rows is read once
    moving = np.array([np.any(steps[k]) for k in range(len(inputs))])
    for start in range(first, end, BLOCK):
        n = min(BLOCK, end - start)
        for k in range(len(inputs)):
            if len(inputs[k]) and (start == first or moving[k]):
                _load(inputs[k], steps[k], shape, start, n, w, k * ROW)
        if of_water:
            if start == first or moving[3]:
                water(w, n)
                if viscous:
                    water_viscosity(w, n)
        elif choking:
            boiling(w, n)
        if piping:
            pipes(w, n, choking)
        else:
            no_pipes(w, n)
        turbulent(w, n, choking)
        if viscous:
            reynolds(w, n, strict)
            bare = strict and piping
            if bare:
                keep_fast(w, n)
                no_pipes(w, n)
                turbulent(w, n, choking)
                reynolds(w, n, strict)
            transitional(w, n)
            if strict:
                literal(w, n)
            else:
                smaller(w, n)
            reduce(w, n)
            if bare:
                turn_fast(w, n)
        _count(w, n, of_water, choking, piping, viscous, counts)
        for k in range(len(wanted)):
            at = PLACE[wanted[k]]
            for i in range(n):
                out[k, start + i] = w[at + i]
