# SPDX-License-Identifier: BSD-3-Clause
"""The arrays that the pictures of a diagnosis are drawn from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from sklvalve.history.then import scatter_then, simulation_then
from sklvalve.recording.calendar_time import first_stamp

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.recording import Recording
    from sklvalve.simulation import ValveSimulation


def traces_of(
    whole: Recording,
    flagged: np.ndarray,
    used: int,
    nominal: ValveSimulation,
    corrected: ValveSimulation,
    history: ValveHistory | None = None,
) -> dict[str, Any]:
    """Arrays for pictures, of every row, in the recording's own units.

    Parameters
    ----------
    whole : Recording
    flagged : ndarray of bool
        Of the rows used.
    used : int
    nominal, corrected : ValveSimulation
    history : ValveHistory, default=None
        Whose simulation is ``then``, and the standard deviation of its signals ``then_scatter``; traces
        without a history have no such keys.
    """

    def as_recorded(signals: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {r: whole.in_recorded_units(r, v) for r, v in signals.items() if r in ("opening", "flow")}

    def differences(signals: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        return {r: v * abs(whole.per_si(r)) for r, v in signals.items() if r in ("opening", "flow")}

    then = {}
    if history is not None:
        then["then"] = as_recorded(simulation_then(history).simulate(whole))
        then["then_scatter"] = differences(scatter_then(history, whole))
    roles = [r for r in ("command", "opening", "flow", "p1", "p2", "temperature") if r in whole]
    shown = np.zeros(len(whole), dtype=bool)
    shown[: len(flagged)] = flagged
    return {
        "time": whole.time - whole.time[0],
        "units": {r: whole.unit(r) for r in roles},
        "recorded": {r: whole.in_recorded_units(r, whole[r]) for r in roles},
        "nominal": as_recorded(nominal.simulate(whole)),
        "corrected": as_recorded(corrected.simulate(whole)),
        **then,
        "dp": whole["p1"] - whole["p2"] if "p1" in whole and "p2" in whole else None,
        "pressure_ratio": nominal.chain_of(whole).pressure_ratio,
        "flagged": shown,
        "begins": [low for low, _ in whole.spans],
        "until": None if used == len(whole) else used,
        "first_stamp": first_stamp(whole),
    }
