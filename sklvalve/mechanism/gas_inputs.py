# SPDX-License-Identifier: BSD-3-Clause
"""Private parts that the gas functions share: one valve with its reducers and one gas, row by row."""

from dataclasses import dataclass

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT
from sklvalve.mechanism.gas_data import sensible
from sklvalve.mechanism.gas_factors import (
    between_reducers,
    choked_drop_ratio,
    expansion_factor,
    fitting_share,
    inlet_share,
)
from sklvalve.mechanism.gas_factors import positive as positive
from sklvalve.mechanism.gas_units import gas_density, rounding_of_constant
from sklvalve.mechanism.piping import fitting_loss

ROUNDING = 32.0 * np.finfo(float).eps


@dataclass(frozen=True)
class Valve:
    """What chokes and what the reducers take, for flow in the direction that each row has."""

    gamma: np.ndarray
    xt: np.ndarray
    fittings: np.ndarray | float
    inlet: np.ndarray | float

    def at(self, kv):
        """Effective flow coefficient kv F_P and choked ratio F_gamma x_TP."""
        capacity, xtp = between_reducers(kv, self.xt, self.fittings, self.inlet)
        return capacity, choked_drop_ratio(self.gamma, xtp)


def valve_of(gamma, xt, backward, nominal_size, inlet_pipe, outlet_pipe):
    gamma, xt = sensible(gamma), sensible(xt)
    if inlet_pipe is None and outlet_pipe is None:
        return Valve(gamma, xt, 0.0, 0.0)
    if nominal_size is None:
        raise ValueError(
            "inlet_pipe or outlet_pipe is given but nominal_size is not: reducers need all three."
        )
    inlet_pipe = nominal_size if inlet_pipe is None else inlet_pipe
    outlet_pipe = nominal_size if outlet_pipe is None else outlet_pipe
    size = sensible(nominal_size)
    # a reversed flow enters by the outlet's reducer
    first = np.where(backward, outlet_pipe, inlet_pipe)
    second = np.where(backward, inlet_pipe, outlet_pipe)
    zeta_sum, zeta_inlet = fitting_loss(size, sensible(first), sensible(second))
    return Valve(gamma, xt, fitting_share(size, zeta_sum), inlet_share(size, zeta_inlet, xt))


def unit_speed(temperature, molar_mass, compressibility, *, basis="mass", strict=False):
    """Root of the specific inverse M / (Z R T): mass flow per kv, pressure and unit of sqrt(x) Y. [s/m]"""
    speed = FLOW_CONSTANT * np.sqrt(gas_density(1.0, temperature, molar_mass, compressibility))
    return speed * rounding_of_constant(basis) if strict else speed


def throughput(x, x_choked):
    """sqrt(x) Y, the flow per capacity: rises with x up to choking and stays there."""
    return np.sqrt(np.minimum(x, x_choked)) * expansion_factor(x, x_choked)


def drop_ratio(through, x_choked):
    """x from sqrt(x) Y below choking, else NaN: the sine form of the cubic, exact for small flows too."""
    triple = 1.5 * through / np.sqrt(x_choked)
    # the flow of a choked valve must not come back as feasible by the rounding of its own root
    triple = np.where(triple < 1.0 - ROUNDING, triple, np.nan)
    root = 2.0 / np.sqrt(3.0) * np.sin(np.arcsin(triple) / 3.0)
    x = 3.0 * x_choked * root * root
    return np.where(x <= 1.0, x, np.nan)[()]
