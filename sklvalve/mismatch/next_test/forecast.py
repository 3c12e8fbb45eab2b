# SPDX-License-Identifier: BSD-3-Clause
"""The record that a program of the command would give, were an explanation true."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import nnls

from sklvalve.simulation.calibration import span_of
from sklvalve.simulation.chain import ATMOSPHERE
from sklvalve.simulation.noise import NoiseModel, movement
from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.hypothesis import Model
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.mismatch.next_test.excitation import Explanation
    from sklvalve.mismatch.next_test.programs import Program
    from sklvalve.recording import Recording
    from sklvalve.simulation.chain import Chain
    from sklvalve.simulation.fitting import PlainNoise

    Noise = NoiseModel | NoiseOfPieces | PlainNoise
    _Makeup = tuple[Noise, float, np.ndarray | None, float]

# what a stem sensor that is yet to be fitted would have: rms of its noise, of its wander, of its zero [1]
_SENSOR, _WANDER, _ZERO = 0.0025, 0.0005, 0.005
# of the median pressure drop
_LEAST_DROP = 0.1
# of the span
_BELOW_ZERO = 0.01


class Present:
    """What foreseen records take from the present one: asked for once, whatever the number of programs.

    Parameters
    ----------
    problem : Problem
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, recording = problem, problem.recording
        self.medians = {role: float(np.nanmedian(recording[role])) for role in recording}
        self.surroundings = Surroundings(recording)
        self._makeups: dict[tuple[Model, str], _Makeup] = {}

    def noise_of(self, model: Model, channel: str, signal: np.ndarray, step: float) -> Noise:
        """Noise of a channel, where a model holds, for another signal."""
        if (model, channel) not in self._makeups:
            self._makeups[model, channel] = _makeup(self.problem, model, channel)
        return _noise_like(*self._makeups[model, channel], signal, step)


class ForecastRecord:
    """A record not yet made: the noise is that of the present recording, its surroundings are medians.

    Parameters
    ----------
    present : Present
    program : Program
    truth : Explanation
    sensor : str, default=None
        ``"opening"`` where a stem sensor is to be fitted first.

    Attributes
    ----------
    recording : Recording
        Without noise; it goes on where the present one ends.
    noise : dict
        Channel -> noise model.
    """

    def __init__(
        self, present: Present, program: Program, truth: Explanation, sensor: str | None = None
    ) -> None:
        problem = present.problem
        self.problem, self.sensor = problem, sensor
        recording, values = problem.recording, truth.model.values
        n, clock = len(program.command), truth.model.chain.clock
        step = recording.sample_time
        signals = {role: np.full(n, median) for role, median in present.medians.items()}
        if "command" in recording:
            signals["command"] = program.command
        if "opening" in recording:
            signals["opening"] = program.command
        surroundings = present.surroundings
        stamps = clock[-1] + step * (1.0 + np.arange(n))
        self.recording = replace(
            recording,
            time=stamps - stamps[0],
            stamps=stamps,
            signals=surroundings.moved(signals, program),
        )
        chain = self.chain_of(truth)
        made = {}
        if "opening" in problem.channels:
            made["opening"] = chain.opening(values)
            self._put(made)
        if "flow" in problem.channels:
            # what flows moves the pressures, and they what flows
            for _ in range(2):
                self._put({"flow": self.chain_of(truth).flow(values)})
                self._put(surroundings.moved(self.recording.signals, program))
            made["flow"] = self.chain_of(truth).flow(values)
            self._put({"flow": made["flow"]})
        self.noise = {c: present.noise_of(truth.model, c, made[c], step) for c in problem.channels}
        if "flow" in made:
            self._leave_out(made["flow"])
        if sensor is not None:
            self._seen = self.chain_of(truth).opening(values)
            white, lag = np.full(n, _SENSOR**2), 300.0 * step
            self._sensor = NoiseModel(white, np.full(n, step), 10.0 * step, 1e-12, lag, _WANDER**2)
            zero = self._sensor.whiten(np.ones(n))
            self._zero = zero / np.sqrt(zero @ zero + _ZERO**-2)

    def _put(self, signals: dict[str, np.ndarray]) -> None:
        self.recording = replace(self.recording, signals=self.recording.signals | signals)

    def _leave_out(self, flow: np.ndarray) -> None:
        """Rows in which a meter would have to show less than it does: most end a little below zero."""
        seen = self.problem.recording["flow"]
        least = min(float(np.nanmin(seen)), -_BELOW_ZERO * span_of(seen))
        noise = self.noise["flow"]
        if isinstance(noise, NoiseModel) and np.any(flow < least):
            self.noise["flow"] = replace(noise, white=np.where(flow < least, np.inf, noise.white))

    def chain_of(self, explanation: Explanation) -> Chain:
        """Stages of an explanation bound to this record."""
        return self.problem.chain(explanation.terms, self.recording)

    def sensed(self, opening: np.ndarray) -> np.ndarray:
        """Whitened errors of an opening at the new sensor, whose zero nobody knows."""
        errors = self._sensor.whiten(self._seen - opening)
        return errors - self._zero * (self._zero @ errors)


