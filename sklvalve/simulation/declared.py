# SPDX-License-Identifier: BSD-3-Clause
"""What a data sheet declares of an actuator's response: stroke time, dead time, dead band.

Each is a parameter of the simulation about its declared value, within the tolerance. What is beyond it is a
mismatch, as ever.
"""

from sklvalve.simulation.parameters import Parameter

# a stroke may be so many times as fast as declared: no valve is at fault for that
_FASTER = 10.0
# of a declared value that a fit of its logarithm begins with, nought stands for this [s], [1]
_NONE = 1e-3


def declared_speed(name, tolerance, valve):
    """Speed of a stroke that takes as long as the sheet says [1/s]."""
    speed, more = 1.0 / valve.stroke_time, 1.0 + tolerance.declared
    return Parameter(name, "1/s", speed / more, _FASTER * speed, speed, spread=tolerance.declared, log=True)


def declared_delay(tolerance, valve, scan):
    """Time between a command and its effect: what the sheet declares, and the few scans of any valve [s].

    Parameters
    ----------
    tolerance : Tolerance
    valve : Valve
    scan : float
        Longest time that a few scans take [s].
    """
    declared = valve.dead_time or 0.0
    open_to_it = tolerance.declared * declared
    return Parameter(
        "actuator_delay",
        "s",
        declared - open_to_it,
        declared + open_to_it + scan,
        declared + 0.3 * scan,
        spread=0.5 * (scan + open_to_it),
    )


def declared_band(tolerance, valve):
    """Dead band that the sheet declares, or a narrower one [1]; nothing where it declares none."""
    if not valve.dead_band:
        return ()
    band = valve.dead_band
    high = (1.0 + tolerance.declared) * band
    return (Parameter("actuator_dead_band", "1", min(_NONE, 0.1 * band), high, band, spread=0.3, log=True),)


def declared_parameters(tolerance, valve, *, electric):
    """Parameters of a declared stroke time and dead band, those of a motor's own drive left to it."""
    stroke = ()
    if valve.stroke_time is not None and not electric:
        stroke = (declared_speed("actuator_stroke", tolerance, valve),)
    return (*stroke, *declared_band(tolerance, valve))
