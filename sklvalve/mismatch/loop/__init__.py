# SPDX-License-Identifier: BSD-3-Clause
"""Loops known by command and flow only, or by command and another process value."""

from sklvalve.mismatch.loop.diagnose import diagnose_loop
from sklvalve.mismatch.loop.finding import LoopFinding, loop_content, loop_traces
from sklvalve.mismatch.loop.operators import stick_slip
from sklvalve.mismatch.loop.signals import loop_signals
from sklvalve.recording.diagnosable import is_loop

__all__ = [
    "LoopFinding",
    "diagnose_loop",
    "is_loop",
    "loop_content",
    "loop_signals",
    "loop_traces",
    "stick_slip",
]
