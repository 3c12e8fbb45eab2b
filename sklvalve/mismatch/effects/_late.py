# SPDX-License-Identifier: BSD-3-Clause
"""Forms of an effect that only a recording that was sound before can tell: no search takes them up."""

import numpy as np

from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.mismatch.effects.clogging import Clogging
from sklvalve.simulation.calibration import span_of
from sklvalve.simulation.chain import Chain

_FREE = Shown("capacity that is left", "%", 100.0)


class Blocked(Effect):
    r"""Passage blocked at every opening: :math:`K_v' = s\,K_v`, with a share s that is left free."""

    name, key = "clogging", "clogging_blocked"
    block, stage = "valve", "capacity"
    parameters = (Quantity("free", "1", 0.0, 1.0, (0.02, 0.3, 0.7), null=1.0, shown=_FREE),)
    needs = ("flow",)
    hidden_by = Clogging.hidden_by
    family = "gain"
    words, clause = Clogging.words, Clogging.clause
    phrase = "the passage is blocked: {free:.0%} of its capacity is left"
    separated_by = "Step the command and read the stem's position: behind a blockage the stem still moves."
    source = "plain"

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return p["free"] * value


class MeterFailed(Effect):
    r"""Flow meter that shows one value: :math:`F' = F_0` whatever flows."""

    name = key = "flow_meter_failure"
    block, stage = "measurement", "flow_meter"
    parameters = (Quantity("reading", "m3/s", -1.0, 1.0, (0.0,), null=None),)
    needs = ("flow",)
    words = "a failed flow meter"
    clause = "the flow meter has failed"
    phrase = "the flow meter shows one value whatever flows"
    separated_by = "Read a second meter, or the level of the tank that the flow fills or drains."
    source = "plain"

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        flow = chain.recording["flow"]
        seen = flow[np.isfinite(flow)]
        span = span_of(flow)
        unit = "kg/s" if chain.recording.mass_flow else "m3/s"
        last = float(np.median(seen[-max(len(seen) // 100, 10) :])) if len(seen) else 0.0
        return (Quantity("reading", unit, -2.0 * span, 2.0 * span, (last, 0.0), null=None),)

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return np.full_like(value, p["reading"])
