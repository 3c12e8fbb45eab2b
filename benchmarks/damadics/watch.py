# SPDX-License-Identifier: BSD-3-Clause
"""Watching a valve second by second: does anything differ from the sound run?"""

import numpy as np

#: Causes that are measured: where they leave the range of the sound run nothing is held against it.
CAUSES = ("P1", "P2", "T1")
#: The actuator starts from rest, open: what it does before is not judged [s].
SETTLES = 250
# over which a residual is looked at, and for how long an alarm stands after its last second [s]
_OVER, _STANDS = 30, 120
# beyond what the sound run did: of the most that a residual was, and of the range of a cause
_BEYOND_RESIDUAL, _BEYOND_RANGE = 1.5, 0.25
_FLOW_RANGE = 40.0
# the noise of a flow is a share of it and one of the range, for most of it is that of the position
_SHARE_OF_RANGE = 0.2


class Watch:
    """Alarms where residuals of position or flow are larger, or causes are elsewhere, than in a sound run.

    Parameters
    ----------
    simulation : Nominal or Learnt
        Fitted on another part of the sound run.

    Attributes
    ----------
    limits_ : dict
        Channel -> rms over 30 s above which it alarms [1].
    ranges_ : dict
        Cause -> lowest and highest that is sound, in the frame's unit.
    visited_ : tuple
        The same of the stem [%].
    errors_ : dict
        Rms of the residuals of the sound frame, ``opening`` [% of travel] and ``flow`` [t/h].
    """

    def __init__(self, simulation):
        self.simulation = simulation

    def fit(self, frame):
        """Learn limits from a sound frame that the simulation was not fitted to."""
        settled = frame.iloc[SETTLES:]
        self.ranges_ = {cause: _wider(settled[cause]) for cause in CAUSES}
        self.visited_ = settled["X"].min(), settled["X"].max()
        # a simulation that begins in the middle of a run settles too
        residuals, flow = self.residuals(frame)
        residuals, flow = {c: left[SETTLES:] for c, left in residuals.items()}, flow[SETTLES:]
        self.limits_ = {c: _BEYOND_RESIDUAL * float(_rms(left).max()) for c, left in residuals.items()}
        left, in_range = residuals["flow"] * _weight(flow), settled["F_in_range"].notna().to_numpy()
        self.errors_ = {
            "opening": 100.0 * float(np.sqrt(np.mean(residuals["opening"] ** 2))),
            "flow": float(np.sqrt(np.mean(left[in_range] ** 2))),
        }
        return self

    def residuals(self, frame):
        """Recorded less simulated, and the simulated flow.

        The simulation speaks where the sound run was: causes are brought back into their range, and a flow
        counts within the range of its meter and of the openings that were visited.

        Returns
        -------
        residuals : dict of ndarray of shape (n,)
            ``opening`` [1], ``flow`` [share of flow and of its range].
        flow : ndarray of shape (n,)
            Simulated [t/h].
        """
        causes = {cause: frame[cause].clip(*limits) for cause, limits in self.ranges_.items()}
        recording = self.simulation.recording(frame.assign(**causes))
        flow = np.clip(self.simulation.flow(recording), 0.0, _FLOW_RANGE)
        visited = frame["X"].between(*self.visited_).to_numpy()
        return {
            "opening": recording["opening"] - self.simulation.opening(recording),
            "flow": np.where(visited, (frame["F"].to_numpy() - flow) / _weight(flow), 0.0),
        }, flow

    def alarms(self, frame):
        """When what alarms.

        Parameters
        ----------
        frame : DataFrame of n rows, one a second

        Returns
        -------
        alarms : dict of ndarray of shape (n,)
            Of ``opening``, ``flow`` and each cause, bool.
        residuals : dict of ndarray of shape (n,)
        """
        late = frame["time"].to_numpy() >= SETTLES
        found = {}
        for cause, (low, high) in self.ranges_.items():
            values = frame[cause].to_numpy()
            found[cause] = _standing(((values < low) | (values > high)) & late)
        residuals, _ = self.residuals(frame)
        for channel, left in residuals.items():
            found[channel] = _standing((_rms(left) > self.limits_[channel]) & late)
        return found, residuals


def _wider(values):
    """Range of what was seen, and something more to both sides."""
    low, high = float(values.min()), float(values.max())
    more = _BEYOND_RANGE * (high - low)
    return low - more, high + more


def _weight(flow):
    """What a residual of a simulated flow is weighed by [t/h]."""
    return flow + _SHARE_OF_RANGE * _FLOW_RANGE


def _rms(left):
    """Root mean square over the last seconds, of shape (n,); gaps count as nothing."""
    square = np.nan_to_num(left) ** 2
    total = np.concatenate([np.zeros(_OVER), np.cumsum(square)])
    return np.sqrt(np.maximum(total[_OVER:] - total[:-_OVER], 0.0) / _OVER)


def _standing(high):
    """Whether it was high within the last seconds."""
    seconds = np.arange(len(high))
    last = np.maximum.accumulate(np.where(high, seconds, -_STANDS))
    return seconds - last < _STANDS
