# SPDX-License-Identifier: BSD-3-Clause
"""How parameters are shown that several effects share."""

from sklvalve.mismatch.effects.base import Shown

PLAY = Shown("play", "% of travel", 100.0)
OFFSET = Shown("offset", "% of travel", 100.0)
DEVIATION = Shown("deviation", "%", 100.0)
FRICTION = Shown("friction", "% of the spring range", 100.0)
LOSS = Shown("loss, as a multiple of the open valve's own,")
AIR = Shown("air that passes", "%", 100.0)
RATE = Shown("rate", "%/h", 100.0)
