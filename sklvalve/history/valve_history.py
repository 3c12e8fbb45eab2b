# SPDX-License-Identifier: BSD-3-Clause
"""What is known of one valve from its own recordings."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.stats import chi2
from sklearn.base import BaseEstimator
from sklearn.utils.validation import check_is_fitted

from sklvalve._refits import whole_or_nothing
from sklvalve.history import state as plain
from sklvalve.history.allowance import Allowance
from sklvalve.history.by_itself import ByItself, more_open
from sklvalve.history.compatible import require_same_signals, require_same_valve
from sklvalve.history.learnable import (
    measured_of,
    recordings_of,
    require_further,
    require_learnable,
    require_sound_settings,
    require_sound_start,
)
from sklvalve.history.learning import (
    Window,
    calibrated_on,
    groups_of,
    pieces_of,
    sampled,
    windows_of,
)
from sklvalve.history.merging import moved, require_mergeable
from sklvalve.history.operating_range import OperatingRange
from sklvalve.history.posterior import FromSheet, centred, expected
from sklvalve.history.rehearsal import Rehearsal
from sklvalve.history.sources import Source
from sklvalve.history.state.settings import settings_of
from sklvalve.recording import Recording, Valve
from sklvalve.recording.diagnosable import FEWEST_ROWS
from sklvalve.simulation.calibration import choose_trim, spans_of
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.given import chain_for
from sklvalve.simulation.noise import NoiseParts
from sklvalve.simulation.parameters import JointPrior, Parameter, ParameterVector
from sklvalve.simulation.tolerance import Tolerance

# of the calibrations that a history lets expect, the share within reach
_EXPECTED = 0.99
# parameters that a meter or a sensor set to zero again may take beyond what its sheet allows
_ZEROS = ("position_zero", "stem_zero", "flow_zero", "dp_zero")


class ValveHistory(BaseEstimator):
    """History of one valve: what later recordings of it are held against.

    Parameters
    ----------
    valve : Valve, default=None
        Data sheet; that of the recordings unless given.
    tolerance : Tolerance, default=None
        What the data sheet leaves open.
    allowance : Allowance, default=None
        What may change without a fault between the history and a later recording.
    effects : sequence of Effect, default=()
        Physics beyond the sheet that the valve is known to have had in the history.
    onsets : dict, default=None
        Effect key -> absolute time [s] from which on it acts: the rows before tell the sound valve. A later
        recording has it from its first row on.
    start : dict, default=None
        Parameter -> value [SI] to begin the calibration with, as a simulation fitted to the same recordings
        has it in its ``values_``; searched for unless given.

    Attributes
    ----------
    values_ : dict
        Every parameter's value in the history, in SI.
    prior_ : JointPrior
        What is expected of the calibration in the next recording.
    windows_ : list of Window
        What each part of the recordings says.
    recordings_ : list of Source
        Which recordings it was learnt from: names of the files, checksums, times.
    range_ : OperatingRange
        Where the valve has been.
    spans_ : dict
        Role -> span of its signal [SI].
    roles_ : tuple of str
    mass_flow_ : bool
        Whether flow was recorded by mass.
    trim_ : Trim
    valve_ : Valve
    by_itself_ : ByItself or None
        What a diagnosis of the recordings by themselves said; None where none was made, as in `fit`.
        `MissingPhysicsFinder.history_of` makes one.
    rehearsals_ : list of Rehearsal
        How far later parts of the recordings lie from earlier ones; none unless `history_of` made them.

    Examples
    --------
    >>> from sklvalve import Recording, Valve, ValveHistory
    >>> from sklvalve.datasets import make_valve_recording
    >>> made = make_valve_recording(loop="wide", n_samples=900, n_later=0, random_state=3)
    >>> recording = Recording.from_frame(made.frame, Valve.from_dict(made.valve))
    >>> history = ValveHistory().fit(recording)
    >>> history.rows, len(history.windows_)
    (900, 1)
    """

    def __init__(
        self,
        valve: Valve | None = None,
        *,
        tolerance: Tolerance | None = None,
        allowance: Allowance | None = None,
        effects: Sequence[Any] = (),
        onsets: dict[str, Any] | None = None,
        start: dict[str, float] | None = None,
    ) -> None:
        self.valve = valve
        self.tolerance = tolerance
        self.allowance = allowance
        self.effects = effects
        self.onsets = onsets
        self.start = start

    @whole_or_nothing
    def fit(self, X: Recording | Iterable[Recording], y: Any = None) -> ValveHistory:
        """Learn the valve from its recordings.

        Parameters
        ----------
        X : Recording, DataFrame with role names as columns, in SI, or iterable of these
            Of the same signals and the same data sheet, at least 600 rows in all.
        y : ignored

        Returns
        -------
        self : ValveHistory

        Raises
        ------
        InputError
            If nothing, or something wrong, would be learnt of the valve.
        """
        require_sound_settings(self.tolerance, self.allowance)
        require_sound_start(self.start)
        recordings = recordings_of(X, self.valve)
        require_learnable(recordings)
        measured = measured_of(recordings)
        joined = sampled(measured)
        self.valve_ = self.valve or joined.valve
        tolerance = self.tolerance or Tolerance()
        self.trim_ = choose_trim(joined, self.valve_, tolerance)
        self.roles_, self.mass_flow_ = tuple(joined), joined.mass_flow
        self.spans_ = spans_of(joined)
        chain = self._chain(joined, self.onsets or {})
        self._groups_ = groups_of(chain, tolerance)
        self.values_ = calibrated_on(chain, self._groups_, tolerance, self.start)
        self.windows_: list[Window] = []
        self.recordings_: list[Source] = []
        self.range_ = OperatingRange()
        self.by_itself_: ByItself | None = None
        self.rehearsals_: list[Rehearsal] = []
        return self._learn(recordings, self.onsets or {}, fitted_to=measured)

    @whole_or_nothing
    def update(self, X: Recording | Iterable[Recording]) -> ValveHistory:
        """Learn from further recordings; what was learnt before is not fitted again.

        Parameters
        ----------
        X : Recording, DataFrame with role names as columns, in SI, or iterable of these

        Returns
        -------
        self : ValveHistory

        Raises
        ------
        InputError
            If a recording is of another valve or other signals, too short, or in the history already.
        """
        check_is_fitted(self, "values_")
        recordings = recordings_of(X, self.valve_)
        for recording in recordings:
            require_same_valve(self, self.valve or recording.valve, recording.source)
            require_same_signals(self, recording)
        # seconds of a further recording may have another zero; dates have not
        dated = all(isinstance(recording.stamps[0], str) for recording in recordings)
        return self._learn(recordings, (self.onsets or {}) if dated else {})

    def _learn(
        self,
        recordings: Sequence[Recording],
        onsets: dict[str, Any],
        *,
        fitted_to: Sequence[Recording] | None = None,
    ) -> ValveHistory:
        """Learn from recordings as they were measured; their rows are known again by what was recorded."""
        tolerance = self.tolerance or Tolerance()
        self.recordings_ = [*self.recordings_, *require_further(recordings, self.recordings_)]
        measured = fitted_to or measured_of(recordings, FEWEST_ROWS)
        self.windows_ = list(self.windows_)
        for recording in measured:
            for piece in pieces_of(recording):
                self.windows_ += windows_of(
                    self._chain(piece, onsets), self._groups_, self.values_, tolerance
                )
        if fitted_to:
            self.windows_ = self._centred()
        self.range_ = self.range_.merged(OperatingRange.of(measured))
        self.prior_ = self._expected()
        return self

    @whole_or_nothing
    def merge(self, other: ValveHistory) -> ValveHistory:
        """Add what another history of the same valve has learnt; nothing is fitted again.

        Parameters
        ----------
        other : ValveHistory
            Fitted, of the same signals and parameters, about a calibration of its own; `InputError` where it
            is not, or holds recordings of this one.

        Returns
        -------
        self : ValveHistory
        """
        check_is_fitted(self, "values_")
        require_mergeable(self, other)
        self.windows_ = [*self.windows_, *moved(self, other)]
        self.recordings_ = [*self.recordings_, *other.recordings_]
        self.rehearsals_ = [*self.rehearsals_, *other.rehearsals_]
        self.range_ = self.range_.merged(other.range_)
        asked = [each.by_itself_ for each in (self, other) if each.by_itself_ is not None]
        # of both the one by which less can be said later
        self.by_itself_ = more_open(asked)
        self.prior_ = self._expected()
        return self

    @whole_or_nothing
    def allowing(self, allowance: Allowance | None) -> ValveHistory:
        """Allow other changes without a fault; nothing is learnt again.

        Parameters
        ----------
        allowance : Allowance or None
            Takes the place of the one that the history has; None stands for the default.

        Returns
        -------
        self : ValveHistory

        Raises
        ------
        InputError
            If it is no `Allowance`, or holds what is no number above 0.
        """
        check_is_fitted(self, "values_")
        require_sound_settings(None, allowance)
        self.allowance = allowance
        self.prior_ = self._expected()
        return self

    def to_state(self) -> dict[str, Any]:
        """Everything of a fitted history but its valve, as plain numbers, texts and arrays."""
        check_is_fitted(self, "values_")
        return plain.told(self)

    @classmethod
    def from_state(cls, valve: Valve, state: dict[str, Any], effects: Sequence[Any] = ()) -> ValveHistory:
        """History from `to_state`; `effects` are the ones that its keys name."""
        # without a sheet of its own, so that recordings to come are asked for theirs
        made = cls(effects=tuple(effects), **settings_of(state["settings"]))
        made.valve_ = valve
        plain.put_back(made, state)
        made.prior_ = made._expected()
        return made

    @property
    def rows(self) -> int:
        """Number of rows learnt from."""
        return sum(window.rows for window in self.windows_)

    @property
    def allowed(self) -> Allowance:
        """What may change without a fault: `allowance`, or the default."""
        return self.allowance or Allowance()

    @property
    def days(self) -> float:
        """Time that was recorded [d]."""
        return sum(window.seconds for window in self.windows_) / 86_400.0

    @property
    def channels(self) -> tuple[str, ...]:
        """Signals that the simulation was calibrated by, opening and/or flow."""
        return tuple(channel for group in self._groups_ for channel in group.channels)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """Parameters of the calibration, as the sheet leaves them open."""
        return tuple(p for group in self._groups_ for p in group.parameters)

    def prior_of(self, parameters: Iterable[Parameter]) -> list[Parameter]:
        """Parameters of a calibration with what the history lets expect of them.

        Parameters
        ----------
        parameters : iterable of Parameter
            As the sheet has them; those that the history does not know stay as they are, and those of its
            effects begin where they were, and are free: what they have become is what is asked.

        Returns
        -------
        parameters : list of Parameter
        """
        return [self._known.get(p.name, p) for p in parameters]

    def left(self, channel: str) -> float:
        """Rms of what the calibrated simulation left over of a channel, in the median window [SI].

        Parameters
        ----------
        channel : {"opening", "flow"}
        """
        return float(np.median([w.left[channel] for w in self.windows_]))

    def expected_of(self, values: dict[str, float]) -> dict[str, float]:
        """Values of a calibration, drawn back where no history lets expect them.

        What lies further from the history's mean than all but one in a hundred calibrations would, all its
        parameters together, is drawn towards the mean until it does not.

        Parameters
        ----------
        values : dict

        Returns
        -------
        values : dict
            Of the same names.
        """
        known = [p for name, p in self._known.items() if name in values and p.joint is not None]
        if not known:
            return values
        vector = ParameterVector(known)
        z, mean = vector.pack(values), vector.pack({})
        away = float(np.sum(vector.prior_residuals(z) ** 2))
        most = float(chi2.ppf(_EXPECTED, len(known)))
        share = min(1.0, np.sqrt(most / max(away, 1e-12)))
        return values | vector.values(np.clip(mean + share * (z - mean), vector.low, vector.high))

    @cached_property
    def _known(self) -> dict[str, Parameter]:
        size = np.sqrt(np.diag(self.prior_.covariance))
        known = {}
        for p in self.parameters:
            at = self.prior_.names.index(p.name)
            mean = float(self.prior_.mean[at])
            start = float(np.exp(mean)) if p.log else mean
            low, high = p.low, p.high
            if p.name in _ZEROS:
                low, high = min(low, mean - 4.0 * size[at]), max(high, mean + 4.0 * size[at])
            # how large an effect was does not tell how large it is
            joint = None if "." in p.name else self.prior_
            known[p.name] = replace(
                p, low=low, high=high, start=float(np.clip(start, low, high)), joint=joint
            )
        return known

    def noise_parts(self, channel: str) -> NoiseParts:
        """Noise of a channel in the history: that of its median window.

        What the simulation gets wrong is that of the recording which went furthest: of a valve that was shut
        nothing tells it.

        Parameters
        ----------
        channel : {"opening", "flow"}
        """
        each = sorted((w.noise[channel] for w in self.windows_), key=lambda parts: parts.size)
        return replace(each[len(each) // 2], inadequacy=max(parts.inadequacy for parts in each))

    def _centred(self) -> list[Window]:
        """The windows that the calibration was fitted to, as they stand where it is the best one."""
        groups = [
            centred([w.information[k] for w in self.windows_], FromSheet.of(group.parameters, self.values_))
            for k, group in enumerate(self._groups_)
        ]
        each = zip(self.windows_, zip(*groups, strict=True), strict=True)
        return [replace(window, information=of_groups) for window, of_groups in each]

    def _expected(self) -> JointPrior:
        """The prior of the next recording, of all groups of channels in one."""
        self.__dict__.pop("_known", None)
        allowance = self.allowed
        names, means, covariances = [], [], []
        for k, group in enumerate(self._groups_):
            sheet = FromSheet.of(group.parameters, self.values_)
            windows = [w.information[k] for w in self.windows_]
            moves = np.average([w.moves for w in windows], axis=0, weights=[w.rows for w in self.windows_])
            allowed = allowance.covariance(group.parameters, self.spans_, moves)
            mean, covariance = expected(windows, sheet, allowed)
            means.append(sheet.unscaled(mean))
            covariances.append(covariance * np.outer(sheet.vector.scale, sheet.vector.scale))
            names += sheet.vector.names
        size = np.cumsum([0, *map(len, means)])
        covariance = np.zeros((size[-1], size[-1]))
        for k, part in enumerate(covariances):
            covariance[size[k] : size[k + 1], size[k] : size[k + 1]] = part
        return JointPrior(tuple(names), np.concatenate(means), covariance)

    def _chain(self, recording: Recording, onsets: dict[str, Any]) -> Chain:
        choking = "choked_flow" in self.valve_.physics and {"p1", "p2"} <= set(recording)
        return chain_for(
            recording,
            self.valve_,
            self.trim_,
            effects=tuple(self.effects),
            onsets=dict(onsets),
            choking=choking,
            filtered=True,
        )
