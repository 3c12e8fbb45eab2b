# SPDX-License-Identifier: BSD-3-Clause
"""Healthy flow loops of a refinery, run again with a sticking valve in them.

Only what differs is simulated. With the recorded loop as it is, u and y, and a sticking one, u' and y':

    y' - y = g L (x' - u),   u' - u = -(Kp + Ki / s) (y' - y),   x' = sticking stem of u'

so that set-point, disturbances, noise and whatever the operators did cancel, and stay in the record to the
last digit; the controller answers the sticking. Gain g and lag L come from the set-point as instrument,
for a loop that is closed shows its controller where one would look for the process.
"""

from dataclasses import dataclass
from pathlib import Path

import numba as nb
import numpy as np
from scipy.signal import lfilter

from benchmarks.concealed.inject.noise import DETECTABLE, autoregression
from benchmarks.concealed.inject.stem import stick_slip

LAST_ROWS = 150
# rows over which changes of set-point, command and flow are compared
SPANS = (1, 3, 10, 30, 100)
LEAST_BAND = 0.25
# rows of response to the command that a linear explanation may have
RESPONSE = 13
# least correlation of the set-point's changes with the flow's, and least share that the controller explains
LEAST_MOVED, LEAST_CONTROLLED = 0.4, 0.7


@dataclass(frozen=True, eq=False)
class Loop:
    """A healthy window, `command` in percent, and what was identified from it.

    `gain` is flow a percent, `lag` in seconds, `proportional` percent a unit of flow, `integral` the same a
    second; `shared` are the shares in which set-point and controller can be trusted.
    """

    name: str
    rows: int
    dt: float
    command: np.ndarray
    value: np.ndarray
    setpoint: np.ndarray
    gain: float
    lag: float
    proportional: float
    integral: float
    shared: tuple
    source: str = "refinery"

    @property
    def usable(self):
        """Whether gain and controller could be identified."""
        stable = self.gain > 0.0 and self.proportional > 0.0 and self.integral > 0.0
        return stable and self.shared[0] >= LEAST_MOVED and self.shared[1] >= LEAST_CONTROLLED

    def fast(self, values):
        """A signal of rows on the straight line between them, at about a second."""
        per_row = max(round(self.dt), 1)
        n = len(values)
        return np.interp(np.arange((n - 1) * per_row + 1) / per_row, np.arange(n), values), per_row

    def run(self, stick, jump, onset=0.0):
        """Command, flow and stem of the loop with a stem that sticks from `onset` [s] on."""
        command, per_row = self.fast(self.command)
        acts = (np.arange(len(command)) * self.dt / per_row >= onset).astype(float)
        seconds = self.dt / per_row
        keep = np.exp(-seconds / self.lag) if self.lag > 0.0 else 0.0
        told, moved, at = _differing(
            command, acts, stick, jump, self.gain, keep, self.proportional, self.integral * seconds
        )
        rows = slice(None, None, per_row)
        return self.command + told[rows], self.value + moved[rows], at[rows]

    def answer(self, stem_less_command, per_row):
        """Change of the flow, a value a row, for a stem that is off by this at about a second."""
        keep = np.exp(-self.dt / per_row / self.lag) if self.lag > 0.0 else 0.0
        return lfilter([self.gain * (1.0 - keep)], [1.0, -keep], stem_less_command)[::per_row]

    def distance(self, command, moved):
        """Squared whitened length of a change of the flow that no linear process of the command takes up."""
        quiet = self.value - self.answer(
            self.fast(self.command - self.command[0])[0], self.fast(self.command)[1]
        )
        ahead, scatter = autoregression(quiet[: self.rows])
        white = lambda y: lfilter(ahead, [1.0], y[: self.rows]) / scatter  # noqa: E731
        about = command - command.mean()
        delayed = [np.r_[np.full(k, about[0]), about[: len(about) - k]] for k in range(RESPONSE)]
        free = np.linalg.qr(np.column_stack([white(y) for y in (np.ones(len(about)), *delayed)]))[0]
        left = white(moved)
        left = left - free @ (free.T @ left)
        return float(left @ left)

    def distances(self, stick, jump, onset):
        """Distance from a sound stem, and between stiction and the nearest play, or the reverse."""
        command, _, _ = self.run(stick, jump, onset)
        quick, per_row = self.fast(command)
        acts = np.arange(len(quick)) * self.dt / per_row >= onset
        made = lambda s, j: self.answer(  # noqa: E731
            stick_slip(quick, s * acts, j * acts, quick[0]) - quick, per_row
        )
        own = made(stick, jump)
        shares = (0.0,) if jump > 0.0 else (0.3, 0.6, 1.0)
        other = min(
            self.distance(command, own - made(stick * size, stick * size * share))
            for size in np.geomspace(0.4, 2.0, 13)
            for share in shares
        )
        return self.distance(command, own), other

    def detectable(self, jump_share, onset):
        """Stick band [% of travel] that can be told and counts; None where even the widest cannot.

        A band counts from a quarter of the command's movement on: every valve has a smaller one.
        """
        moved = float(np.ptp(np.quantile(self.command, [0.01, 0.99])))
        grid = np.geomspace(LEAST_BAND, 2.0, 16) * moved
        for band in grid:
            if self.distances(band, jump_share * band, onset)[0] >= DETECTABLE:
                return float(band)
        return None


