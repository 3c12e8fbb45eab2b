# SPDX-License-Identifier: BSD-3-Clause
"""What friction and play make of a command: positions of a stem, for many sizes at once."""

from dataclasses import dataclass

import numba as nb
import numpy as np

#: Shares of the command's span tried for the band in which a turning command moves nothing.
SHARES = np.geomspace(0.05, 1.0, 13)
#: Shares of the band tried for the jump that ends it; none of it is play.
JUMPS = (0.0, 0.3, 0.7, 1.0)


@nb.njit(cache=True)
def _stems(command, bands, rests, start):
    out = np.empty((len(bands), len(command)))
    for g in range(len(bands)):
        stem = start[g]
        for k in range(len(command)):
            gap = command[k] - stem
            if gap > bands[g]:
                stem = command[k] - rests[g]
            elif gap < -bands[g]:
                stem = command[k] + rests[g]
            out[g, k] = stem
    return out


def stick_slip(command, stick, slip, start=None):
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
        Position before the first row; the first command unless given.

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
    stems = _stems(command, 0.5 * (stick + slip), 0.5 * (stick - slip), np.ascontiguousarray(first, float))
    return stems[0] if single else stems


@nb.njit(cache=True)
def _one_glide(told, last, stem, way, band, rest):
    if way * (told - last) < 0.0:
        way = 0.0
    if way == 0.0 and abs(told - stem) > band:
        way = 1.0 if told > stem else -1.0
    return (told - way * rest if way != 0.0 else stem), way


@nb.njit(cache=True)
def _glides(command, foreseen, bands, rests, start):
    stems = np.empty((len(bands), len(command)))
    ahead = np.empty((len(bands), len(command)))
    for g in range(len(bands)):
        stem, way, last = start[g], 0.0, command[0]
        for k in range(len(command)):
            ahead[g, k], _ = _one_glide(foreseen[k], last, stem, way, bands[g], rests[g])
            stem, way = _one_glide(command[k], last, stem, way, bands[g], rests[g])
            stems[g, k] = stem
            last = command[k]
    return stems, ahead


def stick_glide(command, stick, slip, start=None, foreseen=None):
    """Position of a stem that sticks where the command turns, jumps, and then goes with the command.

    As `stick_slip`, but a stem that moves is not caught again before the command turns: it follows
    ``(stick - slip) / 2`` behind. This is the form of Choudhury, Thornhill and Shah (2005, doi
    10.1016/j.conengprac.2004.05.005), for a friction that is large at rest only; ``slip = 0`` is play in
    both.

    Parameters
    ----------
    command : array-like of shape (n,)
        Command [fraction of travel].
    stick, slip : array-like of shape (m,)
        Band in which a turning command moves nothing, and the jump that ends it [fraction of travel].
    start : array-like of shape (m,), optional
        Position before the first row; the first command unless given [fraction of travel].
    foreseen : array-like of shape (n,), optional
        Command in each row as the rows before foresee it; the command unless given [fraction of travel].

    Returns
    -------
    stem, ahead : ndarray of shape (m, n)
        Position, and as foreseen from the rows before [fraction of travel].

    Examples
    --------
    >>> from sklvalve.mismatch.loop.operators import stick_glide
    >>> stick_glide([0.0, 0.1, 0.25, 0.3, 0.2, 0.05], [0.2], [0.2])[0].round(2)
    array([[0.  , 0.  , 0.25, 0.3 , 0.3 , 0.05]])
    """
    command = np.ascontiguousarray(command, dtype=float)
    foreseen = command if foreseen is None else np.ascontiguousarray(foreseen, dtype=float)
    stick, slip = np.asarray(stick, dtype=float), np.asarray(slip, dtype=float)
    first = np.full(len(stick), command[0]) if start is None else np.ascontiguousarray(start, float)
    return _glides(command, foreseen, 0.5 * (stick + slip), 0.5 * (stick - slip), first)


def stick_ahead(command, stick, slip, start, foreseen):
    """`stick_slip`, and its position as foreseen from the rows before; parameters as in `stick_glide`.

    Returns
    -------
    stem, ahead : ndarray of shape (m, n)
        Position, and as foreseen from the rows before [fraction of travel].
    """
    stem = stick_slip(command, stick, slip, start)
    before = np.hstack([start[:, None], stem[:, :-1]])
    return stem, _one_ahead(before, stick, slip, foreseen)


