# SPDX-License-Identifier: BSD-3-Clause
"""Whether a recording is of a kind for which it was checked how often names hold.

That was done on simulated valves with a data sheet, in liquid, driven by air: 2,400 to 4,800 rows, one a
second, of command, flow, inlet pressure, opening and outlet pressure, or of all but one of the last two.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sklvalve.mismatch.effects.gas_expansion import GasExpansion

if TYPE_CHECKING:
    from sklvalve.mismatch.inference.problem import Problem
    from sklvalve.recording import Recording

#: Half of the fewest and twice the most rows that were checked, between which the share that holds did not
#: change with them; and so with the time between rows [s].
ROWS = (1_200, 9_600)
SAMPLE_TIME = (0.5, 2.0)
_MAY_LACK = ("opening", "p2")


def few_signals(recording: Recording) -> bool:
    """Whether the opening or a pressure is not recorded."""
    return any(role not in recording for role in (*_MAY_LACK, "p1"))


def unchecked(problem: Problem) -> str:
    """Why it was not checked how often names hold on recordings such as this one.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    reason : str
        Words that follow "for"; empty where it was checked.
    """
    recording, chain, valve = problem.recording, problem.plain, problem.valve
    low, high = SAMPLE_TIME
    answers = (
        (_is_external(recording), "simulations other than the package's own"),
        (bool(recording.pieces), "several recordings at once"),
        (GasExpansion().possible(chain), "gas"),
        ("flow" not in recording or "command" not in recording, "recordings without flow or command"),
        ("p1" not in recording, "recordings without the inlet pressure"),
        (sum(role not in recording for role in _MAY_LACK) > 1, "recordings with so few signals"),
        (
            valve.kv_rated is None or valve.characteristic is None,
            "valves without a data sheet of capacity and characteristic",
        ),
        (chain.electric or valve.supply_pressure is None, "actuators that are not driven by air"),
        (not low <= recording.sample_time <= high, f"rows {recording.sample_time:.3g} s apart"),
        (not ROWS[0] <= len(recording) <= ROWS[1], f"recordings of {len(recording)} rows"),
    )
    return next((reason for is_so, reason in answers if is_so), "")


def _is_external(recording: Recording) -> bool:
    return "simulated_flow" in recording or "simulated_opening" in recording
