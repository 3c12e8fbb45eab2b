# SPDX-License-Identifier: BSD-3-Clause
"""The chain of stages, from command to recorded signals, prepared for one recording.

    signal -> positioner and actuator -> stem -> plug -> capacity -> flow -> line -> meters

An effect changes one stage. The chain hands it what the stage makes, from the moment the effect acts.
"""

from copy import copy
from datetime import UTC, datetime

import numpy as np

from sklvalve.mechanism import at_travel, critical_pressure_ratio_factor, fluid_from
from sklvalve.mechanism.liquid import FLOW_CONSTANT, WATER_CRITICAL_PRESSURE
from sklvalve.simulation.electric import is_electric
from sklvalve.simulation.filtered_position import filtered_position
from sklvalve.simulation.free_run import free_run, key_of_free_run
from sklvalve.simulation.parallel_map import parallel_map
from sklvalve.simulation.stages import choked_drop, first_order_lag, from_table, play, play_with_overshoot
from sklvalve.simulation.trim import GRID

ATMOSPHERE = 101_325.0
_ROOM = 293.15
# free runs kept at hand, in numbers (8 bytes each)
# of long recordings so many: those of the neighbours of one point
_NUMBERS_KEPT, _FEWEST_RUNS = 16_000_000, 20
# and what drives the flow, of the last few flows: the neighbours of one point, few of which change it
_ROOTS_KEPT, _NUMBERS_OF_ROOTS = 16, 1_000_000
# onsets of which the rows behind are kept
_ONSETS_KEPT = 32
_OF_DROP = ("dp_zero", "fl_scale", "fl_slope", "knee")


def clock_of(recording):
    """Absolute times [s] of a recording's rows: an onset found in one file holds in the next."""
    first = recording.stamps[0]
    try:
        origin = float(first)
    except (TypeError, ValueError):
        stamp = datetime.fromisoformat(str(first))
        origin = (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)).timestamp()
    return origin + (recording.time - recording.time[0])