class Surroundings:
    """How pressures stand for a flow: by what the recording shows, never beyond what it has seen."""

    def __init__(self, recording: Recording) -> None:
        self.known: dict[str, tuple[float, ...]] = {}
        if "p1" not in recording or "p2" not in recording:
            return
        self.drop = float(np.nanmedian(np.abs(recording["p1"] - recording["p2"])))
        flow = recording.get("flow", np.zeros(len(recording)))
        square = flow * np.abs(flow)
        for role, sign in (("p1", -1.0), ("p2", 1.0)):
            seen = np.isfinite(square) & np.isfinite(recording[role])
            x, y = square[seen], recording[role][seen]
            middle = float(np.median(x)), float(np.median(y))
            scatter = float(np.mean((x - middle[0]) ** 2))
            slope = float(np.mean((x - middle[0]) * (y - middle[1]))) / scatter if scatter > 0.0 else 0.0
            # a pump's pressure falls as more flows, what lies behind the valve rises
            slope = slope if sign * slope > 0.0 else 0.0
            self.known[role] = (*middle, slope, *np.quantile(y, (0.01, 0.99)))

    def shift(self, role: str, share: float | np.ndarray) -> np.ndarray:
        """How far a pressure is moved for a share of the drop [Pa]; into no vacuum that was not there."""
        lowest = self.known[role][3]
        return np.maximum(share * self.drop, min(ATMOSPHERE - lowest, 0.0))

    def moved(self, signals: Mapping[str, np.ndarray], program: Program) -> dict[str, np.ndarray]:
        """Signals with the pressures that go with their flow, and the program's moves of them."""
        signals = dict(signals)
        for role, (x, y, slope, low, high) in self.known.items():
            flow = signals.get("flow", 0.0)
            signals[role] = np.clip(y + slope * (flow * np.abs(flow) - x), low, high)
        signals |= program.signals
        for role, share in program.moved.items():
            signals[role] = signals[role] + self.shift(role, share)
        if program.moved:
            # so much is left to drive the flow
            signals["p2"] = np.minimum(signals["p2"], signals["p1"] - _LEAST_DROP * self.drop)
        return signals


def _makeup(problem: Problem, model: Model, channel: str) -> _Makeup:
    """Noise of a channel, the largest value of its signal, how it goes with that, and its least variance."""
    noise, past = problem.noise[channel], model.predictions[channel]
    if isinstance(noise, NoiseOfPieces):
        rows, noise = noise.longest
        past = past[rows]
    if not isinstance(noise, NoiseModel):
        return noise, 0.0, None, 0.0
    largest = max(float(np.nanmax(np.abs(past))), 1e-12)
    shapes = _shapes(past, noise.step, largest)
    seen = np.isfinite(noise.white) & np.isfinite(shapes).all(axis=1)
    size = float(np.mean(noise.white[seen]))
    scale = np.maximum(shapes[seen].mean(axis=0), 1e-300)
    shares, _ = nnls(shapes[seen] / scale, noise.white[seen] / size)
    return noise, largest, shares * size / scale, 0.1 * float(noise.white[seen].min())


def _noise_like(
    noise: Noise,
    largest: float,
    shares: np.ndarray | None,
    least: float,
    signal: np.ndarray,
    step: float,
) -> Noise:
    """Noise of another signal: its white part grows with that as it did in the recording."""
    if shares is None or not isinstance(noise, NoiseModel):
        return noise
    steps = np.full(len(signal), step)
    white = np.maximum(_shapes(signal, steps, largest) @ shares, least)
    return NoiseModel(white, steps, noise.fast_time, noise.fast_size, noise.slow_time, noise.slow_size)


def _shapes(signal: np.ndarray, step: np.ndarray, largest: float) -> np.ndarray:
    """What the white variance is made of: a constant, the size of the signal, and its movement."""
    level = np.nan_to_num(signal / largest) ** 2
    return np.stack([np.ones(len(signal)), level, movement(signal, step) ** 2], axis=1)
