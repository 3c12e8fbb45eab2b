# SPDX-License-Identifier: BSD-3-Clause
"""The user's own simulation, given as columns of the recording: effects change what it makes.

Where a given flow follows the opening, the trim behind it is that of a type: one valve's own lies within the
tolerance of it, as beside a simulation of the package.

A given flow tells, by the turbulent equation, and the choked one where the valve.toml says that it holds it,
the capacity that it stands for in each row; effects of plug, capacity, line and pressures change that
capacity or the drop, and the flow changes by the difference. Where it chokes, the valve's own F_L lies within
the tolerance of the sheet's, and its corner is as soft as that of any valve.
"""

import numpy as np

from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.recording import InputError
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.given_trim import NoOpening
from sklvalve.simulation.parameters import Parameter
from sklvalve.simulation.stages import delayed, first_order_lag

ROLES = ("simulated_flow", "simulated_opening")
ACTUATOR_STAGES = ("signal", "actuator", "stem")
# of the corner of a user's plain simulation, which is the smaller of two drops
_SHARP = 200.0
_CAPACITY_STAGES = ("position_sensor", "plug", "capacity", "line", "pressures", "choking")


def chain_for(recording, valve, trim, **options):
    """Stages of a simulation bound to a recording: `GivenChain` where it holds the user's own simulation."""
    made = GivenChain if set(ROLES) & set(recording) else Chain
    return made(recording, valve, trim, **options)


def given_flow_parameters(recording, tolerance, span):
    """Parameters that stay open beside a given flow: gain, zero and response of the meter."""
    zero, gain = tolerance.flow_zero * span, tolerance.capacity
    return (
        Parameter("given_gain", "1", 1.0 - gain, 1.0 + gain, 1.0, spread=0.5 * gain),
        Parameter("meter_lag", "s", 0.02, tolerance.response, 0.1, spread=1.5, log=True),
        Parameter("meter_ahead", "1", 0.0, 1.0, 0.5, spread=0.3),
        Parameter("flow_zero", "m3/s", -zero, zero, 0.0, spread=0.5 * zero),
    )


def given_opening_parameters(recording, tolerance):
    """Parameters that stay open beside a given opening: response, delay of some scans, zero."""
    scan = min(2.0 * recording.sample_time, tolerance.response)
    zero = tolerance.position_zero
    return (
        Parameter("actuator_filter", "s", 0.02, tolerance.response, 0.1, spread=1.5, log=True),
        Parameter("actuator_delay", "s", 0.0, scan, 0.3 * scan, spread=0.5 * scan),
        Parameter("position_zero", "1", -zero, zero, 0.0, spread=0.5 * zero),
    )


