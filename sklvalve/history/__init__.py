# SPDX-License-Identifier: BSD-3-Clause
"""What is known of one valve from recordings in which nothing was missing: the prior of a diagnosis.

In the order of the data: `learning` calibrates the simulation on the recordings and keeps, of every window of
rows, what it says of the calibration; `posterior` makes of these what is expected of the next recording;
`allowance` is what may change without a fault, `operating_range` where the valve has been, `sources` from
which recordings that is known. `ValveHistory` holds all of it; `learnable` and `compatible` say what must
hold of its recordings, and of the one that is held against it; `by_itself` is what a diagnosis of the
recordings themselves said; `state` makes it plain data and back.
"""

from sklvalve.history.allowance import Allowance
from sklvalve.history.by_itself import ByItself
from sklvalve.history.valve_history import ValveHistory

__all__ = ["Allowance", "ByItself", "ValveHistory"]
