# SPDX-License-Identifier: BSD-3-Clause
"""The fused pass behind `rate_liquid`: all stages, in blocks that stay in the nearest cache."""

import hashlib
from pathlib import Path

import numba as nb
import numpy as np

from sklvalve.mechanism._constants import CRITICAL_TEMPERATURE, FREEZING, MM, VISCOSITY_LIMIT, WIDEST
from sklvalve.mechanism._rating_stages import (
    BLOCK,
    BOIL,
    FD,
    FL,
    FLOW,
    INLET,
    KV,
    MARK,
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
from sklvalve.mechanism._vector_math import FAST

# what is counted
TROUBLES = ("temperature", "cold", "boils", "kv", "density", "viscosity", "wide", "lost", "senseless")

# all files whose code or numbers end up in the compiled pass
SOURCES = ("_constants.py", "_vector_math.py", "_rating_stages.py", "_rating_kernel.py")


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
def _screen_pressures(w, n):
    """NaN for pressures below zero; the rows are marked."""
    for i in range(n):
        p1, p2 = w[P1 + i], w[P2 + i]
        w[MARK + i] = 1.0 if (p1 < 0.0) | (p2 < 0.0) else 0.0
        w[P1 + i] = np.nan if p1 < 0.0 else p1
        w[P2 + i] = np.nan if p2 < 0.0 else p2


@compiled
def _screen_valve(w, n, sized, rated):
    """NaN for data of the valve that are used and not positive; the rows are marked."""
    for i in range(n):
        fl, fd, size, kv = w[FL + i], w[FD + i], w[SIZE + i], w[RATED + i]
        inlet, outlet = w[INLET + i], w[OUTLET + i]
        bad_size, bad_kv = (size <= 0.0) & sized, (kv <= 0.0) & rated
        bad = (fl <= 0.0) | (fd <= 0.0) | (inlet <= 0.0) | (outlet <= 0.0) | bad_size | bad_kv
        w[MARK + i] = 1.0 if bad else w[MARK + i]
        w[FL + i] = np.nan if fl <= 0.0 else fl
        w[FD + i] = np.nan if fd <= 0.0 else fd
        w[SIZE + i] = np.nan if bad_size else size
        w[RATED + i] = np.nan if bad_kv else kv
        w[INLET + i] = np.nan if inlet <= 0.0 else inlet
        w[OUTLET + i] = np.nan if outlet <= 0.0 else outlet


@compiled
def _count_lost(w, n, choking, counts):
    """Rows without a flow, though a valve without pipes and viscosity would have one."""
    for i in range(n):
        p1, p2, kv = w[P1 + i], w[P2 + i], w[KV + i]
        entering = (p1 if p1 > p2 else p2) > (w[BOIL + i] if choking else -np.inf)
        entering &= (w[RHO + i] > 0.0) & (w[NU + i] > 0.0) & (w[NU + i] < np.inf)
        # finite in sum: none is NaN or endless, and what is not positive is NaN already
        data = w[FL + i] + w[FD + i] + abs(w[RATED + i]) + w[SIZE + i] + w[INLET + i] + w[OUTLET + i]
        known = (abs(kv * (p1 - p2)) >= 0.0) & (data < np.inf)
        counts[7] += (w[FLOW + i] != w[FLOW + i]) & entering & known


@compiled
def _count(w, n, of_water, choking, piping, viscous, counts):
    for i in range(n):
        counts[3] += w[KV + i] < 0.0
        counts[4] += w[RHO + i] <= 0.0
        counts[8] += (w[MARK + i] > 0.0) & (w[FLOW + i] != w[FLOW + i])
    if of_water:
        for i in range(n):
            counts[0] += (w[T + i] < FREEZING) | (w[T + i] > CRITICAL_TEMPERATURE)
    if choking:
        for i in range(n):
            boils = (w[P1 + i] <= w[PV + i]) & (w[P2 + i] <= w[PV + i])
            counts[2] += boils & (w[BOIL + i] == w[BOIL + i])
    if viscous:
        for i in range(n):
            counts[5] += w[NU + i] <= 0.0
        if of_water:
            for i in range(n):
                counts[1] += (w[T + i] < FREEZING) | (w[T + i] > VISCOSITY_LIMIT)
    if piping or viscous:
        for i in range(n):
            size = MM * w[SIZE + i]
            counts[6] += abs(w[KV + i]) > WIDEST * size * size
        _count_lost(w, n, choking, counts)


@compiled
def _rate(first, end, shape, inputs, steps, wanted, out, counts, of_water, choking, piping, viscous, strict):
    w = np.ones(WORK)
    given = np.array([len(inputs[k]) > 0 for k in range(len(inputs))])
    # what is the same for all rows is read once, but for pressures, which are marked anew
    moving = np.array([np.any(steps[k]) for k in range(len(inputs))])
    moving[1:3] = True
    again = np.any(moving[8:])
    for start in range(first, end, BLOCK):
        n = min(BLOCK, end - start)
        for k in range(len(inputs)):
            if given[k] and (start == first or moving[k]):
                _load(inputs[k], steps[k], shape, start, n, w, k * ROW)
        _screen_pressures(w, n)
        if start == first or again:
            _screen_valve(w, n, piping or viscous, viscous and given[10])
            # nonsense that is the same for all rows must be seen again in the next block
            if start == first and np.any(w[MARK : MARK + n] > 0.0):
                moving[8:] = again = True
        if viscous and not given[10]:
            w[RATED : RATED + n] = w[KV : KV + n]
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


def _stamped(stamp):
    """The pass under a number of its sources.

    On disk the compiler tells versions of a function apart by its own file and by the values it closes over,
    but not by the other files that it takes code and numbers from. So the pass closes over their stamp.
    """

    @nb.njit(nogil=True, cache=True, fastmath=FAST, error_model="numpy")
    def rate(
        first, end, shape, inputs, steps, wanted, out, counts, of_water, choking, piping, viscous, strict
    ):
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
        stamp  # noqa: B018
        _rate(
            first, end, shape, inputs, steps, wanted, out, counts, of_water, choking, piping, viscous, strict
        )

    return rate


def _stamp(folder):
    digest = hashlib.sha256()
    for name in SOURCES:
        digest.update((folder / name).read_bytes())
    return int.from_bytes(digest.digest()[:7], "big")


rate = _stamped(_stamp(Path(__file__).parent))