class GivenChain(Chain):
    """Stages of one valve around a simulation that the recording holds; what it lacks is simulated as ever.

    Parameters
    ----------
    recording : Recording
        With ``simulated_flow``, ``simulated_opening`` or both.
    valve : Valve
    trim : GivenTrim, SheetTrim or LearntTrim
        A `GivenTrim` beside a given flow.
    effects, onsets, filtered
        As in `Chain`.
    choking : bool, default=False
        Whether the given flow, or the simulation in its place, chokes.
    """

    def __init__(self, recording, valve, trim, **options):
        self.given_flow = recording.get("simulated_flow")
        self.given_opening = recording.get("simulated_opening")
        super().__init__(recording, valve, trim, **options)
        self._given_capacity()

    def _actuator_scale(self):
        super()._actuator_scale()
        self.electric = self.electric and self.given_opening is None

    def _given_capacity(self):
        """Capacity [m3/h] that the given flow stands for, where there is a drop that drives it."""
        if self.given_flow is None:
            return
        volume = self.given_flow / self.density if self.recording.mass_flow else self.given_flow
        root = self._root_of_drop(self.dp, self.margin, **self._choking_given())
        driven = self._driven = np.abs(self.dp) > 1e-3 * np.nanmax(np.abs(self.dp))
        with np.errstate(divide="ignore", invalid="ignore"):
            self._kv = np.where(driven, volume / (FLOW_CONSTANT * root), 0.0)
        self._root = root

    @property
    def given_capacity(self):
        """Capacity that the given flow stands for [m3/h]; NaN where no drop drives it."""
        return np.where(self._driven, self._kv, np.nan)

    def _choking_given(self):
        """F_L of the sheet, where the given flow holds it, with a sharp corner."""
        fl = np.full(len(self.dp), np.inf)
        if self.choking and self.margin is not None:
            fl = np.broadcast_to(self._sheet_fl(self._opening_seen()), len(self.dp))
        return {"fl": fl, "knee": np.full(len(self.dp), _SHARP)}

    def _opening_seen(self):
        """Recorded opening; the middle of travel where there is none, which says which F_L of a table."""
        return np.full(len(self.dp), 0.5) if self.measured is None else np.clip(self.measured, 0.0, 1.0)

    def lacks(self, effect):
        """What an effect would need of the user's simulation that it has not; empty where it can act."""
        if effect.stage in ACTUATOR_STAGES:
            return self._lacks_in_actuator(effect)
        if self.given_flow is None or effect.stage == "position_sensor":
            return super().lacks(effect)
        if effect.stage == "choking" and effect.name in self.valve.physics:
            return "the F_L that the simulation given holds"
        trial = GivenChain(self.recording, self.valve, self.trim, effects=(effect,), choking=self.choking)
        try:
            values = {f"{effect.key}.{q.name}": q.starts[0] for q in effect.quantities(self)}
            trial.flow(values | {"given_gain": 1.0, "meter_lag": 0.1, "meter_ahead": 0.5})
            own = {q.name: q.starts[0] for q in effect.quantities(trial)}
            effect.beyond_tolerance(own, trial, _Loose(), False)
            effect.possible(trial)
        except NoOpening:
            return "a recorded opening that the simulated flow follows"
        return ""

    def _lacks_in_actuator(self, effect):
        if self.given_opening is None and self.measured is not None:
            return super().lacks(effect)
        if effect.stage == "actuator":
            return "the package's own simulation of the actuator"
        # shifted in time a flow is what a late command would make of it; of a limited stem it shows nothing
        late = effect.name == "dead_time"
        return "" if late or self.given_opening is not None else "a recorded opening"

    def stem_of_free_run(self, values):
        """Opening of the stem [1]: the given one, or the free run from the command where none is given."""
        if self.given_opening is None:
            return super().stem_of_free_run(values)
        stem = delayed(self.given_opening, self.time, values["actuator_delay"])
        stem = first_order_lag(stem, self.step, values["actuator_filter"], 1.0)
        return self._through("stem", self._through("signal", stem, values), values)

    def free_runs_ahead(self, several):
        """As in `Chain`; a given opening needs no runs."""
        if self.given_opening is None and self.given_flow is None:
            super().free_runs_ahead(several)

    def drive(self, values):
        """Opening that drives the flow side [1]; the command where none is recorded beside a given flow."""
        if self.given_flow is None or self.measured is not None:
            return super().drive(values)
        if self.command is None:
            raise NoOpening
        return self.command

    def flow(self, values, stem=None):
        """Flow as the meter would show it [m3/s, or kg/s where recorded by mass]."""
        if self.given_flow is None:
            return super().flow(values, stem)
        share, more_drop = self._share(self.measured, values), self._more_drop(values)
        flow = share * self.given_flow * more_drop
        if self.measured is None:
            flow = self._through("signal", flow, values)
        flow = flow + self._added(values, share, more_drop)
        flow = self._through("flow", flow, values)
        flow = first_order_lag(flow, self.step, values["meter_lag"], values["meter_ahead"])
        return self._through("flow_meter", flow, values) + values.get("flow_zero", 0.0)

    def _share(self, opening, values):
        """The valve's own capacity, of the simulated one: a gain, and a trim within its tolerance [1]."""
        if opening is None:
            return values["given_gain"]
        return values["given_gain"] * self.trim.factor(np.clip(opening, 0.0, 1.0), values)

    def _own_choking(self, values):
        """F_L and corner of the valve itself, within the tolerance of those simulated."""
        if "fl_scale" not in values:
            return self._choking_given()
        return self._choking(self._opening_seen(), values)

    def _more_drop(self, values):
        """By what factor the flow changes with the zero of the pressures and the valve's own choking [1]."""
        zero = values.get("dp_zero", 0.0)
        if zero == 0.0 and "fl_scale" not in values:
            return 1.0
        own = self._root_of_drop(self.dp + zero, self.margin, **self._own_choking(values))
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.maximum(own / self._root, 0.0)
        return np.where(self._driven, ratio, 1.0)

    def _added(self, values, share, more_drop):
        """What effects on plug, capacity, line and pressures add to the given flow."""
        self._find_plug(values)
        if not any(e.stage in _CAPACITY_STAGES for e in self.effects):
            return 0.0
        own = share * self._kv
        kv = own + self._shift
        kv = self._through("line", self._through("capacity", kv, values), values)
        choking = self._through("choking", self._own_choking(values), values)
        before = own * self._root * more_drop
        added = FLOW_CONSTANT * (kv * self._root_of_drop(*self._drop_at_valve(values), **choking) - before)
        return added * self.density if self.recording.mass_flow else added

    def _find_plug(self, values):
        """Opening of the plug, and by how much the trim's capacity there differs from that simulated."""
        self._shift, self._plug = 0.0, None
        if self.measured is None or self.trim.curve is None:
            if any(e.stage == "plug" for e in self.effects):
                raise NoOpening
            return
        self._plug = np.clip(self._through("plug", self.drive(values), values), 0.0, 1.0)
        if any(e.stage in ("plug", "position_sensor") for e in self.effects):
            seen = np.clip(self.measured, 0.0, 1.0)
            self._shift = self._own_capacity(self._plug, values) - self._own_capacity(seen, values)

    def _own_capacity(self, opening, values):
        """Capacity of the valve's own trim at an opening [m3/h]."""
        return self._share(opening, values) * self.capacity_at(opening)

    @property
    def plug(self):
        """Opening of the plug [1]."""
        if self.given_flow is not None and self._plug is None:
            raise NoOpening
        return self._plug

    @plug.setter
    def plug(self, value):
        self._plug = value

    def capacity_at(self, plug):
        """Capacity of the given simulation, or of the trim, at an opening of the plug [m3/h]."""
        if self.given_flow is None:
            return super().capacity_at(plug)
        return self.trim.at(plug)


class _Loose:
    """Any tolerance: asked only whether an effect can be weighed at all."""

    def __getattr__(self, name):
        return 1.0


def require_given(values, recording):
    """Refuse a recording that lacks the simulation which the values correct.

    Raises
    ------
    InputError
        Naming the role.
    """
    if "given_gain" in values and "simulated_flow" not in recording:
        raise InputError(
            f"{recording.source}: the model corrects a simulation of your own, and the recording has no "
            "simulated_flow; add the column and its section [recording.simulated_flow]"
        )
