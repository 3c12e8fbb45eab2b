# SPDX-License-Identifier: BSD-3-Clause
"""One valve, simulated: the chain with its parameters, calibrated on a recording."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.metrics import r2_score
from sklearn.utils.validation import check_is_fitted

from sklvalve._refits import whole_or_nothing
from sklvalve.recording import InputError, Recording, Valve
from sklvalve.simulation.calibration import (
    channels_of,
    choose_trim,
    flow_parameters,
    opening_parameters,
    spans_of,
)
from sklvalve.simulation.fitting import first_noise, fit_chain
from sklvalve.simulation.given import chain_for, require_given
from sklvalve.simulation.given_columns import with_given
from sklvalve.simulation.going_on import going_on
from sklvalve.simulation.rest import learnt_rest
from sklvalve.simulation.tolerance import Tolerance
from sklvalve.simulation.trim_state import onsets_of_state, state_of_trim, trim_of_state


class ValveSimulation(RegressorMixin, BaseEstimator):
    """Simulation of one control valve from command to recorded signals.

    Calibrated on a recording within what a data sheet leaves open. It predicts flow, and serves as the
    mechanism of a hybrid (`forward`, `invert`): its parameter is then a factor on the capacity.

    Parameters
    ----------
    valve : Valve, default=None
        Data sheet; that of the recording unless given.
    tolerance : Tolerance, default=None
        How far the valve may lie from its sheet.
    effects : sequence of Effect, default=()
        Physics beyond the sheet, already known.
    onsets : dict, default=None
        Effect key -> absolute time [s] from which on it acts.

    Attributes
    ----------
    values_ : dict
        Every parameter's value, in SI.
    trim_ : SheetTrim or LearntTrim
    valve_ : Valve
    effects_, onsets_ : tuple of Effect and dict
        Those of the fit.
    correction_ : dict or None
        What data say beyond the physics, an LS-SVM in parallel as plain arrays.

    Examples
    --------
    >>> from sklvalve.datasets import make_valve_recording
    >>> from sklvalve.recording import Recording, Valve
    >>> from sklvalve.simulation import ValveSimulation
    >>> made = make_valve_recording(n_samples=600, n_later=0, random_state=0)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> simulation = ValveSimulation().fit(recording)
    >>> sorted(simulation.simulate(recording))
    ['flow', 'flow_from_command', 'opening']
    """

    def __init__(self, valve=None, tolerance=None, effects=(), onsets=None):
        self.valve = valve
        self.tolerance = tolerance
        self.effects = effects
        self.onsets = onsets

    @whole_or_nothing
    def fit(self, X, y=None):
        """Calibrate on a recording.

        Parameters
        ----------
        X : Recording, or DataFrame with role names as columns, in SI
        y : ignored
            The recording holds its own flow.

        Returns
        -------
        self : ValveSimulation

        Raises
        ------
        InputError
            If the recording lacks what a simulation is judged by.
        """
        recording = as_recording(X, y, self.valve)
        if len(recording) < 2:
            raise InputError(
                f"a calibration needs at least 2 rows, got {len(recording)}: give a longer recording"
            )
        tolerance = self.tolerance or Tolerance()
        channels = channels_of(recording)
        self.valve_ = self.valve or recording.valve
        self.trim_ = choose_trim(recording, self.valve_, tolerance)
        self.choking_ = "choked_flow" in self.valve_.physics
        self.effects_, self.onsets_ = tuple(self.effects), dict(self.onsets or {})
        self.correction_ = self.given_ = self.seen_ = None
        # those of a fit before would ask this recording for what that one held
        self.values_ = {}
        chain = self.chain_of(recording)
        parameters = []
        if "command" in recording:
            parameters += opening_parameters(recording, self.valve_, tolerance)
        if "flow" in channels:
            choking = self.choking_ and chain.margin is not None
            parameters += flow_parameters(recording, self.valve_, tolerance, self.trim_, choking=choking)
        for effect in self.effects_:
            for q in effect.quantities(chain):
                parameters.append(q.parameter_of(effect.key))
        noise = first_noise(spans_of(recording, channels))
        self.values_ = fit_chain(chain, parameters, channels, noise).values
        self.seen_ = (float(chain.clock[0]), float(chain.clock[-1]))
        return self

    @classmethod
    def from_parts(
        cls, valve, trim, values, *, choking, effects=(), onsets=None, correction=None, given=None, seen=None
    ):
        """Fitted simulation from its parts; no recording is touched.

        With `given`, a regressor or callable, what it predicts stands for a recorded simulation. `seen` holds
        the first and the last time [s, absolute] of the recording that it was fitted to.
        """
        made = cls(valve, None, tuple(effects), dict(onsets or {}))
        made.valve_, made.trim_, made.values_ = valve, trim, dict(values)
        made.effects_, made.onsets_ = tuple(effects), dict(onsets or {})
        made.choking_, made.correction_, made.given_ = choking, correction, given
        made.seen_ = None if seen is None else (float(seen[0]), float(seen[1]))
        return made

    def to_state(self):
        """Everything of a fitted simulation but its valve, as plain numbers, texts and arrays."""
        check_is_fitted(self, "values_")
        return {
            "values": dict(self.values_),
            "choking": bool(self.choking_),
            "effects": [e.key for e in self.effects_],
            "onsets": dict(self.onsets_),
            "seen": None if self.seen_ is None else list(self.seen_),
            "trim": state_of_trim(self.trim_),
            "correction": self.correction_,
        }

    @classmethod
    def from_state(cls, valve, state, effects):
        """Simulation from `to_state`; `effects` are the ones that its keys name."""
        return cls.from_parts(
            valve,
            trim_of_state(valve, state["trim"]),
            state["values"],
            # a fit without pressures knows no parameters of choking, and has no use for it
            choking=state["choking"] and bool({"fl_scale", "given_gain"} & set(state["values"])),
            effects=effects,
            onsets=onsets_of_state(state["onsets"]),
            correction=state["correction"],
            seen=state.get("seen"),
        )

    def simulate(self, X):
        """Simulated signals, in SI, as far as the signals of the recording allow.

        Parameters
        ----------
        X : Recording, or DataFrame with role names as columns

        Returns
        -------
        signals : dict of ndarray of shape (n,)
            ``opening`` [1], free run from the command; ``flow`` [m3/s, or kg/s], from the recorded opening
            or, without one, from the command; ``flow_from_command``, free run through the whole chain.
        """
        check_is_fitted(self, "values_")
        recording = as_recording(X, valve=self.valve_)
        chain, made = self.chain_of(recording), {}
        drives = "actuator_filter" in self.values_
        if drives and {"command", "simulated_opening"} & set(recording):
            made["opening"] = chain.opening(self.values_)
            made["opening"] = made["opening"] + self.learnt(chain, "opening")
        if "given_gain" in self.values_:
            made["flow"] = chain.flow(self.values_) + self.learnt(chain, "flow")
            return made
        if "capacity" not in self.values_ and "rise_0" not in self.values_:
            return made
        if "meter_lag" not in self.values_:
            return made
        if "opening" in recording or (drives and "command" in recording):
            made["flow"] = chain.flow(self.values_) + self.learnt(chain, "flow")
        if "opening" in made:
            stem = chain.drive_of_free_run(self.values_)
            made["flow_from_command"] = chain.flow(self.values_, stem) + self.learnt(chain, "flow", stem)
        return made

    def predict(self, X):
        """Flow as the meter would show it [m3/s, or kg/s], for a recording or a frame of roles in SI."""
        made = self.simulate(X)
        if "flow" not in made:
            raise InputError("a flow needs an opening or a command beside the pressures")
        return made["flow"]

    def score(self, X, y=None, sample_weight=None):
        r"""Share :math:`R^2` of the variance of the recorded flow that the simulated one explains.

        Parameters
        ----------
        X : Recording, or DataFrame with role names as columns, in SI
        y : array-like of shape (n,), default=None
            Flow [m3/s, or kg/s]; None takes the recorded one.
        sample_weight : array-like of shape (n,), default=None

        Returns
        -------
        score : float
            1 is perfect. Rows without a recorded or a simulated flow are left out.

        Raises
        ------
        InputError
            If there is no flow to compare with, or it is known in fewer than two rows.
        """
        if y is None:
            check_is_fitted(self, "values_")
            recording = as_recording(X, valve=self.valve_)
            if "flow" not in recording:
                raise InputError("a score needs a recorded flow; give a recording that holds one, or y")
            y = recording["flow"]
        y, made = np.asarray(y, dtype=float), self.predict(X)
        if y.shape != made.shape:
            raise InputError(f"y must hold one flow for each of {len(made)} rows, got shape {y.shape}")
        known = np.isfinite(y) & np.isfinite(made)
        if np.count_nonzero(known) < 2:
            raise InputError(
                "a score needs a recorded and a simulated flow in at least two rows; there are "
                f"{np.count_nonzero(known)}"
            )
        weight = None if sample_weight is None else np.asarray(sample_weight, dtype=float)[known]
        return float(r2_score(y[known], made[known], sample_weight=weight))

    def forward(self, X, parameter):
        """Flow with the capacity multiplied by `parameter` [1], row by row."""
        return self.predict(X) * np.asarray(parameter, dtype=float)

    def invert(self, X, y):
        """Factor on the capacity that gives the flow `y`; NaN where the simulation has no flow."""
        flow = self.predict(X)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(np.abs(flow) > 1e-12, np.asarray(y, dtype=float) / flow, np.nan)

    def learnt(self, chain, channel, stem=None):
        """What data add to a simulated channel, for a chain of `chain_of` and the opening `stem` [1]."""
        part = self.correction_
        if part is None or part["channel"] != channel:
            return 0.0
        return learnt_rest(part, chain, self.values_, stem)

    def chain_of(self, recording):
        """Stages of the simulation bound to the signals of a recording."""
        values = getattr(self, "values_", {})
        recording = with_given(recording, self.given_, "flow" if "given_gain" in values else "opening")
        require_given(values, recording)
        return chain_for(
            recording,
            self.valve_,
            self.trim_,
            effects=self.effects_,
            onsets=going_on(self.effects_, self.onsets_, getattr(self, "seen_", None), recording),
            choking=self.choking_ and "p1" in recording and "p2" in recording,
        )


def as_recording(X, y=None, valve=None):
    """Recording from a recording, or from a data frame of roles in SI with `y` as flow and a valve's sheet.

    Raises
    ------
    InputError
        If the signals have no names.
    """
    if isinstance(X, Recording):
        return X
    columns = (
        {str(c): np.asarray(X[c]) for c in X} if hasattr(X, "__getitem__") and hasattr(X, "keys") else None
    )
    if columns is None:
        raise InputError(
            f"a valve simulation needs signals by name; got {type(X).__name__}: give a Recording, or a "
            "data frame whose columns are roles such as command, opening, p1, p2, flow"
        )
    if y is not None and "flow" not in columns:
        columns["flow"] = np.asarray(y, dtype=float)
    n = len(next(iter(columns.values())))
    if "time" not in columns:
        index = None
        with suppress(TypeError, ValueError):
            of_frame = getattr(X, "index", None)
            index = np.asarray(of_frame, dtype=float) if getattr(of_frame, "name", None) == "time" else None
        columns["time"] = np.arange(n, dtype=float) if index is None else index
    # the signals are in SI already, so the sheet's own columns and units do not count
    bare = Recording.from_frame(columns, None)
    return replace(bare, valve=replace(valve or Valve(), roles={}, time="time"))
