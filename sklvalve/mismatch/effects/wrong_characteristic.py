# SPDX-License-Identifier: BSD-3-Clause
"""A trim of another characteristic than the sheet's."""

from math import exp

import numpy as np

from sklvalve.mismatch.effects._defects import END_OF_FLOW
from sklvalve.mismatch.effects._trim import beyond_trim, visited
from sklvalve.mismatch.effects.base import Effect, Quantity, Shown
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance

_SLOPE = Shown("rangeability, as a multiple of the sheet's,", turn=exp)


class WrongCharacteristic(Effect):
    r"""Capacity that departs from the sheet's curve, smoothly and far.

    .. math:: \ln K_v' = \ln K_v + s (x - 1) + 4 b x (1 - x)

    :math:`s` changes the rangeability by :math:`e^s`, :math:`b` bows the curve (towards linear or parabolic).
    """

    name = key = "wrong_characteristic"
    kind = "property"
    block, stage = "valve", "capacity"
    parameters = (
        Quantity("slope", "1", -4.0, 4.0, (0.3, -0.3), shown=_SLOPE),
        Quantity("bow", "1", -2.0, 2.0, (0.0,), silent=True),
    )
    needs = ("flow",)
    hidden_by = END_OF_FLOW
    by_drop = "always"
    may_begin = False
    words = "a trim characteristic other than the data sheet's"
    clause = "the trim's characteristic differs from the data sheet's"
    phrase = "the trim does not have the characteristic of its data sheet"
    separated_by = "A slow staircase over the whole travel at three pressure drops."
    requires = "a data sheet that gives the trim's characteristic"

    def possible(self, chain: Chain) -> bool:
        return chain.trim.known

    def apply(self, value: np.ndarray, p: dict[str, float], chain: Chain) -> np.ndarray:
        return value * np.exp(self._bend(chain.plug, p))

    def beyond_tolerance(self, p: dict[str, float], chain: Chain, tolerance: Tolerance, late: bool) -> bool:
        x, phi = visited(chain)
        return late or beyond_trim(np.expm1(self._bend(x, p)), phi, tolerance)

    @staticmethod
    def _bend(x: np.ndarray, p: dict[str, float]) -> np.ndarray:
        return p["slope"] * (x - 1.0) + 4.0 * p["bow"] * x * (1.0 - x)
