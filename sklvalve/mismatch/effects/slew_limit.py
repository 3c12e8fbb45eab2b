# SPDX-License-Identifier: BSD-3-Clause
"""A stem that travels no faster than a limit."""

from typing import Any

import numpy as np

from sklvalve.mismatch.effects._defects import MOVES
from sklvalve.mismatch.effects._response import slowest
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.electric import knows_air
from sklvalve.simulation.stages import limited_rate
from sklvalve.simulation.tolerance import Tolerance

_SPEED = Shown("largest speed", "%/s", 100.0)
_CLOSING_RATIO = Shown("speed of closing over that of opening")


def _stroke_time(speed: float) -> float:
    """Time of a whole stroke, as valve.toml has it [s]."""
    return 1.0 / speed


class SlewLimit(Effect):
    r"""Travel at a limited speed, of its own in each direction: :math:`-v_{close} \le \dot x \le v_{open}`.

    Electric actuators run at one speed; pneumatic ones do where little air passes.
    """

    name = key = "slew_limit"
    kind, declared_as = "property", "stroke_time"
    block, stage = "actuator", "signal"
    parameters: tuple = (
        Quantity(
            "speed", "1/s", 0.001, 1.0, (0.1, 0.02), log=True, null=None, shown=_SPEED, declared=_stroke_time
        ),
        Quantity("closing_ratio", "1", 0.25, 4.0, (1.0,), log=True, null=None, shown=_CLOSING_RATIO),
    )
    needs = ("command",)
    hidden_by = MOVES
    words = "a limited stroking speed"
    clause = "the stroking speed is limited"
    phrase = (
        "the stem opens at {speed:.1%} of travel a second at most (closing {closing_ratio:.2g} times that)"
    )
    separated_by = (
        "Steps of three sizes: a slew limit takes longer the larger the step, a dead time does not."
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return limited_rate(value, chain.step, p["speed"], p["speed"] * p["closing_ratio"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        # positioner and actuator each may take their response time for a stroke, or as long as is declared
        slow = 0.5 / slowest(chain, tolerance, late)
        if chain.valve.stroke_time is not None:
            slow = min(slow, 1.0 / ((1.0 + tolerance.declared) * chain.valve.stroke_time))
        return p["speed"] * min(p["closing_ratio"], 1.0) < slow

    def possible(self, chain: Chain) -> bool:
        return not chain.electric

    def kind_of(self, chain: Chain, late: bool) -> str:
        # air that fills a chamber slowly may do so by design, or for a clogged filter
        kind = super().kind_of(chain, late)
        return "either" if kind == "property" and knows_air(chain.valve, chain.recording) else kind


class MotorSpeed(SlewLimit):
    """Speed of an electric actuator, which runs at it whatever the error."""

    key = "slew_limit_motor"
    stage = "actuator"
    motor = True

    def quantities(self, chain: Chain) -> tuple[Quantity, ...]:
        speed, ratio = self.parameters
        fastest = _usual_speed(chain)
        starts = speed.starts if fastest is None else (float(np.clip(fastest, 0.0011, 0.99)), *speed.starts)
        return (Quantity("speed", "1/s", speed.low, speed.high, starts, log=True, null=None), ratio)

    def apply(self, value: Any, p: dict[str, float], chain: Chain) -> Any:
        up = np.full_like(value["up"], p["speed"])
        return value | {"up": up, "down": up * p["closing_ratio"]}

    def possible(self, chain: Chain) -> bool:
        return chain.electric


def _usual_speed(chain: Chain) -> float | None:
    """Speed at which most of a recorded travel is made [1/s]: where a fit begins; None without travel."""
    if chain.measured is None:
        return None
    # over a second or three samples, whichever is longer: sensors are read more seldom than recorded
    many = max(int(np.ceil(1.0 / np.median(chain.step))), 3)
    moved = np.abs(chain.measured[many:] - chain.measured[:-many])
    speed = moved / (chain.time[many:] - chain.time[:-many])
    known = np.isfinite(speed) & (moved > 0.002)
    if known.sum() < 10:
        return None
    order = np.argsort(speed[known])
    travelled = np.cumsum(moved[known][order])
    return float(speed[known][order][np.searchsorted(travelled, 0.7 * travelled[-1])])
