# SPDX-License-Identifier: BSD-3-Clause
"""What is judged: a recording, its calibration and its noise; hypotheses are fitted to it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from sklvalve.history import ValveHistory
from sklvalve.history.noise_of_history import as_before
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import Model, Term
from sklvalve.mismatch.inference.sharing import Sharing
from sklvalve.mismatch.inference.sizes import Sizes
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import (
    channels_of,
    choose_trim,
    spans_of,
)
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.fitting import (
    ChannelFit,
    Misfit,
    PlainNoise,
    first_noise,
    fit_chain,
    residual_of,
    simulate_channels,
)
from sklvalve.simulation.given import chain_for
from sklvalve.simulation.noise import TIMING, sizes_of_noise
from sklvalve.simulation.noise_of_pieces import noise_of
from sklvalve.simulation.robust import robust_cost


@dataclass(frozen=True)
class _Memory:
    """Fits and noises found once: in a search the same question comes up many times."""

    fits: dict[tuple, ChannelFit] = field(default_factory=dict)
    noises: dict[tuple[str, bool], Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Problem(Sharing, Sizes):
    """One recording, its calibration, and the noise that hypotheses are judged by; `Problem.of` makes one.

    What it is asked by does not change: another noise makes another problem, of the same recording. Problems
    of one recording share what was fitted before, and the noise first learnt where no effect acts.

    Parameters
    ----------
    recording : Recording
    tolerance : Tolerance
        What the data sheet leaves open.
    valve : Valve
        Data sheet.
    trim : Trim
    plain : Chain
        The simulation without effects, bound to the recording.
    channels : tuple of str
        Recorded signals that hypotheses are held against.
    spans : dict
        Channel -> span of it [SI].
    noise : dict
        Channel -> noise model.
    rows : ndarray of bool or None
        Rows that may be used.
    held : tuple of Term
        Effects that are part of every hypothesis, calibrated with it and never judged.
    held_values : dict
        Values of their parameters to begin with.
    sound_values : dict
        Parameters of an actuator that most rows bear out; `calibrated` finds them.
    history : ValveHistory or None
        What is known of the valve from earlier recordings: it takes the sheet's place as what is expected.
    """

    recording: Recording
    tolerance: Tolerance
    valve: Valve
    trim: Any
    plain: Chain
    channels: tuple[str, ...]
    spans: dict[str, float]
    noise: dict[str, Any]
    rows: np.ndarray | None = None
    held: tuple[Term, ...] = ()
    held_values: dict[str, float] = field(default_factory=dict)
    sound_values: dict[str, float] = field(default_factory=dict)
    history: ValveHistory | None = None
    _memory: _Memory = field(default_factory=_Memory, repr=False)

    @classmethod
    def of(
        cls,
        recording: Recording,
        tolerance: Tolerance,
        physics: Sequence[str],
        *,
        valve: Valve | None = None,
        trim: Any = None,
        held: Sequence[Term] = (),
        **others: Any,
    ) -> Problem:
        """Problem of a recording, before anything is known of its noise.

        Parameters
        ----------
        recording : Recording
        tolerance : Tolerance
        physics : sequence of str
            Effects that the data sheet's simulation holds already.
        valve : Valve, default=None
            Data sheet; that of the recording unless given.
        trim : Trim, default=None
            The one that the recording calls for unless given.
        held : sequence of Term, default=()
        **others
            As the class has them.

        Returns
        -------
        problem : Problem
        """
        valve = recording.valve if valve is None else valve
        trim = trim or choose_trim(recording, valve, tolerance)
        channels = channels_of(recording)
        spans = spans_of(recording, channels)
        effects, onsets = _physics_of(held)
        choking = "choked_flow" in physics and _knows_drop(recording)
        settings = {"choking": choking, "filtered": others.get("history") is not None}
        plain = chain_for(recording, valve, trim, effects=effects, onsets=onsets, **settings)
        noise = first_noise(spans)
        return cls(
            recording, tolerance, valve, trim, plain, channels, spans, noise, held=tuple(held), **others
        )

    @property
    def choking(self) -> bool:
        """Whether its simulation chokes."""
        return self.plain.choking

    def chain(self, terms: Sequence[Term], recording: Recording | None = None) -> Chain:
        """Chain with the effects of a hypothesis, for the recording of the problem or another one."""
        effects, onsets = self.physics_of(terms)
        if recording is None:
            return self.plain.beside(effects, onsets)
        settings = {"choking": self.choking and _knows_drop(recording), "filtered": self.history is not None}
        return chain_for(recording, self.valve, self.trim, effects=effects, onsets=onsets, **settings)

    def holding(self, terms: Sequence[Term], model: Model) -> Problem:
        """Problem of the same recording whose simulation holds these effects, as if they had been declared.

        Parameters
        ----------
        terms : sequence of Term
        model : Model
            Whose values they begin with.
        """
        keys = tuple(f"{m.effect.key}." for m in terms)
        begun = {name: value for name, value in model.values.items() if name.startswith(keys)}
        return replace(
            self,
            plain=self.chain(terms, self.recording),
            noise=first_noise(self.spans),
            held=(*self.held, *terms),
            held_values=self.held_values | begun,
            sound_values={},
            _memory=_Memory(),
        )

    def without_held(self, term: Term) -> Problem:
        """The problem without one of the effects that it holds."""
        others = tuple(m for m in self.held if m.effect.key != term.effect.key)
        apart = replace(self, held=others, _memory=_Memory())
        return replace(apart, plain=apart.chain(()))

    def with_noise(self, noise: dict[str, Any]) -> Problem:
        """The problem judged by this noise."""
        return replace(self, noise=noise)

    def beside(self) -> Problem:
        """The same problem for a trial: noises that it learns first are not remembered by this one."""
        return replace(self, _memory=_Memory(self._memory.fits, dict(self._memory.noises)))

    def with_sound_values(self, values: dict[str, float]) -> Problem:
        """The problem with the parameters of an actuator that most rows bear out."""
        return replace(self, sound_values=values)

    def physics_of(self, terms: Sequence[Term]) -> tuple[list[Effect], dict[str, Any]]:
        """Effects of a hypothesis, those held included, and the onsets of those that have one."""
        return _physics_of((*self.held, *terms))

    def fit(
        self,
        terms: Sequence[Term],
        *,
        start: Model | None = None,
        attempt: int = 0,
        hold: str | None = None,
        rows: np.ndarray | None = None,
        max_steps: int = 20,
    ) -> Model:
        """Fit of a hypothesis.

        Parameters
        ----------
        terms : sequence of Term
        start : Model, default=None
            Whose values the fit begins with.
        attempt : int, default=0
            Which of an effect's own starts it begins with, for effects that `start` lacks.
        hold : str, default=None
            Prefix of calibration parameters to leave as `start` has them.
        rows : ndarray of bool, default=None
            Rows to use; those of the problem unless given.
        max_steps : int, default=20

        Returns
        -------
        model : Model
        """
        terms = tuple(terms)
        rows = self.rows if rows is None else rows
        chain = self.chain(terms)
        begin = dict(start.values) if start is not None else {}
        values: dict[str, float] = {}
        spreads: dict[str, float] = {}
        predictions: dict[str, np.ndarray] = {}
        likelihood = 0.0
        for channels in self._groups(terms):
            fitted_here = self._telling(terms, channels)
            fixed = self._fitted_elsewhere(terms, channels, values)
            asked = (
                channels,
                _signs(self._touching(terms, channels)),
                tuple(fixed.items()),
                attempt if fitted_here else 0,
                hold,
                max_steps,
                None if rows is None else rows.tobytes(),
                tuple(self.noise[c] for c in channels),
            )
            sign = (*asked, self._origin(chain, begin, fitted_here, channels))
            if sign not in self._memory.fits:
                fit = self._fit_group(
                    chain, channels, fitted_here, begin, attempt, hold, fixed, rows, max_steps
                )
                self._memory.fits[sign] = fit
                if fit.settled:
                    # begun where it ended it would move by rounding, and all that hangs on its values with it
                    self._memory.fits.setdefault(
                        (*asked, self._origin(chain, fit.values, fitted_here, channels)), fit
                    )
            fit = self._memory.fits[sign]
            values |= fit.values
            spreads |= fit.spreads
            predictions |= fit.predictions
            likelihood += fit.log_likelihood
        return Model(terms, chain, values, predictions, likelihood, spreads)

    def _origin(
        self, chain: Chain, begin: dict[str, float], terms: Sequence[Term], channels: Sequence[str]
    ) -> tuple[float | None, ...]:
        """Where a fit begins: equal questions from equal starts have equal answers, whoever asks first."""
        return tuple(begin.get(p.name) for p in self.parameters(chain, channels, terms))

    def _fit_group(
        self,
        chain: Chain,
        channels: Sequence[str],
        terms: Sequence[Term],
        begin: dict[str, float],
        attempt: int,
        hold: str | None,
        fixed: dict[str, float],
        rows: np.ndarray | None,
        max_steps: int,
    ) -> ChannelFit:
        parameters = self.parameters(chain, channels, terms, attempt)
        if hold is not None:
            fixed = fixed | {
                p.name: begin[p.name] for p in parameters if p.name.startswith(hold) and p.name in begin
            }
            parameters = [p for p in parameters if p.name not in fixed]
        return fit_chain(
            chain, parameters, channels, self.noise, start=begin, fixed=fixed, rows=rows, max_steps=max_steps
        )

    def misfits(self, model: Model, channels: Iterable[str]) -> list[Misfit]:
        """Errors of a fitted hypothesis as functions of its parameters, for the groups of channels named.

        Returns
        -------
        misfits : list of Misfit
            One for each group of channels that share parameters and hold one of `channels`.
        """
        groups = [g for g in self._groups(model.terms) if set(g) & set(channels)]
        return [
            Misfit(
                model.chain,
                self.parameters(model.chain, group, self._telling(model.terms, group)),
                group,
                self.noise,
                fixed=model.values,
                rows=self.rows,
            )
            for group in groups
        ]

    def simulate(self, terms: Sequence[Term], values: dict[str, float]) -> Model:
        """A hypothesis with given values, simulated and not fitted."""
        chain = self.chain(terms)
        return Model(tuple(terms), chain, values, simulate_channels(chain, values, self.channels), np.nan, {})

    def residuals(self, model: Model) -> dict[str, np.ndarray]:
        """Recorded minus simulated, by channel."""
        return {c: residual_of(model.chain, model.predictions, c, self.rows) for c in self.channels}

    def with_noise_of(self, model: Model, *, cautious: bool = False, anew: Collection[str] = ()) -> Problem:
        """The problem judged by the noise that a model leaves; `cautious` as in `fit_noise`.

        A channel that no effect of the model touches keeps what was learnt there before, unless it is one of
        `anew`: the fits made with it then hold as well.
        """
        left, noise, learnt = self.residuals(model), {}, self._memory.noises
        for c in self.channels:
            if cautious and self.history is not None:
                noise[c] = self._noise_before(self.history, c, left[c], model)
                continue
            untouched = not self._touching(model.terms, (c,))
            if untouched and c not in anew and (c, cautious) in learnt:
                noise[c] = learnt[c, cautious]
                continue
            noise[c] = noise_of(
                self.recording,
                left[c],
                model.predictions[c],
                model.chain.step,
                c,
                cautious=cautious,
                **self.noise_settings(c),
            )
            if untouched:
                learnt[c, cautious] = noise[c]
        return self.with_noise(noise)

    def _noise_before(self, history: ValveHistory, channel: str, left: np.ndarray, model: Model) -> Any:
        """Noise of a channel as its history has it: learnt where nothing was missing."""
        return as_before(
            history.noise_parts(channel),
            self.recording,
            left,
            model.predictions[channel],
            model.chain.step,
            channel,
        )

    def baseline(self, model: Model, terms: Sequence[Term], fitted: Model) -> Model:
        """What a hypothesis is held against to see how much some of its effects change.

        Against a data sheet that is what no other calibration does as well: the fit without them. Where a
        history knows the calibration it is all that they do: the same calibration without them.

        Parameters
        ----------
        model : Model
        terms : sequence of Term
            Those that stay.
        fitted : Model
            Fitted with these alone.
        """
        return fitted if self.history is None else self.simulate(terms, model.values)

    def noise_settings(self, channel: str) -> dict[str, float]:
        """What a healthy simulation may get wrong of a channel, and how large a sensor's noise may be."""
        sizes = sizes_of_noise(self.tolerated(channel) * self.spans[channel])
        return sizes if self.history is None else sizes | {"timing": TIMING}

    def homoscedastic(self, model: Model, rows: np.ndarray | slice = slice(None)) -> Problem:
        """The problem judged by noise of one size in all rows, that of what a model leaves in `rows`.

        The noise of the best explanation makes little of a poor one's errors.
        """
        left = self.residuals(model)
        squares = {c: left[c][rows] ** 2 for c in self.channels}
        return self.with_noise(
            {
                c: PlainNoise(max(float(np.sqrt(np.nanmean(s))), 1e-12) if np.isfinite(s).any() else 1.0)
                for c, s in squares.items()
            }
        )

    def least_squares(self, model: Model) -> Model:
        """A hypothesis fitted for the least error itself, also from its effects' own starts."""
        prefixes = tuple(f"{m.effect.key}." for m in model.terms)
        bare = {
            name: value
            for name, value in model.values.items()
            if not prefixes or not name.startswith(prefixes)
        }
        white = self.homoscedastic(model)
        fits = [white.fit(model.terms, start=model, max_steps=15)]
        for k in range(2 if prefixes and self.coupled else 0):
            anew = white.fit(model.terms, start=replace(model, values=bare), attempt=k, max_steps=15)
            fits.append(anew)
        best = max(fits, key=lambda fitted: fitted.log_likelihood)
        if self.history is None:
            return best
        # the least error of all is no calibration of this valve, where its history knows better
        return white.judged(self.simulate(best.terms, self.history.expected_of(best.values)))

    def sound(self, model: Model) -> Model:
        """A hypothesis with the actuator as most rows have it, simulated and not fitted.

        Returns
        -------
        sound : Model
            `model` itself where no position is recorded.
        """
        if not self.sound_values:
            return model
        return self.judged(self.simulate(model.terms, model.values | self.sound_values))

    def judged(self, model: Model) -> Model:
        """A simulated hypothesis with its log likelihood, the distance from the priors included."""
        cost = sum(
            robust_cost(m.errors(m.vector.pack(model.values))) for m in self.misfits(model, self.channels)
        )
        return replace(model, log_likelihood=-cost)


def _physics_of(terms: Sequence[Term]) -> tuple[list[Effect], dict[str, Any]]:
    return [m.effect for m in terms], {m.effect.key: m.times for m in terms if m.onset is not None}


def _knows_drop(recording: Recording) -> bool:
    return "p1" in recording and "p2" in recording


def _signs(terms: Iterable[Term]) -> tuple:
    return tuple(sorted((m.sign for m in terms), key=str))
