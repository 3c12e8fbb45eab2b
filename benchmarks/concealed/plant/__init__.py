# SPDX-License-Identifier: BSD-3-Clause
"""A control valve in its loop, simulated finely, for records in which an effect is concealed.

It shares no code with the simulations of the package: LuGre friction taken implicitly, a digital positioner
over two volumes of air, a tabulated trim with ripples, a soft transition to choking, a column of water, and a
chain from sensor to historian.
"""

from benchmarks.concealed.plant.effects import EFFECTS, NAMED, OUTSIDE
from benchmarks.concealed.plant.rig import COURSES, Course, Plant

__all__ = ["COURSES", "EFFECTS", "NAMED", "OUTSIDE", "Course", "Plant"]