@nb.njit(cache=True)
def _differing(command, acts, stick, jump, gain, keep, proportional, integral):
    n = len(command)
    told = np.zeros(n)
    moved = np.zeros(n)
    at = np.empty(n)
    state = command[0]
    rest = command[0]
    way = 0.0
    resting = True
    last = command[0]
    for k in range(n):
        if k > 0:
            told[k] = told[k - 1]
            before = moved[k - 2] if k > 1 else 0.0
            told[k] -= proportional * (moved[k - 1] - before) + integral * moved[k - 1]
        now = command[k] + told[k]
        # the law of `stick_slip`, a row at a time
        if acts[k] == 0.0:
            state = now
            rest = now
            way = 0.0
            resting = True
        else:
            step = now - last
            if not resting and step * way <= 0.0:
                resting = True
                rest = last
            if resting:
                gone = now - rest
                needed = jump if gone * way > 0.0 else stick
                if way == 0.0:
                    needed = 0.5 * (stick + jump)
                if abs(gone) > needed:
                    way = 1.0 if gone > 0.0 else -1.0
                    resting = False
            if not resting:
                state = now - 0.5 * way * (stick - jump)
        last = now
        at[k] = state
        before = moved[k - 1] if k > 0 else 0.0
        moved[k] = keep * before + (1.0 - keep) * gain * (state - command[k])
    return told, moved, at


def windows(data):
    """Healthy flow windows, each with what was identified from it, the usable ones and the others."""
    import pandas as pd

    folder = Path(data) / "refinery_loops"
    index = pd.read_csv(folder / "index.csv")
    frame = pd.read_csv(folder / "loops.csv.gz")
    out = []
    for row in index[(index.stiction == 0) & (index.loop == "FIC")].itertuples():
        part = frame[frame.id == row.id].drop_duplicates("t")
        signals = (part[name].to_numpy(dtype=float) for name in ("op", "pv", "sp"))
        out.append(identified(f"refinery {row.tag} {row.id}", *signals, dt=float(row.dt_s)))
    return out


def identified(name, command, value, setpoint, dt):
    """A loop from its three signals."""
    lags = np.r_[0.0, np.geomspace(0.2, 6.0, 18)]
    gain, lag = min((_instrumented(command, value, setpoint, lag) for lag in lags), key=lambda one: one[0])[
        1:
    ]
    span = 30
    moved = np.corrcoef(setpoint[span:] - setpoint[:-span], value[span:] - value[:-span])[0, 1] \
        if np.ptp(setpoint) > 0.0 else 0.0  # fmt: skip
    error, step = setpoint - value, np.diff(command)
    asked = np.column_stack([np.diff(error), error[1:]])
    weights, *_ = np.linalg.lstsq(asked, step, rcond=None)
    controlled = 1.0 - np.var(step - asked @ weights) / np.var(step)
    return Loop(
        name, len(command) - LAST_ROWS, dt, command, value, setpoint, gain, lag * dt,
        float(weights[0]), float(weights[1] / dt), (float(moved), float(controlled)),
    )  # fmt: skip


def _instrumented(command, value, setpoint, lag):
    """Gain for a lag [rows], from changes of the set-point; first what is left of their correlation."""
    keep = np.exp(-1.0 / lag) if lag > 0.0 else 0.0
    driven = lfilter([1.0 - keep], [1.0, -keep], command - command[0])
    told, due = [], []
    for span in SPANS:
        change = setpoint[span:] - setpoint[:-span]
        size = np.linalg.norm(change)
        if size > 0.0:
            told.append(change @ (driven[span:] - driven[:-span]) / size)
            due.append(change @ (value[span:] - value[:-span]) / size)
    told, due = np.array(told), np.array(due)
    if not len(told) or not told.any():
        return np.inf, 0.0, lag
    gain = float(told @ due / (told @ told))
    return float(np.sum((due - gain * told) ** 2)), gain, lag
