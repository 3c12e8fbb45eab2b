# SPDX-License-Identifier: BSD-3-Clause
"""Random duties of gas valves, over the validity of the equations, for the tests of the gas functions."""

import numpy as np

KINDS = ("plain", "reducers", "viscous", "viscous reducers")


def duties(kind, n, seed, *, rated=True):
    """Arguments of `gas_flow`: the five positional ones, and the keywords."""
    rng = np.random.default_rng(seed)
    size = rng.uniform(0.01, 0.3, n)
    kv = 10.0 ** rng.uniform(-4.0, np.log10(0.04), n) * (1e3 * size) ** 2
    p1 = 10.0 ** rng.uniform(5.0, 7.0, n)
    p2 = p1 * (1.0 - 10.0 ** rng.uniform(-4.0, 0.0, n))
    temperature, molar_mass = rng.uniform(200.0, 700.0, n), rng.uniform(0.002, 0.1, n)
    known = {
        "gamma": rng.uniform(1.08, 1.65, n),
        "xt": rng.uniform(0.15, 0.84, n),
        "compressibility": rng.uniform(0.7, 1.1, n),
    }
    if "reducers" in kind:
        known["nominal_size"] = size
        known["inlet_pipe"] = size * rng.uniform(1.0, 2.5, n)
        known["outlet_pipe"] = size * rng.uniform(1.0, 2.5, n)
    if "viscous" in kind:
        known["nominal_size"] = size
        # gases have 1e-5 Pa s; the rest is there to reach every regime with every size
        known["dynamic_viscosity"] = 10.0 ** rng.uniform(-5.3, 1.0, n)
        known["fl"], known["fd"] = rng.uniform(0.5, 0.99, n), rng.uniform(0.05, 1.0, n)
        if rated:
            known["kv_rated"] = kv * 10.0 ** rng.uniform(0.0, 1.0, n)
    return (kv, p1, p2, temperature, molar_mass), known
