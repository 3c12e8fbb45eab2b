# SPDX-License-Identifier: BSD-3-Clause
"""A loop's finding as traces that pictures are drawn from."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sklvalve.mismatch.loop.finding import LoopFinding
from sklvalve.mismatch.loop.signals import value_role
from sklvalve.recording.calendar_time import first_stamp
from sklvalve.recording.recording import Recording


def loop_traces(finding: LoopFinding, whole: Recording, used: int) -> dict[str, Any]:
    """Arrays for pictures, of every row, in the recording's own units.

    Parameters
    ----------
    finding : LoopFinding
        Made on the first `used` rows.
    whole : Recording
    used : int

    Returns
    -------
    traces : dict
        As `Diagnosis` keeps them. Simulated values stand between those of the averaged rows on straight
        lines, and are NaN behind the rows used.
    """
    role, named = value_role(whole), finding.verdict == "named"
    # a stem that sticks was tried in any case, and is shown where it was taken up
    sources = {"nominal": "nominal", "corrected": "corrected" if named else "nominal"}
    simulated = {
        kind: _at_every_row(finding, finding.predictions[source], whole, used)
        for kind, source in sources.items()
    }
    roles = [r for r in ("command", role, "setpoint") if r in whole]
    return {
        "time": whole.time - whole.time[0],
        "units": {r: whole.unit(r) for r in roles},
        "recorded": {r: whole.in_recorded_units(r, whole[r]) for r in roles},
        "nominal": {},
        "corrected": {},
        "dp": None,
        "pressure_ratio": None,
        "flagged": _apart(simulated) if named else np.zeros(len(whole), dtype=bool),
        "until": None if used == len(whole) else used,
        "first_stamp": first_stamp(whole),
    } | {kind: {role: whole.in_recorded_units(role, values)} for kind, values in simulated.items()}


def _at_every_row(finding: LoopFinding, values: NDArray, whole: Recording, used: int) -> NDArray:
    """A simulated value at every recorded row; NaN where nothing was simulated."""
    time = finding.predictions["time"]
    known = np.interp(whole.time, time, values)
    known[used:] = np.nan
    if len(finding.sampling.get("stretches", ())) > 1:
        # of a long record one stretch was simulated
        known[(whole.time < time[0]) | (whole.time > time[-1])] = np.nan
    return known


def _apart(simulated: dict[str, NDArray]) -> NDArray[np.bool_]:
    """Rows in which a stem that sticks makes another value than one that does not."""
    gap = np.abs(np.nan_to_num(simulated["corrected"] - simulated["nominal"]))
    return gap > 0.25 * float(np.quantile(gap, 0.99))
