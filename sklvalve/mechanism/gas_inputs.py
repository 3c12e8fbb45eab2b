# SPDX-License-Identifier: BSD-3-Clause
"""Private parts that the gas functions share: one valve with its reducers and one gas, row by row."""

from dataclasses import dataclass

import numpy as np

from sklvalve.mechanism._constants import FLOW_CONSTANT
from sklvalve.mechanism.gas_factors import choked_drop_ratio, fitting_share, inlet_share
from sklvalve.mechanism.gas_units import gas_density
from sklvalve.mechanism.piping import fitting_loss
from sklvalve.mechanism.validity import warn_rows

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
        square = kv * kv
        loss = positive(1.0 + self.fittings * square)
        xtp = self.xt * loss / positive(1.0 + self.inlet * square)
        return kv / np.sqrt(loss), choked_drop_ratio(self.gamma, xtp)


def valve_of(gamma, xt, backward, nominal_size, inlet_pipe, outlet_pipe):
    gamma, xt = positive(gamma), positive(xt)
    if inlet_pipe is None and outlet_pipe is None:
        return Valve(gamma, xt, 0.0, 0.0)
    if nominal_size is None:
        raise ValueError(
            "inlet_pipe or outlet_pipe is given but nominal_size is not: reducers need all three."
        )
    inlet_pipe = nominal_size if inlet_pipe is None else inlet_pipe
    outlet_pipe = nominal_size if outlet_pipe is None else outlet_pipe
    size = positive(nominal_size)
    # a reversed flow enters by the outlet's reducer
    first = np.where(backward, outlet_pipe, inlet_pipe)
    second = np.where(backward, inlet_pipe, outlet_pipe)
    zeta_sum, zeta_inlet = fitting_loss(size, positive(first), positive(second))
    return Valve(gamma, xt, fitting_share(size, zeta_sum), inlet_share(size, zeta_inlet, xt))


def positive(values):
    """The values as floats, NaN where they are not positive."""
    values = np.asarray(values, dtype=float)
    return np.where(values > 0.0, values, np.nan)[()]


def unit_speed(temperature, molar_mass, compressibility):
    """Root of the specific inverse M / (Z R T): mass flow per kv, pressure and unit of sqrt(x) Y. [s/m]"""
    return FLOW_CONSTANT * np.sqrt(gas_density(1.0, temperature, molar_mass, compressibility))


def throughput(x, x_choked):
    """sqrt(x) Y, the flow per capacity: rises with x up to choking and stays there."""
    limited = np.minimum(x, x_choked)
    return np.sqrt(limited) * (1.0 - limited / (3.0 * x_choked))


def drop_ratio(through, x_choked):
    """x from sqrt(x) Y below choking, else NaN: the sine form of the cubic, exact for small flows too."""
    triple = 1.5 * through / np.sqrt(x_choked)
    # the flow of a choked valve must not come back as feasible by the rounding of its own root
    triple = np.where(triple < 1.0 - ROUNDING, triple, np.nan)
    root = 2.0 / np.sqrt(3.0) * np.sin(np.arcsin(triple) / 3.0)
    x = 3.0 * x_choked * root * root
    return np.where(x <= 1.0, x, np.nan)[()]


def warn_gas(where, gamma, xt):
    gamma, xt = np.asarray(gamma, dtype=float), np.asarray(xt, dtype=float)
    what = "have a gamma outside 1.08 to 1.65, for which F_gamma is known."
    warn_rows((gamma < 1.08) | (gamma > 1.65), where, what, stacklevel=4)
    warn_rows(
        (gamma <= 0.0) | (xt <= 0.0), where, "have a gamma or xt that is not positive: NaN.", stacklevel=4
    )
