# SPDX-License-Identifier: BSD-3-Clause
"""One valve, simulated: a chain of stages from command to recorded signals."""

from sklvalve.simulation.simulation import ValveSimulation
from sklvalve.simulation.tolerance import Tolerance

__all__ = ["Tolerance", "ValveSimulation"]
