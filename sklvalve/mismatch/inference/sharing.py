# SPDX-License-Identifier: BSD-3-Clause
"""Which channels share parameters, and which parameters a fit of some channels moves."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from sklvalve.history import ValveHistory
from sklvalve.mismatch.effects.base import Effect
from sklvalve.mismatch.inference.hypothesis import Term
from sklvalve.recording import Recording, Valve
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import calibration_parameters, sound_play
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.given import ACTUATOR_STAGES
from sklvalve.simulation.parameters import Parameter


class Sharing:
    """Part of a problem: it has ``recording, valve, tolerance, trim, plain, channels, held, history``."""

    recording: Recording
    valve: Valve
    tolerance: Tolerance
    trim: Any
    plain: Chain
    channels: tuple[str, ...]
    held: tuple[Term, ...]
    history: ValveHistory | None

    @property
    def coupled(self) -> bool:
        """Whether channels share parameters, because no opening is recorded."""
        return "opening" not in self.recording

    def channels_touched(self, effect: Effect) -> tuple[str, ...]:
        """Channels whose simulation an effect changes."""
        if self.coupled:
            return self.channels
        if effect.stage in ACTUATOR_STAGES:
            return tuple(c for c in self.channels if c == "opening")
        if effect.stage == "position_sensor" or effect.in_loop:
            return self.channels
        return tuple(c for c in self.channels if c == "flow")

    def touched_by(self, terms: Iterable[Term]) -> set[str]:
        """Channels whose simulation some effects change."""
        return {c for m in terms for c in self.channels_touched(m.effect)}

    def _groups(self, terms: Iterable[Term]) -> tuple[tuple[str, ...], ...]:
        stages = {m.effect.stage for m in (*self.held, *terms)}
        joined = self.coupled or "position_sensor" in stages
        return (self.channels,) if joined else tuple((c,) for c in sorted(self.channels))

    def calibration(self, channels: Sequence[str]) -> list[Parameter]:
        """Parameters that the data sheet, or the valve's history, leaves open for some channels."""
        parameters: list[Parameter] = calibration_parameters(self.plain, self.tolerance, channels)
        for term in self._telling(self.held, channels):
            parameters += [q.parameter_of(term.effect.key) for q in term.effect.quantities(self.plain)]
        if self.history is None:
            return parameters
        plays = sound_play(self.recording, self.history.tolerance or Tolerance(), channels)
        return self.history.prior_of([*parameters, *plays])

    def parameters(
        self, chain: Chain, channels: Sequence[str], terms: Iterable[Term], attempt: int = 0
    ) -> list[Parameter]:
        """All that a fit of some channels moves: what the sheet leaves open, and what the effects bring."""
        brought = [q.parameter_of(m.effect.key, attempt) for m in terms for q in m.effect.quantities(chain)]
        return self.calibration(channels) + brought

    def _touching(self, terms: Iterable[Term], channels: Sequence[str]) -> list[Term]:
        return [m for m in terms if self.touched_by([m]) & set(channels)]

    def _telling(self, terms: Iterable[Term], channels: Sequence[str]) -> list[Term]:
        """Members whose parameters a fit of some channels moves."""
        return [
            m for m in self._touching(terms, channels) if not self._is_fitted_elsewhere(m.effect, channels)
        ]

    def _is_fitted_elsewhere(self, effect: Effect, channels: Sequence[str]) -> bool:
        # what a sensor in the loop reads off is the flow's to tell; the opening shows its stops
        return effect.in_loop and channels == ("opening",) and "flow" in self.channels

    def _fitted_elsewhere(
        self, terms: Iterable[Term], channels: Sequence[str], values: dict[str, float]
    ) -> dict[str, float]:
        """Parameters, already fitted, of members that these channels show and do not tell."""
        every = [m.effect for m in (*self.held, *terms)]
        shown = tuple(f"{e.key}." for e in every if self._is_fitted_elsewhere(e, channels))
        return {name: value for name, value in values.items() if shown and name.startswith(shown)}
