# SPDX-License-Identifier: BSD-3-Clause
"""How slow an answer may be and still pass for calibration."""

from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance


def slowest(chain: Chain, tolerance: Tolerance, late: bool) -> float:
    """Longest response that is no mismatch [s].

    A data sheet leaves the response open, but not that it changes while the valve runs: of what began
    within the recording only what is shorter than a sample passes unseen.
    """
    return min(chain.recording.sample_time, tolerance.response) if late else tolerance.response
