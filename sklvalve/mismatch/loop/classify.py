# SPDX-License-Identifier: BSD-3-Clause
"""Play or a jump: asked of a loop of which it is known that it sticks.

A stem that jumps and then goes with the command looks like play to a form of friction in which every movement
is a jump. So both forms compete, with sizes finer than the grid.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import sklvalve.mismatch.loop.constants as constants
from sklvalve.mismatch.constants import DISTINGUISHABLE
from sklvalve.mismatch.inference.posterior import distance
from sklvalve.mismatch.loop.fit import LoopFit, Regression, Screening, likeliest, refine, screen
from sklvalve.mismatch.loop.operators import (
    JUMPS,
    FrictionLaw,
    simulate_stems,
    size_grid,
    stick_glide,
    stick_jump,
)
from sklvalve.mismatch.loop.process import responses
from sklvalve.mismatch.loop.stretch import StretchResult

_ROUNDS = ((1.25, 0.15), (1.08, 0.05))  # factor of the band and step of the jump to either side
_FITTED = 3  # stems of a form, with the noise in full


@dataclass(frozen=True, eq=False)
class StickingClass:
    """Play, a jump, or both as one class, with the sizes.

    Parameters
    ----------
    shares : dict of str to float
        `stiction` and `backlash`, or one of them: the share of each in the probability of the class.
    stick, slip : float
        Of the likeliest stem [fraction of travel].
    stick_interval, slip_interval : (float, float)
        95 % [fraction of travel].
    stem : ndarray of shape (n,)
        Its position [fraction of travel].
    fit : LoopFit
    """

    shares: dict[str, float]
    stick: float
    slip: float
    stick_interval: tuple[float, float]
    slip_interval: tuple[float, float]
    stem: NDArray
    fit: LoopFit


@dataclass(frozen=True, eq=False)
class _FrictionForm:
    """A law of friction under the name of its effect, with the shares of the band that jump."""

    name: str
    law: FrictionLaw
    jumps: tuple[float, ...]


_FORMS = (
    _FrictionForm("backlash", stick_jump, (0.0,)),
    _FrictionForm("stiction", stick_jump, JUMPS[1:]),
    _FrictionForm("stiction", stick_glide, JUMPS[1:]),
)


@dataclass(frozen=True, eq=False)
class _Trial:
    """Stems of a form that were tried: their sizes, as `size_grid` has them, and positions."""

    sizes: NDArray
    stems: NDArray
    screening: Screening
    regression: Regression


@dataclass(frozen=True, eq=False)
class _Best:
    """The likeliest stem of a form: band [fraction of travel] and its share that jumps, position, fit."""

    name: str
    stick: float
    jump: float
    stem: NDArray
    fit: LoopFit


def classify_sticking(result: StretchResult) -> StickingClass:
    """Play or a jump, where the two can be distinguished.

    A jump is distinguished from play from a distance of 14 on, as anywhere in this package (`distance`). The
    distance is that of the best stem of each kind under either form of friction and the noise that suits it.
    Play is never distinguished from a jump: between two rows a controller that answers noise turns the
    command many times, and what is left of a jump then looks smooth. Of twelve drawn loops for which play
    fitted better by that much eight had a jump.
    """
    bests = [_best_of_form(form, result) for form in _FORMS]
    fit = likeliest(best.fit for best in bests)
    best = next(each for each in bests if each.fit is fit)
    shares = _shares(bests, best, result.comparison.command.log_likelihood)
    low, high = _band_interval(best.stick, result.loop.span)
    least_slip = 0.0 if "backlash" in shares else low * constants.LEAST_JUMP
    return StickingClass(
        shares, best.stick, best.stick * best.jump, (low, high), (least_slip, high), best.stem, best.fit
    )


def _shares(bests: list[_Best], best: _Best, command: float) -> dict[str, float]:
    """Share of each name that is not distinguished from the best, by its likelihood."""
    weights: dict[str, float] = {}
    for each in bests:
        gain = best.fit.log_likelihood - command
        apart = distance(best.fit.log_likelihood, each.fit.log_likelihood, gain)
        if apart < DISTINGUISHABLE:
            weights[each.name] = max(weights.get(each.name, 0.0), float(np.exp(-0.5 * apart)))
    if best.name == "backlash":
        weights["stiction"] = weights["backlash"]
    total = sum(weights.values())
    return {name: weight / total for name, weight in weights.items()}


def _band_interval(stick: float, span: float) -> tuple[float, float]:
    """Where the band lies, 95 % [fraction of travel]."""
    low, high = (factor * stick for factor in constants.BAND_INTERVAL)
    low = max(low, constants.RELEVANT_BAND * span)  # a smaller one is not called
    # of a band as wide as the movement nobody has seen the other end, and the stem has its stops
    return low, max(min(high, 1.0) if stick < constants.WHOLE_MOVEMENT * span else 1.0, stick)


def _best_of_form(form: _FrictionForm, result: StretchResult) -> _Best:
    """The likeliest stem of a form of friction, from the grid and finer sizes around its best."""
    # what is called is a relevant band: a smaller one was held against it before
    least = constants.RELEVANT_BAND * result.loop.span
    sizes = size_grid(result.loop.span, form.jumps)
    trials = [_try(form, sizes[sizes[:, 0] >= least], result)]
    for factor, step in _ROUNDS:
        trial, place = _ranked(trials)[0]
        stick, jump, side = trial.sizes[place]
        jumps = np.clip([jump - step, jump, jump + step], constants.LEAST_JUMP, 1.0) if jump > 0.0 else [0.0]
        widths = np.unique(np.maximum(stick * np.geomspace(1 / factor, factor, 7), least))
        near = [(width, share, side) for width in widths for share in np.unique(jumps)]
        trials.append(_try(form, np.array(near), result))
    ranked = _ranked(trials)[:_FITTED]
    fits = [refine(trial.regression, k, trial.screening.noise_filters[k]) for trial, k in ranked]
    fit = likeliest(fits)
    trial, place = ranked[fits.index(fit)]
    stick, jump, _ = map(float, trial.sizes[place])
    return _Best(form.name, stick, jump, trial.stems[place], fit)


def _ranked(trials: list[_Trial]) -> list[tuple[_Trial, int]]:
    """Every stem of some trials, the likeliest under the simpler noise first."""
    stems = [(trial, place) for trial in trials for place in range(len(trial.sizes))]
    return sorted(stems, key=lambda stem: -stem[0].screening.log_likelihoods[stem[1]])


def _try(form: _FrictionForm, sizes: NDArray, result: StretchResult) -> _Trial:
    """Stems of some sizes under the simpler noise."""
    stems, forecasts = simulate_stems(form.law, result.loop, sizes, result.forecast)
    # beside the oscillation from outside that stands beside the best stem of the grid
    columns = responses(stems, forecasts, not result.loop.is_flow)
    regression = replace(result.comparison.sticking.regression, responses=columns)
    return _Trial(sizes, stems, screen(regression), regression)
