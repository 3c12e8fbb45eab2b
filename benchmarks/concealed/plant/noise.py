# SPDX-License-Identifier: BSD-3-Clause
"""Noise of the meters: the law it is drawn from, and by which the plant's own distances are measured."""

from dataclasses import dataclass

import numpy as np
from numba import njit

from benchmarks.concealed.plant.programs import wander
from benchmarks.concealed.plant.sensors import BITS, FEW_BITS, FLOW_WIDTH, HELD, JITTER, RANGES

# kinds of noise that a record may have more of than usual
KINDS = ("loud", "wandering", "correlated", "growing_with_flow")


# what exception reporting makes of the square of its width, measured on healthy records of the plant
_OF_HELD_X, _OF_HELD_FLOW = 0.12, 0.055
_CONVERTER = 2.5e-4
# standard deviation of the moment at which a channel is read [s]
_LATE = JITTER / np.sqrt(12.0)


def _misread(width, of_held, kinds):
    bits = FEW_BITS if "quantised" in kinds else BITS
    held = of_held * (HELD * width) ** 2 if "compressed" in kinds else 0.0
    return (width / 2.0**bits) ** 2 / 12.0 + held


@dataclass(frozen=True)
class Law:
    """Standard deviations, as shares of the flow meter's span, of travel [1], and in [Pa].

    `correlated` has a time constant of 20 s, so that neighbours correlate with 0.95; `wandering` one of
    `slow` seconds; `turbulence` is a share of the flow. `misread` and `x_misread` are variances that a coarse
    converter and the historian's exception reporting add.
    """

    white: float = 0.002
    correlated: float = 0.0008
    wandering: float = 0.0008
    slow: float = 600.0
    turbulence: float = 0.002
    with_flow: float = 0.0
    x_white: float = 0.0008
    x_wandering: float = 0.0003
    p_white: float = 200.0
    p_wandering: float = 120.0
    misread: float = _CONVERTER**2 / 12.0
    x_misread: float = _CONVERTER**2 / 12.0

    @classmethod
    def drawn(cls, rng, kinds):
        """Law of one record, with more of each kind that is named."""
        loud = 2.5 if "loud" in kinds else 1.0
        return cls(
            white=0.002 * loud * rng.uniform(0.6, 1.2),
            correlated=(0.003 if "correlated" in kinds else 0.0008) * loud,
            wandering=(0.003 if "wandering" in kinds else 0.0008) * loud,
            slow=float(rng.uniform(250.0, 1000.0)),
            turbulence=0.002 * rng.uniform(0.5, 1.2),
            with_flow=1.5 if "growing_with_flow" in kinds else 0.0,
            x_white=0.0008 * loud * rng.uniform(0.5, 1.3),
            x_wandering=0.0003 * loud,
            p_white=200.0 * loud,
            p_wandering=120.0 * loud,
            misread=_misread(FLOW_WIDTH, _OF_HELD_FLOW, kinds),
            x_misread=_misread(1e-2 * RANGES["X"], _OF_HELD_X, kinds),
        )

    def draw(self, rng, n, span, zeros=None):
        """Noise of each signal over `n` seconds: flow [m3/h], its turbulence, opening [1], pressures [Pa].

        `zeros`, role -> error, are those of sensors that were drawn before; they are returned as "zeros" too.
        """
        own = {}
        flow = self.white * rng.standard_normal(n) + self.correlated * wander(rng, n, 20.0)
        flow += self.wandering * wander(rng, n, self.slow)
        drawn = {"flow": span * flow, "turbulence": self.turbulence * wander(rng, n, 2.0)}
        drawn["opening"] = self.x_white * rng.standard_normal(n) + self.x_wandering * wander(rng, n, 500.0)
        for role in ("p1", "p2"):
            own[role] = rng.uniform(-1.2e3, 1.2e3)
            zero = (own if zeros is None else zeros)[role]
            drawn[role] = (
                zero + self.p_white * rng.standard_normal(n) + self.p_wandering * wander(rng, n, 400.0)
            )
        own["temperature"] = rng.uniform(-0.3, 0.3)
        zero = (own if zeros is None else zeros)["temperature"]
        drawn["temperature"] = zero + 0.05 * rng.standard_normal(n)
        return drawn | {"zeros": own if zeros is None else dict(zeros)}

    def envelope(self, flow, span):
        """Factor on the flow meter's noise, row by row."""
        return 1.0 + self.with_flow * np.clip(flow / span, 0.0, 1.0)


