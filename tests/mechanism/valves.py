# SPDX-License-Identifier: BSD-3-Clause
"""A valve about hot water, in every state of flow, for the tests of the transformer."""

import numpy as np

from sklvalve.mechanism import (
    ValveMechanismTransformer,
    liquid_flow,
    relative_capacity,
    water_density,
    water_vapour_pressure,
)

COLUMNS = ["t", "h", "pin", "pout", "F"]
ROLES = {"opening": "h", "p1": "pin", "p2": "pout", "temperature": "t", "flow": "F"}
VALVE = {"kv_rated": 40.0, "characteristic": "equal_percentage", "rangeability": 30.0, "fl": 0.8}


def duties(n=200, seed=0):
    """Turbulent, choked, reversed and zero drop, about hot water."""
    rng = np.random.default_rng(seed)
    temperature = rng.uniform(340.0, 370.0, n)
    opening = rng.uniform(0.05, 1.0, n)
    p1 = rng.uniform(4e5, 1e6, n)
    p2 = p1 * rng.uniform(0.15, 0.95, n)
    p1[:20], p2[:20] = p2[:20], p1[:20].copy()
    p2[20] = p1[20]
    X = np.column_stack([temperature, opening, p1, p2, np.zeros(n)])
    X[:, 4] = own_flow(X)
    return X


def own_flow(X):
    temperature, opening, p1, p2, _ = X.T
    kv = 40.0 * relative_capacity(opening, "equal_percentage", rangeability=30.0)
    known = {"fl": 0.8, "p_vapour": water_vapour_pressure(temperature)}
    return liquid_flow(kv, p1, p2, water_density(temperature), **known)


def by_position(**settings):
    roles = {role: COLUMNS.index(name) for role, name in ROLES.items()}
    return ValveMechanismTransformer(**{**roles, **VALVE, **settings})
