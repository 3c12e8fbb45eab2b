# SPDX-License-Identifier: BSD-3-Clause
"""Random duties of liquid valves over the whole validity of the equations, for their tests."""

import numpy as np

from sklvalve.mechanism import liquid_flow, valve_reynolds_number


def duties(n, kind="", seed=0):
    """Keyword arguments of `liquid_flow` for n valves, and their pressures and capacities.

    `kind` names what they have: pipes, viscosity (with `kv_rated`), backward.
    """
    rng = np.random.default_rng(seed)
    p1 = rng.uniform(2e5, 5e6, n)
    p2 = p1 * rng.uniform(0.01, 0.99, n)
    size = rng.uniform(0.015, 0.4, n)
    # up to the widest valve for which the standard holds
    kv_rated = 10.0 ** rng.uniform(-4.0, np.log10(0.04), n) * (1e3 * size) ** 2
    kv = kv_rated * rng.uniform(0.02, 1.0, n)
    known = {
        "density": rng.uniform(500.0, 1500.0, n),
        "fl": rng.uniform(0.4, 0.98, n),
        "p_vapour": p1 * rng.uniform(0.0, 0.6, n),
    }
    if "pipes" in kind:
        known |= {"nominal_size": size}
        known |= {name: size * rng.uniform(1.0, 3.0, n) for name in ("inlet_pipe", "outlet_pipe")}
    if "viscosity" in kind:
        known |= {"viscosity": 10.0 ** rng.uniform(-6.5, -0.5, n), "fd": rng.uniform(0.1, 1.0, n)}
        known |= {"nominal_size": size, "kv_rated": kv_rated}
    return (kv, p2, p1, known) if "backward" in kind else (kv, p1, p2, known)


def jet_reynolds(flow, kv, known):
    """Valve Reynolds number of duties with viscosity."""
    pipe = known.get("inlet_pipe", known["nominal_size"])
    return valve_reynolds_number(
        flow, kv, known["viscosity"], fl=known["fl"], fd=known["fd"], inlet_pipe=pipe
    )


def quiet_flow(kv, p1, p2, **known):
    return liquid_flow(kv, p1, p2, **known, warn=False)
