# SPDX-License-Identifier: BSD-3-Clause
"""Private: what the parameters of the transformer may be."""

from numbers import Integral, Real

from sklearn.utils._param_validation import Interval, StrOptions

from sklvalve.mechanism.fluid import Fluid
from sklvalve.mechanism.gas_units import GAS_FLOW_BASES

ROLES = ("opening", "p1", "p2", "temperature", "flow")
OF_LIQUID = ("density", "kinematic_viscosity", "vapour_pressure", "critical_pressure", "brix")
OF_GAS = ("molar_mass", "gamma", "dynamic_viscosity")

_ROLE = [Interval(Integral, 0, None, closed="left"), str, None]
_PROPERTY = [Interval(Real, 0, None, closed="neither"), callable, None]
_POSITIVE = [Interval(Real, 0, None, closed="neither"), None]
_FACTOR = [Interval(Real, 0, None, closed="neither"), "array-like", None]

CONSTRAINTS = {
    "opening": _ROLE,
    "p1": _ROLE,
    "p2": _ROLE,
    "temperature": _ROLE,
    "flow": _ROLE,
    "kv_rated": _POSITIVE,
    "characteristic": [str, "array-like"],
    "rangeability": [Interval(Real, 1, None, closed="neither"), None],
    "shutoff": [Interval(Real, 0, 1, closed="left")],
    "leakage": [Interval(Real, 0, 1, closed="left")],
    "fl": [Interval(Real, 0, 1, closed="right"), "array-like", None],
    "fd": _FACTOR,
    "xt": _FACTOR,
    "xfz": _FACTOR,
    "nominal_size": _POSITIVE,
    "inlet_pipe": _POSITIVE,
    "outlet_pipe": _POSITIVE,
    "strict": ["boolean"],
    "fluid": [str, Fluid],
    "density": _PROPERTY,
    "kinematic_viscosity": _PROPERTY,
    "vapour_pressure": _PROPERTY,
    "critical_pressure": _POSITIVE,
    "brix": [Interval(Real, 0, 85, closed="both"), None],
    "molar_mass": _POSITIVE,
    "gamma": [Interval(Real, 1, None, closed="neither"), None],
    "compressibility": [Interval(Real, 0, None, closed="neither")],
    "dynamic_viscosity": _POSITIVE,
    "basis": [StrOptions(set(GAS_FLOW_BASES))],
    "features": ["array-like", None],
    "output": [StrOptions({"flow", "outlet_pressure"})],
    "warn": ["boolean"],
}
