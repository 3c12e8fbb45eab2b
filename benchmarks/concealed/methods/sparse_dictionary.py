# SPDX-License-Identifier: BSD-3-Clause
"""Named regressors of a residual: what each effect would leave over, in its plainest form.

Of flow in units of its span, of opening in travel. An effect that has a shape (where it begins, how slow it
is) has a column for each of several shapes; names whose columns are equal share them.
"""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.methods.operators import filled, slope_by, stick_and_jump
from sklvalve.mismatch.describe.cells import direction_of_travel, rate_of_travel
from sklvalve.simulation.chain import ATMOSPHERE
from sklvalve.simulation.stages import first_order_lag, limited_rate

_TIMES = (4.0, 12.0, 40.0)
_WIDTHS = (0.01, 0.025, 0.06)


@dataclass(frozen=True, eq=False)
class Column:
    """One regressor.

    Attributes
    ----------
    names : tuple of str
        Effects that it stands for.
    parts : dict
        Channel -> ndarray of shape (n,).
    begins : bool
        Whether it may begin within the recording.
    """

    names: tuple
    parts: dict
    begins: bool = True


def dictionary(nominal):
    """Columns for a calibrated recording."""
    scene = _Scene(nominal)
    found = []
    if "flow" in scene.channels:
        found += _of_flow(scene) + _of_sensor(scene)
    if scene.free is not None:
        found += [scene.placed(column) for column in _of_opening(scene)]
    return [c for c in found if all(np.isfinite(part).all() for part in c.parts.values())]


class _Scene:
    """Signals of a calibrated recording, gaps bridged."""

    def __init__(self, nominal):
        problem, model = nominal.problem, nominal.model
        chain = model.chain
        self.channels, self.step, self.time = problem.channels, chain.step, chain.time
        self.closes_by_air = problem.valve.fail == "open"
        self.dp = filled(chain.dp)
        self.root = np.sqrt(np.abs(self.dp) / max(float(np.quantile(np.abs(self.dp), 0.99)), 1e-9))
        self.p1, self.p2, self.temperature = filled(chain.p1), filled(chain.p2), filled(chain.temperature)
        self.margin = None if chain.margin is None else filled(chain.margin)
        self.vapour = None if chain.vapour is None else filled(chain.vapour)
        self.free = None
        if "opening" in model.predictions:
            self.free = filled(model.predictions["opening"])
        elif "actuator_filter" in model.values and chain.command is not None:
            self.free = filled(chain.opening(model.values))
        seen = chain.measured if chain.measured is not None else self.free
        seen = chain.command if seen is None else seen
        self.x = filled(seen) if seen is not None else np.full(len(self.time), 0.5)
        self.flow = (
            filled(model.predictions["flow"] / problem.spans["flow"]) if "flow" in self.channels else None
        )
        if self.flow is not None:
            self.kv = self.flow / np.maximum(self.root, 0.05)
            self.gain = slope_by(self.x, self.kv) * self.root

    def placed(self, column):
        """A column of the opening; where none is recorded, as the flow would show it."""
        if "opening" in self.channels:
            return column
        return Column(column.names, {"flow": column.parts["opening"] * self.gain}, column.begins)

    def late(self, signal, seconds):
        """A signal behind a first-order lag."""
        return first_order_lag(signal, self.step, seconds, 0.5)


def _of_flow(s):
    hours = (s.time - s.time[0]) / max(s.time[-1] - s.time[0], 1e-9)
    q, x, warm = s.flow, s.x, s.temperature - s.temperature.mean()
    found = [
        _flow(("seat_leakage", "bypass_open"), s.root),
        _flow(("external_leakage",), np.sqrt(np.maximum(s.p1 - ATMOSPHERE, 0.0) / 1e5)),
        *(_flow(("erosion",), s.root * np.exp(-x / reach)) for reach in (0.05, 0.1, 0.2)),
        _flow(("piping_reducers", "line_loss"), -q * s.kv**2),
        _flow(("wrong_characteristic",), q * (x - 1.0), begins=False),
        _flow(("wrong_characteristic",), q * x * (1.0 - x), begins=False),
        _flow(("capacity_error", "flow_meter_gain", "density_change"), q),
        _flow(("flow_meter_bias",), np.ones(len(q))),
        _flow(("flow_meter_drift",), hours, begins=False),
        _flow(("flow_meter_drift", "sedimentation"), q * hours, begins=False),
        _flow(("density_change",), q * warm),
        _flow(("viscous_flow", "viscosity_change"), -q / np.sqrt(np.abs(q) + 0.02)),
        _flow(("viscosity_change",), q * warm / np.sqrt(np.abs(q) + 0.02)),
        _flow(("inlet_pressure_bias", "outlet_pressure_bias"), q / np.maximum(s.root, 0.1) ** 2),
        *(_flow(("sensor_lag",), s.late(q, seconds) - q) for seconds in _TIMES),
        _flow(("flow_inertia",), -np.gradient(q) / np.maximum(s.root, 0.1)),
        _flow(("backlash",), -s.gain * np.nan_to_num(direction_of_travel(x))),
        *(_flow(("backlash",), s.gain * (stick_and_jump(x, width, 0.0) - x)) for width in _WIDTHS),
    ]
    for at in (0.95, 0.85, 0.75, 0.65, 0.5, 0.35):
        shape = s.gain.mean() * np.minimum(at - x, 0.0) if not s.gain.any() else None
        passed = np.interp(at, np.sort(x), s.kv[np.argsort(x)])
        shape = np.where(x > at, (passed - s.kv) * s.root, 0.0) if shape is None else shape
        found.append(_flow(("clogging",), shape))
    for at in (0.05, 0.1, 0.2, 0.35):
        held = np.interp(at, np.sort(x), s.kv[np.argsort(x)])
        found.append(_flow(("clogging",), np.where(x < at, (held - s.kv) * s.root, 0.0)))
    return found + _of_pressure_ratio(s)


