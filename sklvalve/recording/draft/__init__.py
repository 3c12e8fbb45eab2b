# SPDX-License-Identifier: BSD-3-Clause
"""A draft valve.toml out of a recording: names of columns, then values, then the sheet."""

from sklvalve.recording.draft.assumed import assumptions
from sklvalve.recording.draft.columns import RecordingColumns, read_recording_columns
from sklvalve.recording.draft.drafter import Answers, Draft, draft_valve
from sklvalve.recording.draft.roles import Assignment, assign_roles

__all__ = [
    "Answers",
    "Assignment",
    "Draft",
    "RecordingColumns",
    "assign_roles",
    "assumptions",
    "draft_valve",
    "read_recording_columns",
]
