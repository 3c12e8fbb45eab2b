# SPDX-License-Identifier: BSD-3-Clause
"""Make docs/valve_physics.png: one valve and one juice in every regime of flow (needs sklvalve[plot])."""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from sklvalve.mechanism import LIQUID_STATES, ValveMechanismTransformer, liquid_flow

TARGET = Path(__file__).with_name("valve_physics.png")
P1, TEMPERATURE, OPENING = 6e5, 385.0, 0.6
VALVE = {
    "kv_rated": 6.0,
    "characteristic": "equal_percentage",
    "rangeability": 40.0,
    "fl": [[0.1, 0.95], [1.0, 0.85]],
    "fd": [[0.1, 0.15], [1.0, 0.4]],
    "nominal_size": 0.025,
    "fluid": "sugar juice",
    "brix": 60.0,
}
COLOURS = {
    1: "#9ecae1",
    2: "#deebf7",
    3: "#d5efcf",
    4: "#fee391",
    5: "#fdae6b",
    6: "#fb7c5c",
}
LITRES = 6e4
INK = "#08306b"


def features(opening, drop):
    """Flow [l/min], state, kv and density of the valve for openings and pressure drops that broadcast."""
    opening, drop = np.broadcast_arrays(opening, drop)
    X = np.column_stack([opening.ravel(), np.full(opening.size, P1), P1 - drop.ravel()])
    X = np.column_stack([X, np.full(opening.size, TEMPERATURE)])
    valve = ValveMechanismTransformer(temperature=3, features=["flow", "state", "kv", "density"], **VALVE)
    flow, state, kv, density = valve.fit_transform(X).T.reshape(4, *opening.shape)
    return LITRES * flow, state.astype(int), kv, density


def shade(axes, drop, state):
    """Colour the regimes over the pressure drop."""
    edges = np.flatnonzero(np.diff(state)) + 1
    starts, ends = [0, *edges], [*edges, len(state) - 1]
    for start, end in zip(starts, ends, strict=True):
        axes.axvspan(drop[start], drop[end], color=COLOURS[state[start]], lw=0)


def flow_over_drop(axes, drop):
    """Flow against pressure drop, with what the turbulent equation alone would give."""
    flow, state, kv, density = features(OPENING, drop)
    shade(axes, drop / 1e3, state)
    turbulent = LITRES * liquid_flow(kv, P1, P1 - drop, density)
    axes.plot(drop / 1e3, turbulent, "--", color="0.4", lw=1, label="turbulent equation alone")
    axes.plot(drop / 1e3, flow, color=INK, lw=2, label="flow")
    axes.set(xlabel="pressure drop [kPa]", ylabel="flow [l/min]", xlim=(drop[0] / 1e3, drop[-1] / 1e3))


def flow_over_opening(axes, drop):
    """Flow against opening at one pressure drop."""
    opening = np.linspace(0.02, 1.0, 2000)
    flow, state, kv, density = features(opening, drop)
    shade(axes, opening, state)
    axes.plot(opening, LITRES * liquid_flow(kv, P1, P1 - drop, density), "--", color="0.4", lw=1)
    axes.plot(opening, flow, color=INK, lw=2)
    axes.set(xlabel="opening", ylabel="flow [l/min]", yscale="log", xlim=(opening[0], 1.0))


def flow_by_drops(axes):
    """Flow against opening, a line for each of some pressure drops; choked flow is the upper edge."""
    opening, drop = np.linspace(0.05, 1.0, 160), np.geomspace(0.01, 0.99 * P1, 600)
    flow, state, _, _ = features(opening[None, :], drop[:, None])
    colours = ListedColormap([COLOURS[code] for code in sorted(COLOURS)])
    norm = BoundaryNorm(np.arange(0.5, 7.5), colours.N)
    axes.pcolormesh(
        *np.broadcast_arrays(opening[None, :], flow), state, cmap=colours, norm=norm, rasterized=True
    )
    for kilopascals in (0.01, 0.1, 1, 10, 100):
        line = features(opening, 1e3 * kilopascals)[0]
        axes.plot(opening, line, color=INK, lw=1)
        axes.annotate(
            f"{kilopascals:g} kPa", (0.72, 0.45 * np.interp(0.72, opening, line)), color=INK, fontsize=8
        )
    axes.plot(opening, flow[-1], color="#d94801", lw=3)
    axes.annotate("choked, flashing", (0.1, 2.2 * np.interp(0.4, opening, flow[-1])), color="#d94801")
    axes.set(
        xlabel="opening",
        ylabel="flow [l/min]",
        yscale="log",
        xlim=(0.05, 1.0),
        ylim=(1e-2, 2.0 * flow[-1, -1]),
    )


def picture():
    """The figure: flow over pressure drop in full and where it chokes, and over opening."""
    mpl.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False})
    figure, places = plt.subplot_mosaic([["whole"] * 3, ["end", "travel", "plane"]], figsize=(10, 6.8))
    flow_over_drop(places["whole"], np.geomspace(0.3, 0.99 * P1, 4000))
    places["whole"].set(xscale="log", yscale="log", title="Flow against pressure drop, opening 0.6")
    flow_over_drop(places["end"], np.linspace(1e3, 0.99 * P1, 4000))
    places["end"].set(title="The same, linear", ylim=(0, None))
    places["end"].legend(frameon=False, loc="lower right", fontsize=8)
    flow_over_opening(places["travel"], 3.6e5)
    places["travel"].set(title="Flow against opening, 360 kPa")
    flow_by_drops(places["plane"])
    places["plane"].set(title="Flow against opening, by drop")
    names = [Patch(color=colour, label=LIQUID_STATES[code]) for code, colour in COLOURS.items()]
    figure.legend(handles=names, ncols=6, loc="lower center", frameon=False)
    figure.tight_layout(rect=(0, 0.04, 1, 1))
    return figure


if __name__ == "__main__":
    mpl.use("Agg")
    picture().savefig(TARGET, dpi=100)