def _of_pressure_ratio(s):
    if s.margin is None:
        return []
    ratio = np.abs(s.dp) / np.maximum(s.margin, 1.0)
    found = []
    for recovery in (0.95, 0.85, 0.75, 0.65, 0.55):
        most = np.minimum(recovery / np.sqrt(np.maximum(ratio, 1e-6)), 1.0)
        found.append(_flow(("choked_flow",), s.flow * (most - 1.0)))
    found += [_flow(("cavitation",), -s.flow * np.maximum(ratio - begins, 0.0)) for begins in (0.2, 0.4, 0.6)]
    found.append(_flow(("flashing",), s.flow * np.maximum(s.vapour - s.p2, 0.0) / 1e5))
    found.append(_flow(("two_phase",), -s.flow * ratio))
    return found


def _of_sensor(s):
    """A position sensor's errors show in both channels at once."""
    if "opening" not in s.channels:
        return []
    one = np.ones(len(s.x))
    return [
        Column(("position_sensor_bias",), {"opening": one, "flow": -s.gain}),
        Column(("position_sensor_gain",), {"opening": s.x, "flow": -s.gain * s.x}),
    ]


def _of_opening(s):
    x, step = s.free, s.step
    rate = rate_of_travel(x, s.time)
    late = {seconds: s.late(x, seconds) for seconds in _TIMES}
    found = [
        *(_opening(("actuator_lag",), late[seconds] - x) for seconds in _TIMES),
        *(_opening(("dead_time",), np.interp(s.time - d, s.time, x) - x) for d in (2.0, 4.0, 8.0, 16.0)),
        *(_opening(("slew_limit",), limited_rate(x, step, v, v) - x) for v in (0.1, 0.03, 0.01, 0.004)),
        _opening(("transducer_fault", "positioner_feedback_fault"), np.ones(len(x))),
        _opening(("transducer_fault", "positioner_feedback_fault"), x),
        _opening(("positioner_characteriser",), x * (1.0 - x), begins=False),
        _opening(("stem_load",), s.dp / max(float(np.max(np.abs(s.dp))), 1e-9)),
        _opening(("stuck_valve",), np.median(x) - x),
        _opening(("spring_fault",), x**3),
        _opening(("actuator_leak",), -np.maximum(rate, 0.0)),
        *(
            _opening(("actuator_leak", "supply_pressure_drop"), limited_rate(x, step, v, 1.0) - x)
            for v in (0.03, 0.01)
        ),
        *(_opening(("rod_bend",), np.where(x > at, late[12.0] - x, 0.0)) for at in (0.3, 0.6)),
        *(_opening(("rod_bend",), np.where(x < at, late[12.0] - x, 0.0)) for at in (0.4, 0.7)),
    ]
    for width in _WIDTHS:
        play = stick_and_jump(x, width, 0.0) - x
        held = stick_and_jump(x, width, width) - x
        found += [
            _opening(("backlash",), play),
            _opening(("stiction",), stick_and_jump(x, width, 0.5 * width) - x),
            _opening(("positioner_deadband",), held),
            # a positioner that resets takes friction's error away
            _opening(("friction", "presliding"), play - s.late(play, 20.0)),
        ]
    ends = 1.0 - x if s.closes_by_air else x
    sign = -1.0 if s.closes_by_air else 1.0
    for at in (0.95, 0.85, 0.75, 0.65, 0.5):
        found.append(_opening(("supply_pressure_drop", "spring_fault"), sign * (np.minimum(ends, at) - ends)))
    for at in (0.03, 0.06, 0.15):
        found.append(_opening(("tight_shutoff",), np.where(x < at, -x, 0.0)))
        found.append(_opening(("tight_shutoff",), np.where(x > 1.0 - at, 1.0 - x, 0.0)))
    return found


def _flow(names, values, begins=True):
    return Column(names, {"flow": np.asarray(values, dtype=float)}, begins)


def _opening(names, values, begins=True):
    return Column(names, {"opening": np.asarray(values, dtype=float)}, begins)
