# SPDX-License-Identifier: BSD-3-Clause
"""A loop's finding as traces that pictures are drawn from."""

import numpy as np

from sklvalve.recording.calendar_time import first_stamp


def loop_traces(finding, whole, used):
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
        As `Diagnosis` keeps them. Simulated values stand between those of the thinned rows on straight
        lines, and are NaN behind the rows used.
    """
    role = "flow" if "flow" in whole else "process_value"
    begun = whole.time - whole.time[0]
    named, made = finding.verdict == "named", {}
    for kind in ("nominal", "corrected"):
        # a stem that sticks was tried in any case, and is shown where it was taken up
        values = finding.predictions.get(kind if named else "nominal")
        if values is not None:
            seen = finding.predictions["time"]
            known = np.interp(whole.time, seen, values)
            known[used:] = np.nan
            if len(finding.sampling.get("stretches", ())) > 1:
                # of a long record one stretch was simulated
                known[(whole.time < seen[0]) | (whole.time > seen[-1])] = np.nan
            made[kind] = known
    flagged = np.zeros(len(whole), dtype=bool)
    if named and len(made) == 2:
        # where a stem that sticks makes another value than one that does not
        gap = np.abs(np.nan_to_num(made["corrected"] - made["nominal"]))
        flagged = gap > max(0.25 * float(np.quantile(gap, 0.99)), 0.0)
    roles = [r for r in ("command", role, "setpoint") if r in whole]
    return {
        "time": begun,
        "units": {r: whole.unit(r) for r in roles},
        "recorded": {r: whole.in_recorded_units(r, whole[r]) for r in roles},
        "nominal": {},
        "corrected": {},
        "dp": None,
        "pressure_ratio": None,
        "flagged": flagged,
        "until": None if used == len(whole) else used,
        "first_stamp": first_stamp(whole),
    } | {kind: {role: whole.in_recorded_units(role, values)} for kind, values in made.items()}
