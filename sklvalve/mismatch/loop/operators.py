# SPDX-License-Identifier: BSD-3-Clause
"""What friction and play make of a command: positions of a stem, for many sizes at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numba as nb
import numpy as np
from numpy.typing import ArrayLike, NDArray

from sklvalve.mismatch.loop.signals import LoopSignals, block_means

#: Shares of the command's span tried for the band in which a turning command moves nothing.
SHARES = np.geomspace(0.05, 1.0, 13)
#: Shares of the band tried for the jump that ends it; none of it is play.
JUMPS = (0.0, 0.3, 0.7, 1.0)
#: A law of friction: command, stick, slip, start and forecast command -> position and its forecast.
FrictionLaw = Callable[[NDArray, NDArray, NDArray, NDArray, NDArray], tuple[NDArray, NDArray]]


@nb.njit(cache=True)
def _jumping_stems(command: NDArray, bands: NDArray, offsets: NDArray, start: NDArray) -> NDArray:
    """Stems that stay within a half band of the command, and else jump to an offset behind it."""
    out = np.empty((len(bands), len(command)))
    for g in range(len(bands)):
        stem = start[g]
        for k in range(len(command)):
            gap = command[k] - stem
            if gap > bands[g]:
                stem = command[k] - offsets[g]
            elif gap < -bands[g]:
                stem = command[k] + offsets[g]
            out[g, k] = stem
    return out


def stick_slip(
    command: ArrayLike, stick: ArrayLike, slip: ArrayLike, start: ArrayLike | None = None
) -> NDArray:
    """Position of a stem that sticks, and slips when the command has left it far enough behind.

    The stem rests while the command is within a band of it and then jumps::

        |u - x| <= (stick + slip) / 2 : x stays;  else  x = u -+ (stick - slip) / 2

    so a command that turns moves the stem after `stick`, and the first movement is a jump of `slip`.
    ``slip = 0`` is play (backlash); ``slip = stick`` leaves no offset behind. This is the two-parameter form
    of He, Wang, Pottmann and Qin (2007, doi 10.1021/ie061219a); it holds for slow commands, sampled more
    slowly than the stem moves.

    Parameters
    ----------
    command : array-like of shape (n,)
        Command [fraction of travel].
    stick, slip : float or array-like of shape (m,)
        Band in which a turning command moves nothing, and first jump after it [fraction of travel];
        0 <= slip <= stick.
    start : float or array-like of shape (m,), optional
        Position before the first row; the first command unless given [fraction of travel].

    Returns
    -------
    stem : ndarray of shape (n,) or (m, n)
        Position [fraction of travel].

    Raises
    ------
    ValueError
        If a slip is negative or above its stick.

    Examples
    --------
    >>> from sklvalve.mismatch.loop.operators import stick_slip
    >>> stick_slip([0.0, 0.1, 0.25, 0.3, 0.2, 0.1], stick=0.2, slip=0.2).round(2)
    array([0.  , 0.  , 0.25, 0.25, 0.25, 0.25])
    """
    command = np.ascontiguousarray(command, dtype=float)
    single = np.ndim(stick) == 0 and np.ndim(slip) == 0
    stick, slip = np.broadcast_arrays(np.atleast_1d(stick), np.atleast_1d(slip))
    if (slip < 0.0).any() or (slip > stick).any():
        raise ValueError("expected 0 <= slip <= stick, and got another; give the jump as part of the band")
    first = np.full(len(stick), command[0]) if start is None else np.broadcast_to(start, stick.shape)
    first = np.ascontiguousarray(first, float)
    stems = _jumping_stems(command, 0.5 * (stick + slip), 0.5 * (stick - slip), first)
    return stems[0] if single else stems


@nb.njit(cache=True)
def _gliding_step(
    command: float, last: float, stem: float, direction: float, band: float, offset: float
) -> tuple[float, float]:
    """Position and direction after one row of a stem that glides until the command turns."""
    if direction * (command - last) < 0.0:
        direction = 0.0
    if direction == 0.0 and abs(command - stem) > band:
        direction = 1.0 if command > stem else -1.0
    return (command - direction * offset if direction != 0.0 else stem), direction


@nb.njit(cache=True)
def stick_glide(
    command: NDArray, stick: NDArray, slip: NDArray, start: NDArray, forecast: NDArray
) -> tuple[NDArray, NDArray]:
    """Position of a stem that sticks where the command turns, jumps, and then goes with the command.

    As `stick_slip`, but a stem that moves is not caught again before the command turns: it follows
    ``(stick - slip) / 2`` behind. This is the form of Choudhury, Thornhill and Shah (2005, doi
    10.1016/j.conengprac.2004.05.005), for a friction that is large at rest only; ``slip = 0`` is play in
    both.

    Parameters
    ----------
    command : ndarray of shape (n,)
        [fraction of travel]
    stick, slip, start : ndarray of shape (m,)
        As in `stick_slip` [fraction of travel].
    forecast : ndarray of shape (n,)
        Of the command in each row, from the rows before [fraction of travel].

    Returns
    -------
    stem, stem_forecast : ndarray of shape (m, n)
        Position, and its forecast from the rows before [fraction of travel].
    """
    stems = np.empty((len(stick), len(command)))
    ahead = np.empty((len(stick), len(command)))
    for g in range(len(stick)):
        band, offset = 0.5 * (stick[g] + slip[g]), 0.5 * (stick[g] - slip[g])
        stem, direction, last = start[g], 0.0, command[0]
        for k in range(len(command)):
            ahead[g, k], _ = _gliding_step(forecast[k], last, stem, direction, band, offset)
            stem, direction = _gliding_step(command[k], last, stem, direction, band, offset)
            stems[g, k] = stem
            last = command[k]
    return stems, ahead


def stick_jump(
    command: NDArray, stick: NDArray, slip: NDArray, start: NDArray, forecast: NDArray
) -> tuple[NDArray, NDArray]:
    """`stick_slip`, and its forecast from the rows before; parameters and returns as in `stick_glide`."""
    stem = stick_slip(command, stick, slip, start)
    before = np.hstack([start[:, None], stem[:, :-1]])
    return stem, _next_position(before, stick, slip, forecast)


def _next_position(before: NDArray, stick: NDArray, slip: NDArray, forecast: NDArray) -> NDArray:
    """Position of a jumping stem after one row, from where it stood before."""
    band, offset = 0.5 * (stick + slip)[:, None], 0.5 * (stick - slip)[:, None]
    gap = forecast - before
    return np.where(gap > band, forecast - offset, np.where(gap < -band, forecast + offset, before))


def size_grid(span: float, jumps: Sequence[float] = JUMPS) -> NDArray:
    """Sizes to try: band [fraction of travel], its share that is a jump, and side of the band to begin at.

    Parameters
    ----------
    span : float
        Span of the command [fraction of travel].
    jumps : sequence of float
        Shares of the band.

    Returns
    -------
    sizes : ndarray of shape (m, 3)
    """
    return np.array([
        (share * span, jump, side)
        for share in SHARES
        for jump in jumps
        for side in ((-1.0, 0.0, 1.0) if jump < 1.0 else (0.0,))
    ])  # fmt: skip


def friction_parameters(command: NDArray, sizes: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Stick, slip and first position [fraction of travel] of sizes as `size_grid` has them."""
    stick, slip = sizes[:, 0], sizes[:, 1] * sizes[:, 0]
    return stick, slip, command[0] + sizes[:, 2] * 0.5 * (stick - slip)


