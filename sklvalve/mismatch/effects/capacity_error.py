# SPDX-License-Identifier: BSD-3-Clause
"""A rated capacity that is not the sheet's."""

from sklvalve.mismatch.effects._shown import DEVIATION
from sklvalve.mismatch.effects.base import Quantity
from sklvalve.mismatch.effects.flow_meter_gain import FlowMeterGain


class CapacityError(FlowMeterGain):
    r"""Capacity off by one factor at every opening: :math:`K_v' = (1 + g) K_v`."""

    name = key = "capacity_error"
    # the sheet may be of another trim, or the trim be spoilt
    kind = "either"
    block, stage = "valve", "capacity"
    parameters = (Quantity("gain", "1", -0.9, 2.0, (0.1, -0.1), shown=DEVIATION),)
    words = "a capacity other than the data sheet's"
    clause = "the capacity differs from the data sheet's"
    phrase = "the valve's capacity is {gain:+.0%} off its data sheet"
    damadics = ""