class Chain:
    """Stages of one valve bound to the signals of one recording.

    Parameters
    ----------
    recording : Recording
    valve : Valve
    trim : SheetTrim or LearntTrim
    effects : sequence of Effect
        Each changes the stage that it names.
    onsets : dict
        Effect key -> absolute time [s] from which on it acts; an effect without one acts throughout.
    choking : bool
        Whether the simulation holds choked flow.
    filtered : bool, default=False
        Whether the flow is simulated from the recorded opening without its sensor's noise.

    Attributes
    ----------
    measured, position : ndarray of shape (n,) or None
        The recorded opening, and what of it drives the flow [1].
    clock, time, step : ndarray of shape (n,)
        Absolute times, seconds from the first sample, and time since the sample before [s].
    pressure_ratio : ndarray of shape (n,) or None
        dp / (p1 - FF pv) [1].
    vapour : ndarray of shape (n,) or None
        Vapour pressure pv of the liquid [Pa].
    """

    def __init__(self, recording, valve, trim, *, effects=(), onsets=None, choking=False, filtered=False):
        self.recording, self.valve, self.trim = recording, valve, trim
        self.effects, self.onsets, self.choking = tuple(effects), dict(onsets or {}), choking
        self.time, self.clock = recording.time, clock_of(recording)
        self.step = np.diff(self.time, prepend=self.time[0] - recording.sample_time)
        self.command = recording.get("command")
        self.measured = self.position = recording.get("opening")
        if filtered and self.measured is not None:
            self.position = filtered_position(recording)
        self._properties()
        self._actuator_scale()
        self._runs, self._roots, self._acting = {}, [], {}

    def beside(self, effects, onsets=None):
        """The same stages with other effects; free runs made by either are at hand for both."""
        other = copy(self)
        other.effects, other.onsets = tuple(effects), dict(onsets or {})
        other._actuator_scale()
        return other

    def _properties(self):
        recording, n = self.recording, len(self.recording)
        fluid = fluid_from(
            **{
                key: value
                for key, value in self.valve.fluid.items()
                if key in ("name", "density", "kinematic_viscosity", "vapour_pressure", "critical_pressure")
            }
        )
        temperature = recording.get("temperature", np.full(n, _ROOM))
        temperature = np.where(np.isfinite(temperature), temperature, np.nanmean(temperature))
        self.temperature = temperature
        self.density = np.broadcast_to(fluid.density(temperature, warn=False), n)
        self.has_pressures = "p1" in recording and "p2" in recording
        if self.has_pressures:
            self.p1, self.p2 = recording["p1"], recording["p2"]
        else:
            # without pressures a constant drop is all that can be assumed; the capacity takes it up
            self.p1, self.p2 = np.full(n, ATMOSPHERE + 1e5), np.full(n, ATMOSPHERE)
        self.dp = self.p1 - self.p2
        self.fluid, self.vapour, self.margin = fluid, None, None
        if fluid.knows("vapour_pressure") and self.has_pressures:
            self.vapour = np.broadcast_to(fluid.vapour_pressure(temperature, warn=False), n)
            critical = fluid.critical_pressure or WATER_CRITICAL_PRESSURE
            self.margin = self.p1 - critical_pressure_ratio_factor(self.vapour, critical) * self.vapour
        self.pressure_ratio = None if self.margin is None else self.dp / self.margin

    def _actuator_scale(self):
        # a motor's effect found elsewhere says what the actuator is
        motors = any(getattr(e, "motor", False) for e in self.effects)
        self.electric = motors or is_electric(self.valve, self.recording)
        low, high = self.valve.spring_range or (20e3, 100e3)
        supply = self.valve.supply_pressure or 340e3
        self.spring_span = high - low
        self.atmosphere = ATMOSPHERE / self.spring_span
        self.spring = (ATMOSPHERE + low) / self.spring_span
        self.supply = (ATMOSPHERE + supply) / self.spring_span
        # air opens a valve that its spring closes; for fail-open valves the stem coordinate is reversed
        self.air_closes = self.valve.fail == "open"

    def active(self, effect):
        """Rows in which an effect acts."""
        times = self.times(effect)
        if times is None:
            return None
        acting = self._acting.get(times)
        if acting is None:
            # on, off, on...
            acting = np.searchsorted(times, self.clock, side="right") % 2 == 1
            if len(self._acting) >= _ONSETS_KEPT:
                self._acting.clear()
            self._acting[times] = acting
        return acting

    def times(self, effect):
        """When an effect begins, stops, begins again [s, absolute]; None where it acts throughout."""
        times = self.onsets.get(effect.key)
        return None if times is None else tuple(np.atleast_1d(times).tolist())

    def first_row(self, effect):
        """First row in which an effect acts; the number of rows where it never does."""
        onset = self.onsets.get(effect.key)
        return 0 if onset is None else int(np.searchsorted(self.clock, np.min(onset)))

    @staticmethod
    def _own(effect, values):
        return {p.name: values[f"{effect.key}.{p.name}"] for p in effect.parameters}

    def _through(self, stage, value, values):
        """What a stage makes, changed by the effects on it."""
        for effect in self.effects:
            if effect.stage == stage:
                changed = effect.apply(value, self._own(effect, values), self)
                acting = self.active(effect)
                if acting is None:
                    value = changed
                elif isinstance(value, dict):
                    value = {
                        key: old if changed[key] is old else np.where(acting, changed[key], old)
                        for key, old in value.items()
                    }
                else:
                    value = np.where(acting, changed, value)
        return value

    def lacks(self, effect):
        """What an effect would need of this simulation that it has not; empty where it can act."""
        motor = getattr(effect, "motor", False)
        if effect.stage == "actuator" and motor != self.electric:
            return "an electric actuator" if motor else "an actuator driven by air"
        return ""

    def opening(self, values):
        """Opening as the position sensor would show it, free run from the command [1]."""
        shown = self._through("position_sensor", self.stem_of_free_run(values), values)
        for effect in self.effects:
            if effect.in_loop:
                low, high = sorted(effect.stops(self._own(effect, values), self))
                acting = self.active(effect)
                held = np.clip(shown, low, high)
                shown = held if acting is None else np.where(acting, held, shown)
        return shown + values.get("position_zero", 0.0)

    def drive_of_free_run(self, values):
        """Opening that drives the flow in the free run: a sound sensor's reading as the flow takes it."""
        return self.stem_of_free_run(values) + values.get("position_zero", 0.0) - values.get("stem_zero", 0.0)

    def stem_of_free_run(self, values):
        """Opening of the stem itself, free run from the command [1]."""
        key = key_of_free_run(self, values)
        run = self._runs.get(key)
        if run is None:
            run = free_run(self, values, self._through)
            self._keep([(key, run)])
        if values.get("link_play", 0.0) > 0.0:
            run = play(run, values["link_play"])
        return self._through("stem", run, values)

    def lowest(self, values):
        """Opening below which something keeps the actuator [1], a number where that is alike in all rows.

        What blocks the plug lets the actuator go on by the play between them.
        """
        low, play_left = 0.0, 0.5 * values.get("link_play", 0.0)
        for effect in self.effects:
            if effect.stops_stem:
                limit, acting = effect.lowest(self._own(effect, values)) - play_left, self.active(effect)
                low = np.maximum(low, limit if acting is None else np.where(acting, limit, 0.0))
        return low if np.ndim(low) else float(low)

    def free_runs_ahead(self, several):
        """Run the stem for several sets of values side by side, to have the results at hand later."""
        wanted = {key_of_free_run(self, values): values for values in several}
        missing = [key for key in wanted if key not in self._runs]
        runs = parallel_map(lambda key: free_run(self, wanted[key], self._through), missing)
        self._keep(zip(missing, runs, strict=True))

    def _keep(self, runs):
        if len(self._runs) > max(_NUMBERS_KEPT // len(self.time), _FEWEST_RUNS):
            for old in list(self._runs)[: len(self._runs) // 2]:
                self._runs.pop(old, None)
        self._runs |= runs

    def drive(self, values):
        """Opening of the stem that drives the flow side: the recorded one, corrected, or the free run."""
        if self.measured is None:
            return self.drive_of_free_run(values)
        stem = self.position - values.get("stem_zero", 0.0)
        for effect in self.effects:
            if effect.stage == "position_sensor":
                true, acting = effect.invert(stem, self._own(effect, values), self), self.active(effect)
                stem = true if acting is None else np.where(acting, true, stem)
        return stem

    def flow(self, values, stem=None):
        """Flow as the meter would show it for a stem's opening [m3/s, or kg/s where recorded by mass]."""
        stem = self.drive(values) if stem is None else stem
        if values.get("plug_play", 0.0) > 0.0:
            swing = values["plug_overshoot"]
            stem = play_with_overshoot(stem, self.step, values["plug_play"], swing, 0.0)
        plug = np.clip(self._through("plug", stem, values), 0.0, 1.0)
        self.plug, self._table = plug, self.trim.table(values)
        kv = self.capacity_at(plug)
        kv = self._through("capacity", kv, values)
        kv = self._through("line", kv, values)
        flow = FLOW_CONSTANT * kv * self._root_at(plug, values)
        if self.recording.mass_flow:
            flow = flow * self.density
        flow = self._through("flow", flow, values)
        flow = first_order_lag(flow, self.step, values["meter_lag"], values["meter_ahead"])
        return self._through("flow_meter", flow, values) + values.get("flow_zero", 0.0)

    def _root_at(self, plug, values):
        """Root of what drives the flow, at hand where neither its parameters nor the plug has moved since."""
        if any(e.stage in ("pressures", "choking") for e in self.effects):
            # what they make of the drop may hang on anything
            return self._root(plug, values)
        sign = tuple(values.get(name) for name in _OF_DROP)
        for known, at, root in tuple(self._roots):
            if known == sign and (not self.choking or _same(at, plug)):
                return root
        root = self._root(plug, values)
        kept = min(max(_NUMBERS_OF_ROOTS // len(plug), 2), _ROOTS_KEPT)
        del self._roots[: max(len(self._roots) + 1 - kept, 0)]
        self._roots.append((sign, plug, root))
        return root

    def _root(self, plug, values):
        choking = self._through("choking", self._choking(plug, values), values)
        return self._root_of_drop(*self._drop_at_valve(values), **choking)

    def _drop_at_valve(self, values):
        """Pressure drop and, where known, :math:`p_1 - F_F p_v`, as the effects have them [Pa]."""
        true = self._through("pressures", {"p1": self.p1, "p2": self.p2}, values)
        drop = true["p1"] - true["p2"] + values.get("dp_zero", 0.0)
        return drop, None if self.margin is None else self.margin + (true["p1"] - self.p1)

    def _choking(self, plug, values):
        """F_L and hardness of the corner at an opening of the plug [1]."""
        if not self.choking or self.margin is None:
            # a knee of 16 rounds the corner by 4 %; harder ones cannot be told from a corner
            return {"fl": np.full(len(plug), np.inf), "knee": np.full(len(plug), 16.0)}
        fl = self._sheet_fl(plug) * values["fl_scale"] * (1.0 - values["fl_slope"] * plug)
        return {"fl": np.broadcast_to(fl, len(plug)), "knee": np.full(len(plug), values["knee"])}

    def _sheet_fl(self, plug):
        """F_L of the sheet at an opening of the plug [1]."""
        return at_travel(self.valve.fl, plug) if np.ndim(self.valve.fl) else float(self.valve.fl or 0.9)

    def capacity_at(self, plug):
        """kv of the trim at an opening of the plug, in the simulation that runs [m3/h]."""
        if np.ndim(plug) == 0:
            return np.interp(plug, GRID, self._table)
        at = np.asarray(plug, dtype=float)
        return from_table(at.ravel(), GRID, self._table).reshape(at.shape)

    def _root_of_drop(self, drop, margin, fl, knee):
        size = np.abs(drop)
        if margin is not None and np.isfinite(fl).any():
            size = choked_drop(drop, margin, fl, knee)
        return np.sign(drop) * np.sqrt(size / self.density)


def _same(one, other):
    """Whether two signals are the same number by number, gaps included."""
    return one is other or np.array_equal(one.view(np.int64), other.view(np.int64))