@dataclass(frozen=True, eq=False)
class Candidates:
    """Stems to try: the command itself first, then every size of sticking.

    Parameters
    ----------
    stick : ndarray of shape (m,)
        Band in which a turning command moves nothing [fraction of travel]; zero for the first.
    stem, stem_forecast : ndarray of shape (m, n)
        Position in each row, and its forecast from the rows before [fraction of travel].
    """

    stick: NDArray
    stem: NDArray
    stem_forecast: NDArray


def simulate_stems(
    law: FrictionLaw, loop: LoopSignals, sizes: NDArray, forecast: NDArray
) -> tuple[NDArray, NDArray]:
    """Positions of a stem that sticks, in the rows of a loop, by a law of friction.

    The stem answers the command of every recorded row; a row of the loop is the mean of some of them.

    Parameters
    ----------
    law : callable
        `stick_jump` or `stick_glide`.
    loop : LoopSignals
    sizes : ndarray of shape (m, 3)
        As `size_grid` has them.
    forecast : ndarray of shape (n,)
        Of the command at the end of each row, from the rows before [fraction of travel].

    Returns
    -------
    stem, stem_forecast : ndarray of shape (m, n)
        As in `stick_glide` [fraction of travel].
    """
    stick, slip, start = friction_parameters(loop.recorded_command, sizes)
    if loop.decimation == 1:
        return law(loop.command, stick, slip, start, forecast)
    stem, _ = law(loop.recorded_command, stick, slip, start, loop.recorded_command)
    ends = stem[:, loop.decimation - 1 :: loop.decimation]
    before = np.hstack([start[:, None], ends[:, :-1]])
    after = _next_position(before, stick, slip, forecast)
    return block_means(stem, loop.decimation), 0.5 * (before + after)


@nb.njit(cache=True)
def count_reversals(command: NDArray, size: float) -> int:
    """How often a command turns and then goes at least a given way back [fraction of travel]."""
    count, direction, high, low = 0, 0, command[0], command[0]
    for now in command:
        high, low = max(high, now), min(low, now)
        if direction >= 0 and now < high - size:
            count += direction > 0
            direction, low = -1, now
        elif direction <= 0 and now > low + size:
            count += direction < 0
            direction, high = 1, now
    return count


def candidate_stems(loop: LoopSignals, forecast: NDArray) -> Candidates:
    """Stems of all sizes, each from up to three places in its band at the beginning.

    Both forms of friction are tried, `stick_slip` and `stick_glide`: a stem that moves goes in jumps, or with
    the command until it turns. Where the stem stood before the first row is not recorded: behind a command
    that rose, behind one that fell, or level with it. `forecast` is as in `simulate_stems`.
    """
    jumping = np.vstack([np.zeros(3), size_grid(loop.span)])
    gliding = size_grid(loop.span, JUMPS[1:])
    # where a gliding stem begins is forgotten at the first turn
    gliding = gliding[gliding[:, 2] == 0.0]
    stems = [simulate_stems(stick_jump, loop, jumping, forecast)]
    stems.append(simulate_stems(stick_glide, loop, gliding, forecast))
    stick = np.vstack([jumping, gliding])[:, 0]
    return Candidates(stick, *(np.vstack(pair) for pair in zip(*stems, strict=True)))
