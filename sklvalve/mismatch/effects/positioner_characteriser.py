# SPDX-License-Identifier: BSD-3-Clause
"""A curve between command and position that the positioner was given."""

import numpy as np

from sklvalve.mismatch.effects._defects import REACH
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_CURVATURE = Shown("curvature (0 is straight)")


class PositionerCharacteriser(Effect):
    r"""Characteriser of the positioner: the stem does not follow the command in proportion.

    .. math:: u' = \frac{e^{s u} - 1}{e^s - 1}

    :math:`s > 0` is towards equal percentage (rangeability :math:`e^s`), :math:`s < 0` towards quick opening,
    :math:`s = 0` linear. The curve is the same both ways and at every rate.
    """

    name = key = "positioner_characteriser"
    kind = "property"
    block, stage = "actuator", "signal"
    parameters = (Quantity("curvature", "1", -5.0, 5.0, (0.4, -0.4, 3.0, -3.0), shown=_CURVATURE),)
    needs = ("command",)
    hidden_by = REACH
    by_drop = "unseen"
    may_begin = False
    source = "equal percentage curve brought through shut and open"
    words = "a characteriser in the positioner"
    clause = "the positioner holds a characteriser"
    phrase = "the positioner bends the command (characteriser of curvature {curvature:+.2g})"
    separated_by = (
        "A slow staircase of the command over the whole travel, with the stem's true travel read from its "
        "scale: a curve that the scale shows is the positioner's, another one the sensor's."
    )

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return _curve(value, p["curvature"])

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        u = np.linspace(0.0, 1.0, 101)
        return float(np.max(np.abs(_curve(u, p["curvature"]) - u))) > tolerance.static_error


def _curve(u: np.ndarray, s: float) -> np.ndarray:
    # a straight line to second order: the quotient loses its digits there
    if abs(s) < 1e-5:
        return u + 0.5 * s * u * (u - 1.0)
    return np.expm1(s * u) / np.expm1(s)
