# SPDX-License-Identifier: BSD-3-Clause
"""The physical features that `ValveMechanismTransformer` can give out, by name."""

import numpy as np

FEATURES = {
    "opening": "relative travel [1]",
    "dp": "pressure drop p1 - p2 [Pa]",
    "sqrt_dp_over_density": "signed root of pressure drop over density [m/s]",
    "pressure_ratio": "pressure drop over p1 - F_F p_v of a liquid; choking sets in at F_L squared [1]",
    "dp_choked": "pressure drop at the onset of choking [Pa]",
    "choked": "1 where the pressure drop is that of choked flow, else 0 [1]",
    "state": "code of the flow's state, see LIQUID_STATES and GAS_STATES [1]",
    "p_vc": "pressure of a liquid at the vena contracta [Pa]",
    "sigma": "cavitation index of a liquid; infinite without a pressure drop [1]",
    "xf": "pressure drop over p1 - p_v of a liquid, one over sigma [1]",
    "xfz": "the x_F at which a liquid begins to cavitate [1]",
    "x": "pressure drop of a gas over the pressure before the valve [1]",
    "x_choked": "the x at which the flow of a gas chokes, F_gamma x_TP [1]",
    "expansion_factor": "expansion factor Y of a gas [1]",
    "f_gamma": "specific heat ratio factor of a gas [1]",
    "density": "density before the valve [kg/m3]",
    "vapour_pressure": "vapour pressure of the liquid [Pa]",
    "kinematic_viscosity": "kinematic viscosity before the valve [m2/s]",
    "ff": "critical pressure ratio factor of the liquid [1]",
    "relative_capacity": "kv over kv_rated by the characteristic [1]",
    "kv": "flow coefficient by the characteristic [m3/h]",
    "required_kv": "flow coefficient that passes the measured flow [m3/h]",
    "required_opening": "relative travel that passes the measured flow [1]",
    "fl": "pressure recovery factor at the travel [1]",
    "fd": "valve style modifier at the travel [1]",
    "xt": "pressure drop ratio factor for a gas at the travel [1]",
    "fp": "piping geometry factor; 1 without reducers [1]",
    "flp": "pressure recovery factor with the inlet's reducer; fl without reducers [1]",
    "xtp": "pressure drop ratio factor with reducers; xt without [1]",
    "reynolds": "valve Reynolds number of the flow by the mechanism [1]",
    "fr": "Reynolds factor, what viscosity leaves of the turbulent flow [1]",
    "flow": "flow by the mechanism from the pressures [m3/s], of a gas by its basis",
    "mass_flow": "the same as mass flow [kg/s]",
    "outlet_pressure": "outlet pressure by the mechanism from the flow [Pa]",
    "inlet_pressure": "inlet pressure by the mechanism from flow and outlet pressure [Pa]",
}
"""Every feature by name: each is an attribute of `LiquidRows`, of `GasRows` or of both."""

DEFAULT_FEATURES = (
    "relative_capacity",
    "dp",
    "sqrt_dp_over_density",
    "pressure_ratio",
    "x",
    "density",
    "vapour_pressure",
)
"""The features that need no datum of the valve but its characteristic."""


def check_names(names):
    """ValueError with the names that there are, where one is none of them."""
    unknown = [name for name in names if name not in FEATURES]
    if unknown:
        raise ValueError(f"unknown feature {unknown[0]!r} in features: use some of {', '.join(FEATURES)}.")


def compute_features(rows, names, n_rows):
    """Matrix of shape (n_rows, n_names) of the named features."""
    out = np.empty((n_rows, len(names)))
    for column, name in enumerate(names):
        # a constant fluid gives one number for all rows
        out[:, column] = rows.feature(name)
    return out
