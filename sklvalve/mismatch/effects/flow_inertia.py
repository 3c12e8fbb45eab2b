# SPDX-License-Identifier: BSD-3-Clause
"""A column of liquid that must be set in motion before the flow follows the valve."""

from math import tanh

import numba as nb
import numpy as np

from sklvalve.mismatch.effects._defects import FOLLOWING
from sklvalve.mismatch.effects.base import Effect, Quantity
from sklvalve.simulation.calibration import span_of
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_STEEL = 4e7
# of the line between the taps [m], and of a liquid in one that long [m/s]
_BETWEEN_TAPS, _FASTEST = 1000.0, 2.0


@nb.njit(cache=True, nogil=True)
def water_column(steady: np.ndarray, step: np.ndarray, drop: np.ndarray, inertance: np.ndarray) -> np.ndarray:
    """Flow of a rigid column of liquid through a valve that would pass `steady` at rest.

    Parameters
    ----------
    steady : ndarray of shape (n,)
        Flow that valve and pressure drop would let through for good [m3/s]; a gap (NaN) stays one
        and takes its time.
    step, drop, inertance : ndarray of shape (n,)
        Time since the sample before [s], size of the pressure drop [Pa], and density times length over cross
        section of the column [kg/m4].

    Returns
    -------
    flow : ndarray of shape (n,)
        [m3/s].
    """
    out = np.empty_like(steady)
    q, passed = np.nan, 0.0
    for k in range(len(steady)):
        s = steady[k]
        passed += step[k]
        if not (s == s and drop[k] == drop[k]):
            out[k] = np.nan
            continue
        if q != q or s == 0.0 or q / s < 0.0 or inertance[k] <= 0.0:
            q = s
        else:
            # exact while valve and drop stand still: y = Q / Q_s obeys dy/dt = (1 - y2) dp / (I Q_s)
            t = tanh(passed * drop[k] / (inertance[k] * abs(s)))
            y = q / s
            q = s * (y + t) / (1.0 + y * t)
        passed = 0.0
        out[k] = q
    return out


class FlowInertia(Effect):
    r"""Inertia of the liquid in the line, for which the drop over the valve must first do work.

    .. math:: \rho\, \frac{L}{A}\, \dot Q = \Delta p - \rho \Bigl(\frac{Q}{N_1 K_v}\Bigr)^2

    A lag of :math:`\rho L Q / (2 A \Delta p)`: long at large flows and small drops, which a sensor's damping
    is not. Rigid column: waves, and what happens faster than a sample, are left out. Without choking.
    """

    name = key = "flow_inertia"
    kind = "property"
    block, stage = "line", "flow"
    parameters = (Quantity("length_over_area", "1/m", 10.0, _STEEL, (1e4,), log=True),)
    needs = ("flow", "p1", "p2")
    hidden_by = FOLLOWING
    words = "inertia of the liquid in the line"
    clause = "the liquid in the line is slow to follow"
    phrase = "the liquid in the line is slow to follow (length over cross section {length_over_area:.2g} 1/m)"
    separated_by = (
        "Fast steps at two pressure drops: inertia takes less time at the larger drop, a sensor's damping "
        "the same at both."
    )

    def _per_second(self, chain: Chain) -> float:
        """Length over area that makes a lag of one second in the middle of the recording [1/m]."""
        flow = chain.recording["flow"]
        volume = flow / chain.density if chain.recording.mass_flow else flow
        size = float(np.nanmedian(np.abs(chain.dp) / (chain.density * np.maximum(np.abs(volume), 1e-9))))
        return 2.0 * max(size, 1e-9)

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        (q,) = self.parameters
        starts = tuple(
            float(np.clip(lag * self._per_second(chain), 20.0, 0.5 * _STEEL)) for lag in (5.0, 20.0)
        )
        # a transmitter may stand a kilometre of line away, in which no liquid is led at over 2 m/s
        span = span_of(chain.recording["flow"])
        largest = _BETWEEN_TAPS * _FASTEST / (span / 1000.0 if chain.recording.mass_flow else span)
        high = float(np.clip(largest, 100.0 * q.low, q.high))
        return (Quantity(q.name, q.unit, q.low, high, tuple(min(s, 0.5 * high) for s in starts), log=True),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        steady = value / chain.density if chain.recording.mass_flow else value
        inertance = p["length_over_area"] * chain.density
        flow = water_column(steady, chain.step, np.abs(chain.dp), inertance)
        return flow * chain.density if chain.recording.mass_flow else flow

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        return p["length_over_area"] / self._per_second(chain) > tolerance.response
