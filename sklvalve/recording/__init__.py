# SPDX-License-Identifier: BSD-3-Clause
"""What was measured: signals by role, in SI, on one time base; and what is wrong with the data themselves."""

from sklvalve.recording.diagnosable import require_diagnosable
from sklvalve.recording.errors import InputError
from sklvalve.recording.from_file import read_recording
from sklvalve.recording.joined import join_recordings
from sklvalve.recording.noise import noise_floor
from sklvalve.recording.recording import Recording
from sklvalve.recording.screening import screen_recording
from sklvalve.recording.valve import Valve, read_valve

__all__ = [
    "InputError",
    "Recording",
    "Valve",
    "join_recordings",
    "noise_floor",
    "read_recording",
    "read_valve",
    "require_diagnosable",
    "screen_recording",
]
