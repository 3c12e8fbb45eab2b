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
_BEYOND_RESIDUAL, _BEYOND_RANGE = 1.25, 0.25
_FLOW_RANGE = 40.0
# the noise of a flow is a share of it and one of the range, for most of it is that of the position
_SHARE_OF_RANGE = 0.2


class Watch:
    """Alarms where residuals of position or flow are larger, or causes are elsewhere, than in a sound run.

    Parameters
    ----------
    simulation : Sheet
        Fitted on another part of the sound run.

    Attributes
    ----------
    limits_ : dict
        Channel -> rms over 30 s above which it alarms [1].
    ranges_ : dict
        Cause -> lowest and highest that is sound, in the frame's unit.
    """

    def __init__(self, simulation):
        self.simulation = simulation

    def fit(self, frame):
        """Learn limits from a sound frame that the simulation was not fitted to."""
        settled = frame["time"].to_numpy() - frame["time"].iloc[0] >= SETTLES
        rms = {channel: _rms(left) for channel, left in self.residuals(frame).items()}
        self.limits_ = {c: _BEYOND_RESIDUAL * float(values[settled].max()) for c, values in rms.items()}
        self.ranges_ = {}
        for cause in CAUSES:
            low, high = frame[cause].min(), frame[cause].max()
            wider = _BEYOND_RANGE * (high - low)
            self.ranges_[cause] = (low - wider, high + wider)
        return self

    def residuals(self, frame):
        """Recorded less simulated: opening [1], and flow within its meter's range [share of flow and range]."""
        recording = self.simulation.recording(frame)
        flow = np.clip(self.simulation.flow(recording), 0.0, _FLOW_RANGE)
        return {
            "opening": recording["opening"] - self.simulation.opening(recording),
            "flow": (frame["F"].to_numpy() - flow) / (flow + _SHARE_OF_RANGE * _FLOW_RANGE),
        }

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
        residuals = self.residuals(frame)
        for channel, left in residuals.items():
            found[channel] = _standing((_rms(left) > self.limits_[channel]) & late)
        return found, residuals


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
