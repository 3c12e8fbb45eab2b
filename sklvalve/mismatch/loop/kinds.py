# SPDX-License-Identifier: BSD-3-Clause
"""Which kind of sticking it is: play, or a jump; asked of a loop of which it is known that it sticks.

Whether a stem sticks is asked with one form of friction, and the law of that evidence under healthy loops
is known. What *kind* it is must not hang on the form: a stem that jumps and then goes with the command looks
like play to a form in which every movement is a jump. So both forms compete here, with sizes finer than the
grid.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sklvalve.mismatch.decide.constants import DISTINGUISHABLE
from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.loop.fit import LoopFit, refined, simple_fits, without
from sklvalve.mismatch.loop.look import MATTERS
from sklvalve.mismatch.loop.operators import JUMPS, moved, size_grid, stick_ahead, stick_glide
from sklvalve.mismatch.loop.process import responses

_LEAST_JUMP = 0.2  # of the band; a smaller one is play
_ROUNDS = ((1.25, 0.15), (1.08, 0.05))  # factor of the band and step of the jump to either side
_FITTED = 3  # of a kind, with the noise in full
_WHOLE = 0.95  # of the command's movement; a wider band is known from below only
_BAND = (0.45, 1.8)  # of the band found: 95 % of 90 drawn loops that stick had theirs in between


@dataclass(frozen=True, eq=False)
class Kind:
    """What kind of sticking.

    Parameters
    ----------
    shares : dict of str to float
        `stiction` and `backlash`, or one of them: the share of each in the probability of the class.
    stick, slip : float
        Of the likeliest stem [fraction of travel].
    sticks, slips : (float, float)
        Between what they lie, 95 % [fraction of travel].
    stem : ndarray of shape (n,)
        Its position [fraction of travel].
    columns : ndarray of shape (k, n)
        Responses to it.
    fit : LoopFit
    """

    shares: dict[str, float]
    stick: float
    slip: float
    sticks: tuple[float, float]
    slips: tuple[float, float]
    stem: np.ndarray
    columns: np.ndarray
    fit: LoopFit


@dataclass(frozen=True, eq=False)
class _Family:
    name: str
    law: Callable
    jumps: tuple[float, ...]


_FAMILIES = (
    _Family("backlash", stick_ahead, (0.0,)),
    _Family("stiction", stick_ahead, JUMPS[1:]),
    _Family("stiction", stick_glide, JUMPS[1:]),
)


def kind_of_sticking(loop, foreseen, sense, command, waves=None):
    """Play or a jump, where the one is told from the other.

    A jump is told from play from a distance of 14 on, as anywhere in this package (`distance`), of the best
    stem of each kind under either form of friction and the noise that suits it. Play is never told from a
    jump: between two rows a controller that answers noise turns the command many times, and what is left of a
    jump then looks smooth (of twelve drawn loops for which play fitted better by that much eight had one).
    Sizes are known no better than such loops showed: their own profile held the band in half of them.

    Parameters
    ----------
    loop : LoopSignals
    foreseen : ndarray of shape (n,)
        Command as the rows before foresee it [fraction of travel].
    sense : int
        Sign of the response.
    command : LoopFit
        The fit of the command itself.
    waves : ndarray of shape (w, n), optional
        An oscillation from outside beside the stem.

    Returns
    -------
    kind : Kind
    """
    found = [_searched(family, loop, foreseen, sense, waves) for family in _FAMILIES]
    best = max(found, key=lambda one: one.fit.log_likelihood)
    gain = best.fit.log_likelihood - command.log_likelihood
    weights: dict[str, float] = {}
    for one in found:
        apart = distance(best.fit.log_likelihood, one.fit.log_likelihood, gain)
        if apart < DISTINGUISHABLE:
            weights[one.name] = max(weights.get(one.name, 0.0), float(np.exp(-0.5 * apart)))
    if best.name == "backlash":
        weights["stiction"] = weights["backlash"]
    total = sum(weights.values())
    stick, jump, _ = best.sizes[best.fit.stem]
    low, high = (float(factor * stick) for factor in _BAND)
    low = max(low, MATTERS * loop.span)  # a smaller one is not called
    # of a band as wide as the movement nobody has seen the other end, and the stem has its stops
    high = max(min(high, 1.0), float(stick)) if stick < _WHOLE * loop.span else max(1.0, float(stick))
    return Kind(
        {name: weight / total for name, weight in weights.items()},
        float(stick),
        float(stick * jump),
        (low, high),
        (0.0 if "backlash" in weights else float(low * _LEAST_JUMP), high),
        best.stems[best.fit.stem],
        best.columns[best.fit.stem],
        best.fit,
    )


@dataclass(frozen=True, eq=False)
class _Searched:
    """Stems of a family that were tried, and the fit of the best: `fit.stem` is its place among them."""

    name: str
    sizes: np.ndarray
    likelihoods: np.ndarray
    stems: np.ndarray
    columns: np.ndarray
    fit: LoopFit


def _searched(family, loop, foreseen, sense, waves):
    # what is called is a band that matters: a smaller one was held against it before
    least = MATTERS * loop.span
    sizes = size_grid(loop.span, family.jumps)
    tried = _tried(family, sizes[sizes[:, 0] >= least], loop, foreseen, sense, waves)
    for factor, step in _ROUNDS:
        stick, jump, side = tried[0][np.argmax(tried[1])]
        jumps = np.clip([jump - step, jump, jump + step], _LEAST_JUMP, 1.0) if jump > 0.0 else [0.0]
        widths = np.unique(np.maximum(stick * np.geomspace(1 / factor, factor, 7), least))
        near = [(s, j, side) for s in widths for j in np.unique(jumps)]
        finer = _tried(family, np.array(near), loop, foreseen, sense, waves)
        tried = tuple(np.concatenate(pair) for pair in zip(tried, finer, strict=True))
    sizes, likelihoods, noises, stems, columns = tried
    most = np.argsort(-likelihoods, kind="stable")[:_FITTED]
    fit = max(
        (refined(columns, k, loop.value, loop.used, sense, tuple(noises[k]), waves) for k in most),
        key=lambda one: one.log_likelihood,
    )
    return _Searched(family.name, sizes, likelihoods, stems, columns, fit)


def _tried(family, sizes, loop, foreseen, sense, waves):
    stem, ahead = moved(family.law, loop, sizes, foreseen)
    columns = responses(stem, ahead, not loop.is_flow)
    likelihoods, noises, _ = simple_fits(
        without(columns, waves, loop.used), without(loop.value, waves, loop.used), loop.used, sense
    )
    return sizes, likelihoods, np.array(noises), stem, columns
