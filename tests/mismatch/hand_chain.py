# SPDX-License-Identifier: BSD-3-Clause
"""What an effect sees of a chain, by hand."""

from types import SimpleNamespace

import numpy as np

from sklvalve.mechanism import fluid_from
from sklvalve.mismatch.effects import CATALOGUE

BY_KEY = {e.key: e for e in CATALOGUE}
EMPTY = SimpleNamespace(fl=None, fd=None, nominal_size=None, inlet_pipe=None, fluid={})


class Signals(dict):
    """Signals by role; the flow by volume unless said otherwise."""

    mass_flow = False


def chain_of(n=5, **given):
    """What an effect sees of a chain: constant signals, unless given."""
    rows = {
        "p1": np.full(n, 6e5),
        "p2": np.full(n, 4e5),
        "density": np.full(n, 1000.0),
        "temperature": np.full(n, 293.15),
        "clock": np.arange(float(n)),
        "step": np.ones(n),
        "plug": np.linspace(0.0, 1.0, n),
        "onsets": {},
        "first_row": lambda effect: 0,
        "command": np.linspace(0.0, 1.0, n),
        "measured": np.linspace(0.0, 1.0, n),
        "valve": EMPTY,
        "air_closes": False,
        "fluid": fluid_from("oil", density=1000.0),
        "trim": SimpleNamespace(rated=10.0, known=True),
        "recording": Signals(flow=np.full(n, 0.01)),
    } | given
    return SimpleNamespace(**rows | {"dp": rows["p1"] - rows["p2"]})


def apply(key, value, own, chain):
    return BY_KEY[key].apply(np.asarray(value, dtype=float), own, chain)
