# SPDX-License-Identifier: BSD-3-Clause
"""The verdict held against the best black box on the same signals, forward in time."""

from sklvalve.mismatch.referee.black_box import black_box_prediction
from sklvalve.mismatch.referee.comparison import skills_ahead
from sklvalve.mismatch.referee.decision import refereed
from sklvalve.mismatch.referee.entry import referee_entry
from sklvalve.mismatch.referee.forward import Forward, forecast, forward_in_time

__all__ = [
    "Forward",
    "black_box_prediction",
    "forecast",
    "forward_in_time",
    "referee_entry",
    "refereed",
    "skills_ahead",
]