def _one_ahead(before, stick, slip, foreseen):
    band, rest = 0.5 * (stick + slip)[:, None], 0.5 * (stick - slip)[:, None]
    gap = foreseen - before
    return np.where(gap > band, foreseen - rest, np.where(gap < -band, foreseen + rest, before))


def size_grid(span, jumps=JUMPS):
    """Sizes to try: band [fraction of travel], its share that is a jump, and side of the band to begin at.

    Parameters
    ----------
    span : float
        Span of the command [fraction of travel].
    jumps : sequence of float

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


def placed(command, sizes):
    """Band, jump and first position [fraction of travel] of sizes as `size_grid` has them."""
    stick, slip = sizes[:, 0], sizes[:, 1] * sizes[:, 0]
    return stick, slip, command[0] + sizes[:, 2] * 0.5 * (stick - slip)


@dataclass(frozen=True, eq=False)
class Candidates:
    """Stems to try: the command itself first, then every size of sticking.

    Parameters
    ----------
    stick, slip : ndarray of shape (m,)
        Sizes [fraction of travel]; zero for the first.
    stem : ndarray of shape (m, n)
        Position in each row [fraction of travel].
    ahead : ndarray of shape (m, n)
        Position in each row as foreseen from the rows before it [fraction of travel].
    """

    stick: np.ndarray
    slip: np.ndarray
    stem: np.ndarray
    ahead: np.ndarray


def moved(law, loop, sizes, foreseen):
    """Positions of a stem that sticks, in the rows of a loop, by a law of friction.

    The stem answers the command of every recorded row; a row of the loop is the mean of some of them.

    Parameters
    ----------
    law : callable
        `stick_ahead` or `stick_glide`.
    loop : LoopSignals
    sizes : ndarray of shape (m, 3)
        As `size_grid` has them.
    foreseen : ndarray of shape (n,)
        Command at the end of each row, as the rows before foresee it [fraction of travel].

    Returns
    -------
    stem, ahead : ndarray of shape (m, n)
        Position, and as foreseen from the rows before [fraction of travel].
    """
    stick, slip, start = placed(loop.whole, sizes)
    if loop.every == 1:
        return law(loop.command, stick, slip, start, foreseen)
    stem, _ = law(loop.whole, stick, slip, start, loop.whole)
    ends = stem[:, loop.every - 1 :: loop.every]
    before = np.hstack([start[:, None], ends[:, :-1]])
    return loop.means(stem), 0.5 * (before + _one_ahead(before, stick, slip, foreseen))


@nb.njit(cache=True)
def reversals(command, size):
    """How often a command turns and then goes at least a given way back.

    Parameters
    ----------
    command : ndarray of shape (n,)
    size : float

    Returns
    -------
    count : int
    """
    count, way, high, low = 0, 0, command[0], command[0]
    for now in command:
        high, low = max(high, now), min(low, now)
        if way >= 0 and now < high - size:
            count += way > 0
            way, low = -1, now
        elif way <= 0 and now > low + size:
            count += way < 0
            way, high = 1, now
    return count


def candidates(loop, foreseen):
    """Stems of all sizes, each from up to three places in its band at the beginning.

    Both forms of friction are tried, `stick_slip` and `stick_glide`: a stem that moves goes in jumps, or with
    the command until it turns. Where the stem stood before the first row is not recorded: behind a command
    that rose, behind one that fell, or level with it.

    Parameters
    ----------
    loop : LoopSignals
    foreseen : ndarray of shape (n,)
        Command at the end of each row, as the rows before foresee it [fraction of travel].

    Returns
    -------
    tried : Candidates
    """
    sizes = np.vstack([np.zeros(3), size_grid(loop.span)])
    gliding = size_grid(loop.span, JUMPS[1:])
    # where a gliding stem begins is forgotten at the first turn
    gliding = gliding[gliding[:, 2] == 0.0]
    stems = moved(stick_ahead, loop, sizes, foreseen), moved(stick_glide, loop, gliding, foreseen)
    stick, slip, _ = placed(loop.whole, np.vstack([sizes, gliding]))
    return Candidates(stick, slip, *(np.vstack(pair) for pair in zip(*stems, strict=True)))
