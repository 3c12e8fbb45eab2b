# SPDX-License-Identifier: BSD-3-Clause
"""Effects of one size each, as changes of what `stem` and `flow` are told.

An effect takes its size, the base and `acts` (1 where it acts, 0 before) and gives {what: (how, values)}:
"more" is added to the sound value, "set" stands in its place wherever it is not NaN.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

# names that no signal of these recordings tells from the first one
ALSO = {
    "seat_leakage": ("bypass_open",),
    "bypass_open": ("seat_leakage",),
    "capacity_error": ("flow_meter_gain", "density_change"),
    "flow_meter_gain": ("capacity_error", "density_change"),
    "sedimentation": ("flow_meter_drift",),
    "piping_reducers": ("line_loss",),
    "outlet_pressure_bias": ("inlet_pressure_bias",),
}


@dataclass(frozen=True)
class Effect:
    """One effect: catalogue's name, block, main parameter, and how large it may sensibly get.

    `least` is a smallest size in rows, for what is nothing below one; `late` says that from the start it
    would be calibration, `allowed` how much of it a sheet leaves open from the start.
    """

    name: str
    key: str
    block: str
    change: Callable
    most: float
    signs: tuple = (1,)
    told: Callable | None = None
    late: bool = False
    needs: tuple = ()
    injected: bool = True
    least: float = 0.0
    allowed: float = 0.0


def _largest_kv(base):
    return float(np.quantile(base.trim(base.opening if base.opening is not None else base.stem()), 0.99))


def _more(**values):
    return {name: ("more", value) for name, value in values.items()}


def _stiction(size, base, acts):
    return _more(stick=size * acts, jump=0.5 * size * acts)


def _slower(size, base, acts):
    """Seconds that a full stroke takes longer, both ways."""
    out = {}
    for name in ("opening_speed", "closing_speed"):
        speed = 1.0 / (1.0 / base.sound.get(name, np.inf) + size / base.dt)
        out[name] = ("set", np.where(acts > 0, speed, np.nan))
    return out


def _erosion(size, base, acts):
    return _more(wear=size * _largest_kv(base) * acts, reach=np.full(len(acts), 0.15))


def _clogging(size, base, acts):
    return {"cap": ("set", np.where(acts > 0, (1.0 - size) * _largest_kv(base), np.nan))}


def _knee(base):
    """FL at which the largest twentieth of the drops would choke."""
    fluid = base.fluid
    reach = fluid.p1 - (0.96 - 0.28 * np.sqrt(fluid.vapour / fluid.critical)) * fluid.vapour
    return float(np.sqrt(np.quantile(fluid.drop / reach, 0.95)))


def _choking(size, base, acts):
    return {"fl": ("set", np.where(acts > 0, _knee(base) * (1.0 - size), np.nan))}


def _hours(base, acts):
    return np.cumsum(acts) * base.dt / 3600.0


def _share(name, scale=1.0):
    """Change of one value in shares of the largest capacity, or of the largest flow where `scale` says so."""
    return lambda size, base, acts: _more(**{name: size * scale * _largest_kv(base) * acts})


def _of_flow(base):
    return float(np.quantile(base.recorded_flow, 0.99))


def _main(parameter, unit, value=lambda size, base: size):
    return lambda size, base: {"parameter": parameter, "value": float(value(size, base)), "unit": unit}


def _limit(size, base):
    """Opening at which the sound trim has the capacity that is left."""
    at = np.linspace(base.trim.openings[0], base.trim.openings[-1], 400)
    return np.interp((1.0 - size) * _largest_kv(base), np.maximum.accumulate(base.trim(at)), at)


_kv = lambda size, base: size * _largest_kv(base)  # noqa: E731
_m3_s = lambda size, base: size * _of_flow(base) / 3600.0  # noqa: E731

EFFECTS = (
    Effect(
        "backlash", "linkage_backlash", "actuator",
        lambda s, base, acts: _more(linkage_play=s * acts), 0.3, told=_main("width", "1"), needs=("opening",),
        allowed=0.01,
    ),
    Effect(
        "backlash", "plug_backlash", "valve",
        lambda s, base, acts: _more(plug_play=s * acts), 0.3, told=_main("width", "1"), allowed=0.01,
    ),
    Effect("stiction", "stiction", "actuator", _stiction, 0.3, allowed=0.01),
    Effect(
        "positioner_deadband", "positioner_deadband", "actuator",
        lambda s, base, acts: _more(dead_band=s * acts), 0.2, told=_main("half_width", "1"),
        needs=("opening",), allowed=0.005,
    ),
    Effect(
        "dead_time", "dead_time", "actuator",
        lambda s, base, acts: _more(delay=s / base.dt * acts), 30.0, told=_main("delay", "s"),
        least=1.0, allowed=3.0,
    ),
    Effect(
        "actuator_lag", "actuator_lag", "actuator",
        lambda s, base, acts: _more(lag=s / base.dt * acts), 60.0,
        told=_main("time_constant", "s"), least=1.0, allowed=3.0,
    ),
    Effect("slew_limit", "slew_limit", "actuator", _slower, 600.0),
    Effect("seat_leakage", "seat_leakage", "valve", _share("leak"), 0.5, told=_main("leak_kv", "m3/h", _kv)),
    Effect("bypass_open", "bypass_open", "valve", _share("leak"), 0.8, told=_main("bypass_kv", "m3/h", _kv)),
    Effect("erosion", "erosion", "valve", _erosion, 5.0),
    Effect("clogging", "clogging", "valve", _clogging, 0.7, told=_main("limit", "1", _limit)),
    Effect(
        "capacity_error", "capacity_error", "valve",
        lambda s, base, acts: _more(capacity=s * acts), 0.6, (1, -1), _main("gain", "1"), late=True,
    ),
    Effect(
        "sedimentation", "sedimentation", "valve",
        lambda s, base, acts: _more(capacity=np.maximum(-s * _hours(base, acts), -0.8)), 1.5,
        told=_main("rate", "1/h"),
    ),
    Effect(
        "piping_reducers", "piping_reducers", "line",
        lambda s, base, acts: _more(loss=s / _largest_kv(base) ** 2 * acts), 5.0,
    ),
    Effect(
        "choked_flow", "choked_flow", "valve", _choking, 0.5, needs=("vapour",),
        told=_main("fl", "1", lambda size, base: _knee(base) * (1.0 - size)),
    ),
    Effect(
        "external_leakage", "external_leakage", "valve", _share("outside_leak"), 0.5,
        needs=("back pressure",), told=_main("leak_kv", "m3/h", _kv),
    ),
    Effect(
        "flow_meter_gain", "flow_meter_gain", "measurement",
        lambda s, base, acts: _more(meter_gain=s * acts), 0.6, (1, -1), _main("gain", "1"), late=True,
    ),
    Effect(
        "flow_meter_bias", "flow_meter_bias", "measurement",
        lambda s, base, acts: _more(meter_bias=s * _of_flow(base) * acts), 0.5, (1, -1),
        _main("bias", "m3/s", _m3_s),
    ),
    Effect(
        "flow_meter_drift", "flow_meter_drift", "measurement",
        lambda s, base, acts: _more(meter_bias=s * _of_flow(base) * _hours(base, acts)), 2.0, (1, -1),
        _main("drift", "m3/s/h", _m3_s),
    ),
    Effect(
        "sensor_lag", "sensor_lag", "measurement",
        lambda s, base, acts: _more(meter_lag=s / base.dt * acts), 120.0, told=_main("lag", "s"),
        least=1.0, allowed=3.0,
    ),
    Effect(
        "position_sensor_bias", "position_sensor_bias", "measurement",
        lambda s, base, acts: _more(sensor_bias=s * acts), 0.3, (1, -1), _main("bias", "1"), True,
        ("opening",),
    ),
    Effect(
        "position_sensor_bias", "position_sensor_bias_in_the_loop", "measurement",
        # the positioner brings the wrong reading to the command, and the plug is off by as much
        lambda s, base, acts: _more(plug_offset=-s * acts), 0.3, (1, -1), _main("bias", "1"), True,
        ("opening",),
    ),
    Effect(
        "outlet_pressure_bias", "outlet_pressure_bias", "measurement",
        lambda s, base, acts: _more(head=s * float(np.median(base.fluid.drop)) * acts), 0.8, (1, -1),
        injected=False,
    ),
)  # fmt: skip

BY_KEY = {effect.key: effect for effect in EFFECTS}


def possible(effect, base):
    """Whether a base has what an effect needs."""
    has = {
        "opening": base.opening is not None,
        "vapour": base.source == "damadics",
        "back pressure": bool(np.median(base.fluid.p2) > 1.5),
    }
    return all(has[what] for what in effect.needs)
