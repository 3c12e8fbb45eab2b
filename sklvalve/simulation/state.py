# SPDX-License-Identifier: BSD-3-Clause
"""Whether the state of a simulation, read back from a file, is one that can be simulated."""

import re
from numbers import Real

import numpy as np

from sklvalve.simulation.trim import GRID

# wider than any fit goes, and near enough for a simulation to come to an end: name -> low, high in SI
_RANGES = {
    "actuator_filter": (1e-4, 1e5),
    "actuator_delay": (0.0, 1e5),
    "actuator_gain": (1e-3, 1e4),
    "actuator_reset": (0.0, 1e4),
    "actuator_rate": (1e-6, 1e4),
    "actuator_coulomb": (0.0, 10.0),
    "actuator_feedback": (0.0, 10.0),
    "actuator_vent": (1e-3, 1e3),
    "actuator_loop": (0.0, 1e3),
    "actuator_dead_band": (0.0, 1.0),
    "actuator_stroke": (1e-7, 1e4),
    "actuator_speed": (1e-7, 1e4),
    "position_zero": (-1.0, 1.0),
    "stem_zero": (-1.0, 1.0),
    "link_play": (0.0, 1.0),
    "plug_play": (0.0, 1.0),
    "plug_overshoot": (0.0, 1.0),
    "capacity": (0.0, 1e7),
    "meter_lag": (1e-4, 1e5),
    "meter_ahead": (0.0, 10.0),
    "flow_zero": (-1e8, 1e8),
    "given_gain": (1e-3, 1e3),
    "dp_zero": (-1e11, 1e11),
    "fl_scale": (1e-2, 1e2),
    "fl_slope": (-10.0, 10.0),
    "knee": (0.1, 1e4),
}
_LARGEST = 1e12
# parts of the chain that come together: where the first is known, the others must be
_TOGETHER = (
    ("actuator_filter", "actuator_delay"),
    (
        "actuator_gain",
        "actuator_reset",
        "actuator_rate",
        "actuator_coulomb",
        "actuator_feedback",
        "actuator_vent",
        "actuator_loop",
        "actuator_filter",
    ),
    ("meter_lag", "meter_ahead"),
    ("plug_play", "plug_overshoot"),
    ("given_gain", "meter_lag", "meter_ahead"),
    ("fl_scale", "fl_slope", "knee"),
)
_NAME = re.compile(r"[A-Za-z_]\w{0,80}(\.[A-Za-z_]\w{0,80})?")
_SIGNAL = r"(command|opening|temperature|dp|pressure_ratio|simulated_flow|simulated_opening)"
_INPUT = re.compile(rf"{_SIGNAL}( [\d.e+-]{{1,20}} s)?|(cosine|sine) [\d.e+-]{{1,20}} s")
_MOST_KNOTS, _MOST_INPUTS, _MOST_ROWS = 1000, 100, 200_000


def require_sound_state(state, effects):
    """Refuse a state whose numbers, shapes or names no fitted simulation has.

    Parameters
    ----------
    state : object
        What `ValveSimulation.to_state` gave, as it was read back.
    effects : sequence of Effect
        Those that its keys name.

    Raises
    ------
    ValueError
        With a few words that name the part.
    """
    values = mapping(state, "values")
    require_sound_values(values, effects)
    if not isinstance(state.get("choking"), bool):
        raise ValueError("choking is neither true nor false")
    require_sound_trim(mapping(state, "trim"), values)
    require_sound_onsets(mapping(state, "onsets"), effects)
    _require_sound_seen(state.get("seen"))
    if state.get("correction") is not None:
        _require_sound_correction(mapping(state, "correction"))


def require_sound_values(values, effects):
    """Refuse values of parameters [SI] that no fit has, or of which some are missing; ``ValueError``."""
    for name, value in values.items():
        parameter_name(name)
        low, high = _RANGES.get(name, (-_LARGEST, _LARGEST))
        number(value, name, low, high)
    for first, *others in _TOGETHER:
        require_names(values, others if first in values else ())
    for effect in effects:
        require_names(values, [f"{effect.key}.{p.name}" for p in effect.parameters])


def parameter_name(name):
    """A name that a parameter may have; ``ValueError`` else."""
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise ValueError("a parameter has no name")
    return name


