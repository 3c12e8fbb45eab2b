# SPDX-License-Identifier: BSD-3-Clause
"""From plug and pressures to recorded flow: the hydraulics that is put into real recordings.

Capacities are kv [m3/h at 1 bar], pressures absolute [bar], flows [m3/h], densities relative to 1000 kg/m3.
As in `stem`, every value is an array of a value a row.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.inject.stem import lagged, play

ATMOSPHERE = 1.01325


@dataclass(frozen=True, eq=False)
class Trim:
    """Capacity over opening, straight between knots: what was fitted to the healthy recording."""

    openings: np.ndarray
    capacities: np.ndarray

    def __call__(self, opening):
        """kv at an opening, straight on beyond the outer knots and never below nothing."""
        return np.maximum(_straight(opening, self.openings, self.capacities), 0.0)

    @staticmethod
    def hats(opening, knots):
        """Columns whose weighted sum is a curve straight between knots and beyond them."""
        unit = np.eye(len(knots))
        return np.column_stack([_straight(opening, knots, unit[k]) for k in range(len(knots))])


def _straight(at, x, c):
    inside = np.interp(at, x, c)
    above = c[-1] + (c[-1] - c[-2]) / (x[-1] - x[-2]) * (at - x[-1])
    below = c[0] + (c[1] - c[0]) / (x[1] - x[0]) * (at - x[0])
    return np.where(at > x[-1], above, np.where(at < x[0], below, inside))


@dataclass(frozen=True, eq=False)
class Fluid:
    """What is known of the liquid in each row: inlet and outlet pressure, density, vapour pressure."""

    p1: np.ndarray
    p2: np.ndarray
    density: np.ndarray
    vapour: np.ndarray
    critical: float = 220.64

    @property
    def drop(self):
        """Pressure drop, never below nothing."""
        return np.maximum(self.p1 - self.p2, 0.0)


def flow(opening, trim, fluid, now):
    """Flow as the meter reads it, without noise.

    Parameters
    ----------
    opening : ndarray of shape (n_rows,)
        Of the stem; play between stem and plug (`plug_play`) follows here.
    trim : Trim
    fluid : Fluid
    now : dict of ndarrays of shape (n_rows,)
        `plug_play` and `plug_offset` (1), `capacity` (share on top), `wear` and `reach` (erosion), `leak`
        (parallel kv), `cap` (largest kv), `loss` (1 / kv of fittings in series, squared), `fl`,
        `outside_leak` (kv behind the valve to the atmosphere, before the meter), `meter_gain`, `meter_bias`
        [m3/h], `meter_lag` [rows], `head` [bar on top of the drop]. A missing one does nothing.

    Returns
    -------
    flow : ndarray of shape (n_rows,)
    """
    nothing = np.zeros(len(opening))
    plug = play(opening, now.get("plug_play", nothing), opening[0]) + now.get("plug_offset", nothing)
    kv = trim(plug)
    kv = kv * (1.0 + now.get("capacity", nothing))
    if "wear" in now:
        kv = kv + now["wear"] * np.exp(-np.maximum(plug, 0.0) / np.maximum(now["reach"], 1e-6))
    kv = np.minimum(kv, now.get("cap", np.inf))
    # fittings at the body share the drop: resistances 1 / kv^2 add up
    kv = kv / np.sqrt(1.0 + now.get("loss", nothing) * kv**2)
    drop = np.maximum(fluid.drop + now.get("head", nothing), 0.0)
    if "fl" in now:
        ff = 0.96 - 0.28 * np.sqrt(fluid.vapour / fluid.critical)
        most = now["fl"] ** 2 * np.maximum(fluid.p1 - ff * fluid.vapour, 0.0)
        # a real knee is round: the sixteenth power blends the two branches over a few percent of the drop
        drop = drop * (1.0 + (drop / np.maximum(most, 1e-9)) ** 16) ** (-1.0 / 16.0)
    through = kv * np.sqrt(drop / fluid.density)
    # a seat that leaks and a bypass are passages of their own beside the trim, and see the whole drop
    through = through + now.get("leak", nothing) * np.sqrt(np.maximum(fluid.drop, 0.0) / fluid.density)
    lost = now.get("outside_leak", nothing)
    through = through - lost * np.sqrt(np.maximum(fluid.p2 - ATMOSPHERE, 0.0) / fluid.density)
    read = lagged(through, now.get("meter_lag", nothing), through[0])
    return read * (1.0 + now.get("meter_gain", nothing)) + now.get("meter_bias", nothing)
