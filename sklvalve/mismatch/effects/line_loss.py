# SPDX-License-Identifier: BSD-3-Clause
"""Resistance of the line between the pressure taps."""

from sklvalve.mismatch.effects._shown import LOSS
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.piping_reducers import PipingReducers


class LineLoss(PipingReducers):
    r"""Line, strainer or half-shut hand valve between the pressure taps, in series with the trim.

    .. math:: K_v' = K_v / \sqrt{1 + \zeta (K_v / K_{v,rated})^2}

    the equation of reducers, so that no signal of the valve tells the two apart.
    """

    name = key = "line_loss"
    kind = "property"
    parameters = (Quantity("loss", "1", 0.0, 30.0, (0.3, 1.5), shown=LOSS),)
    words = "pressure loss of the line"
    clause = "the line loses pressure"
    phrase = "the line between the pressure taps costs {loss:.2g} times the valve's own loss when fully open"
