# SPDX-License-Identifier: BSD-3-Clause
"""Screen of the course in time: rows and values that are missing."""

import numpy as np

from sklvalve.recording._screen_tools import Finding, finding
from sklvalve.recording.recording import Recording
from sklvalve.recording.runs import runs


def screen_gaps(recording: Recording) -> list[Finding]:
    """Rows missing between the times, and values missing within the rows."""
    found = []
    step = np.diff(recording.time)
    typical = recording.sample_time
    wide = np.flatnonzero(step > 1.5 * typical)
    if len(wide):
        detail = (
            f"rows missing between samples of {typical:g} s; gaps: {len(wide)}, longest: {step.max():g} s"
        )
        found.append(finding("gap", None, detail, [(int(row), int(row) + 2) for row in wide]))
    for role, values in recording.signals.items():
        spans = runs(np.isnan(values))
        if spans:
            missing = sum(stop - start for start, stop in spans)
            longest = max(stop - start for start, stop in spans)
            detail = f"{missing} of {len(values)} values missing; gaps: {len(spans)}, longest: {longest} rows"
            found.append(finding("gap", role, detail, spans))
    return found