def number(value, name, low=-_LARGEST, high=_LARGEST):
    """A finite number within bounds; ``ValueError`` else."""
    if isinstance(value, bool | np.bool_) or not isinstance(value, Real):
        raise ValueError(f"{name} is no number")
    if not low <= value <= high:
        raise ValueError(f"{name} is out of range")
    return float(value)


def mapping(state, key):
    """A part of a state that is a dict; ``ValueError`` else."""
    part = state.get(key) if isinstance(state, dict) else None
    if not isinstance(part, dict):
        raise ValueError(f"{key} is missing")
    return part


def require_names(values, names):
    """``ValueError`` where a value is missing."""
    missing = [name for name in names if name not in values]
    if missing:
        raise ValueError(f"{missing[0]} is missing")


def array(value, name, shape):
    """A float array of a shape, whose -1 stands for any length; ``ValueError`` else."""
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiu":
        raise ValueError(f"{name} is no array of numbers")
    if value.ndim != len(shape) or any(
        want not in (-1, n) for want, n in zip(shape, value.shape, strict=True)
    ):
        raise ValueError(f"{name} has the wrong shape")
    if not (np.abs(value) <= _LARGEST).all():
        raise ValueError(f"{name} holds values out of range")
    return value


def require_sound_trim(trim, values):
    """Refuse the state of a trim that no fit has, or whose values are missing; ``ValueError``."""
    rated, knots, curve = trim.get("rated"), trim.get("knots"), trim.get("curve")
    number(rated, "the rated capacity", 1e-12, 1e12)
    if not isinstance(trim.get("given", False), bool):
        raise ValueError("the kind of trim is neither true nor false")
    if curve is not None:
        array(curve, "the curve of the trim", GRID.shape)
    if trim.get("given"):
        require_names(values, ["given_gain"])
        return
    through = {"capacity", "rise_0"} & set(values)
    if knots is None:
        require_names(values, ["capacity", *(f"trim_{k}" for k in range(7))] if through else ())
        return
    knots = array(np.asarray(knots), "the knots of the trim", (-1,))
    if (
        not 2 <= len(knots) <= _MOST_KNOTS
        or (np.diff(knots) <= 0.0).any()
        or knots[0] < 0.0
        or knots[-1] > 1.0
    ):
        raise ValueError("the knots of the trim do not rise from shut to open")
    if through:
        rises = [f"rise_{k}" for k in range(len(knots))]
        require_names(values, rises)
        for name in rises:
            number(values[name], name, 0.0)


def require_sound_onsets(onsets, effects):
    """Refuse onsets [s] of effects that are not there, or out of order; ``ValueError``."""
    keys = {effect.key for effect in effects}
    for key, times in onsets.items():
        if key not in keys:
            raise ValueError("an onset belongs to no effect")
        several = list(times) if isinstance(times, list | tuple | np.ndarray) else [times]
        moments = [number(time, "an onset") for time in several]
        if not moments or moments != sorted(moments):
            raise ValueError("onsets are not in order")


def _require_sound_seen(seen):
    if seen is not None:
        if not isinstance(seen, list | tuple) or len(seen) != 2:
            raise ValueError("the times seen are no pair")
        first, last = (number(time, "a time seen") for time in seen)
        if last < first:
            raise ValueError("the times seen run back")


def _require_sound_correction(part):
    inputs = part.get("inputs")
    if part.get("channel") not in ("flow", "opening"):
        raise ValueError("the residual's channel is not known")
    if not isinstance(inputs, list | tuple) or not 0 < len(inputs) <= _MOST_INPUTS:
        raise ValueError("the residual has no inputs")
    for name in inputs:
        if not isinstance(name, str) or not _INPUT.fullmatch(name):
            raise ValueError("an input of the residual is not known")
        if " " in name:
            number(float(name.split(" ")[1]), "a time of the residual", 1e-6)
    width = len(inputs)
    support = array(part.get("support"), "the residual's support", (-1, width))
    if not 0 < len(support) <= _MOST_ROWS:
        raise ValueError("the residual's support has the wrong shape")
    array(part.get("coefficients"), "the residual's coefficients", (len(support),))
    array(part.get("centre"), "the residual's centre", (width,))
    if not (array(part.get("scale"), "the residual's scale", (width,)) > 0.0).all():
        raise ValueError("the residual's scale is not above 0")
    number(part.get("gamma"), "the residual's gamma", 1e-12)
    number(part.get("intercept"), "the residual's intercept")
    number(part.get("span"), "the residual's span", 0.0)
