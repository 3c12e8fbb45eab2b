# SPDX-License-Identifier: BSD-3-Clause
"""The valve as its history lets expect it: its calibration with intervals, and the simulation with it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sklvalve.simulation.parameters import ParameterVector
from sklvalve.simulation.simulation import ValveSimulation

if TYPE_CHECKING:
    from sklvalve.history.valve_history import ValveHistory
    from sklvalve.recording import Recording

_WITHIN_95 = 1.96
# a history that leaves this share of the sheet's spread has taught nothing of a parameter
_TAUGHT_NOTHING = 0.9
# calibrations by which the scatter of a simulated signal is told; to a fifth
_DRAWN = 16


@dataclass(frozen=True)
class Expected:
    """What a history lets expect of one parameter in a later recording, allowance included.

    Parameters
    ----------
    name, unit : str
        In SI; `unit` is ``"1"`` for a pure number.
    value : float
        Mean.
    low, high : float
        Ends of the interval that holds it with 95 %, within what is possible.
    spread : float
        Standard deviation; of the logarithm where `log`.
    log : bool
        Whether the optimiser moves the logarithm.
    informed : bool
        Whether it is known better than from the data sheet alone.
    """

    name: str
    unit: str
    value: float
    low: float
    high: float
    spread: float
    log: bool
    informed: bool

    def deviations(self, now: float) -> float:
        """How far a later value lies from the mean, in standard deviations [1]."""
        away = np.log(max(now, 1e-300) / self.value) if self.log else now - self.value
        return float(away / self.spread)


def expected_of(history: ValveHistory) -> Iterator[Expected]:
    """What a history lets expect of each parameter of the calibration.

    Parameters
    ----------
    history : ValveHistory
        Fitted.

    Yields
    ------
    expected : Expected
        In the order of the calibration.
    """
    prior, sheet = history.prior_, history.parameters
    size = dict(zip(prior.names, np.sqrt(np.diag(prior.covariance)).tolist(), strict=True))
    for of_sheet, known in zip(sheet, history.prior_of(sheet), strict=True):
        value, spread = known.start, size[known.name]
        half = _WITHIN_95 * spread
        ends = value * np.exp([-half, half]) if known.log else value + np.array([-half, half])
        low, high = np.clip(ends, known.low, known.high)
        informed = of_sheet.spread is None or spread < _TAUGHT_NOTHING * of_sheet.spread
        yield Expected(
            known.name, known.unit, float(value), float(low), float(high), spread, known.log, bool(informed)
        )


def simulation_then(history: ValveHistory) -> ValveSimulation:
    """The simulation with the calibration that a history lets expect, and the physics that it holds.

    A history keeps what its recordings say of the calibration, and not their rows: what a valve did then is
    shown by this simulation.

    Parameters
    ----------
    history : ValveHistory
        Fitted.

    Returns
    -------
    simulation : ValveSimulation

    Examples
    --------
    >>> from sklvalve import Recording, Valve, ValveHistory
    >>> from sklvalve.datasets import make_valve_recording
    >>> from sklvalve.history.then import simulation_then
    >>> made = make_valve_recording(loop="wide", n_samples=900, n_later=0, random_state=3)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> simulation_then(ValveHistory().fit(recording)).score(recording) > 0.99
    True
    """
    return _simulation(history, {each.name: each.value for each in expected_of(history)})


def scatter_then(history: ValveHistory, recording: Recording) -> dict[str, np.ndarray]:
    """How far simulated signals scatter over the calibrations that a history lets expect.

    Parameters
    ----------
    history : ValveHistory
        Fitted.
    recording : Recording
        Whose signals drive the simulation.

    Returns
    -------
    scatter : dict of ndarray of shape (n,)
        Signal of `simulation_then` -> standard deviation of each row, over 16 calibrations drawn with a
        fixed seed [SI].
    """
    prior = history.prior_
    mean, root = prior.of(prior.names)
    drawn = np.random.default_rng(0).standard_normal((_DRAWN, len(mean)))
    vectors = mean + np.linalg.solve(root, drawn.T).T
    known = ParameterVector(history.prior_of(history.parameters))
    made = [
        _simulation(history, known.values(np.clip(vector, known.low, known.high))).simulate(recording)
        for vector in vectors
    ]
    return {name: np.std([each[name] for each in made], axis=0) for name in made[0]}


def _simulation(history: ValveHistory, values: dict[str, float]) -> ValveSimulation:
    return ValveSimulation.from_parts(
        history.valve_,
        history.trim_,
        history.values_ | values,
        choking="choked_flow" in history.valve_.physics,
        effects=history.effects,
    )
