# SPDX-License-Identifier: BSD-3-Clause
"""From what the plant does to what a historian holds: scan, converter, exception reporting."""

import numpy as np

BITS, FEW_BITS = 12, 9
# of the flow meter's converter, in spans; of the historian's exception reporting, in widths of the converter
FLOW_WIDTH, HELD = 1.25, 0.003
JITTER = 0.1  # of the scan [s]
RANGES = {"CV": 100.0, "X": 104.0, "P1": 2500.0, "P2": 2500.0, "T1": 200.0}


def scan(fine, moments, a_second):
    """Values at these moments [s] of a series with `a_second` rows a second."""
    return np.interp(moments, np.arange(fine.size) / a_second, fine)


def scan_place(rng):
    """How late a channel is read by its place in the scan [s]."""
    return rng.uniform(0.0, 0.15)


def scan_moments(rng, n, place):
    """When one channel is read: every second, late by its place in the scan and a little more [s]."""
    return np.arange(n) + place + rng.uniform(0.0, JITTER, n)


def convert(values, width, bits=BITS):
    """Values as an analogue-to-digital converter of this many bits gives them, over a range of `width`."""
    step = width / 2.0**bits
    return np.round(values / step) * step


def held(values, width):
    """Exception reporting: a value stands until the signal has left it by `width`."""
    out, last = np.empty_like(values), values[0]
    for k, value in enumerate(values):
        if abs(value - last) > width:
            last = value
        out[k] = last
    return out