@njit
def _innovations(columns, poles, sizes, white):
    """Columns through the Kalman filter of some first-order noises and a white one, divided by its spread."""
    n, width = columns.shape
    many = poles.size
    mean, spread = np.zeros((many, width)), np.eye(many)
    out = np.empty((n, width))
    for k in range(n):
        if k > 0:
            for i in range(many):
                mean[i] *= poles[i]
                for j in range(many):
                    spread[i, j] *= poles[i] * poles[j]
                spread[i, i] += 1.0 - poles[i] ** 2
        shared = spread @ sizes[k]
        variance = white[k] + sizes[k] @ shared
        for c in range(width):
            wrong = columns[k, c]
            for i in range(many):
                wrong -= sizes[k, i] * mean[i, c]
            out[k, c] = wrong / np.sqrt(variance)
            for i in range(many):
                mean[i, c] += shared[i] / variance * wrong
        for i in range(many):
            for j in range(many):
                spread[i, j] -= shared[i] * shared[j] / variance
    return out


def _whitened(columns, parts, white):
    n = len(columns)
    poles = np.array([np.exp(-1.0 / seconds) for seconds, _ in parts])
    sizes = np.column_stack([np.broadcast_to(size, n) for _, size in parts])
    white = np.broadcast_to(np.asarray(white, dtype=float), n)
    return _innovations(
        np.ascontiguousarray(columns), poles, np.ascontiguousarray(sizes), np.ascontiguousarray(white)
    )


def whiten_opening(columns, law, opening):
    """Series of opening [1], one row a second, as multiples of what its sensor's noise leaves unforeseen.

    While the stem moves, a jitter of the scan is an error of the `opening`, of a series as long as these.
    """
    white = law.x_white**2 + law.x_misread + (_LATE * np.gradient(opening)) ** 2 + 1e-9
    return _whitened(columns, [(500.0, law.x_wandering)], white)


def whiten_flow(columns, law, span, flow, opening, by_opening, by_drop, lag):
    """Series of flow [m3/h], as multiples of the noise of a flow that is computed from recorded signals.

    `by_opening` [m3/h] and `by_drop` [m3/h/Pa] say what the noise of position and pressures does to it; both
    are damped as the meter damps. A jitter of the scan is an error of what moves, of flow and opening.
    """
    pole = np.exp(-1.0 / max(lag, 0.3))
    damped = np.sqrt((1.0 - pole) / (1.0 + pole))
    rough = law.envelope(flow, span)
    stem = np.sqrt(law.x_white**2 + law.x_misread + (_LATE * np.gradient(opening)) ** 2)
    parts = [
        (20.0, law.correlated * span * rough),
        (law.slow, law.wandering * span * rough),
        (2.0 + lag, law.turbulence * np.abs(flow) * np.sqrt(2.0 / (2.0 + lag))),
        (max(lag, 0.3), damped * np.hypot(stem * by_opening, np.sqrt(2.0) * law.p_white * by_drop)),
        (500.0, law.x_wandering * by_opening),
        (400.0, np.sqrt(2.0) * law.p_wandering * by_drop),
    ]
    white = (law.white * span * rough) ** 2 + law.misread * span**2 + (_LATE * np.gradient(flow)) ** 2
    return _whitened(columns, parts, white)
