# SPDX-License-Identifier: BSD-3-Clause
"""The real noise as an autoregression, and by it: what could be told, and what from what.

The distance of two explanations is the squared length of the difference of their rests, each whitened by the
autoregression of the healthy rest, with all that a calibration leaves free projected away. An effect is just
detectable at a distance of 25 from nothing; two explanations are told apart from 14 on. Real noise is more
than an autoregression: how large it makes an effect look that is not there is measured by sliding the real
rest past the effect's signature, and distances are divided by that.
"""

from dataclasses import replace

import numpy as np
from scipy.linalg import solve_toeplitz
from scipy.signal import lfilter

from benchmarks.concealed.inject.effects import ALSO, EFFECTS, possible
from benchmarks.concealed.inject.passage import Trim

DETECTABLE, APART, ORDER = 25.0, 14.0, 12


# from this change on an effect counts: rms where it acts, of the largest flow or of travel
COUNTS = 0.005
SHIFTS = 25


def autoregression(rest, order=ORDER):
    """Coefficients [1, -a1, ...] and scatter of what they leave, by the equations of Yule and Walker."""
    rest = rest - rest.mean()
    n = len(rest)
    lags = np.array([rest[: n - k] @ rest[k:] for k in range(order + 1)]) / n
    if lags[0] <= 0.0:
        return np.r_[1.0, np.zeros(order)], 1.0
    lags[0] *= 1.0 + 1e-6
    ahead = solve_toeplitz(lags[:-1], lags[1:])
    scatter = np.sqrt(max(lags[0] - ahead @ lags[1:], 1e-6 * lags[0]))
    return np.r_[1.0, -ahead], float(scatter)


class Ruler:
    """Distances between explanations of one base.

    Parameters
    ----------
    base : Base
    """

    def __init__(self, base):
        self.base = base
        self.filters = [autoregression(rest[: base.rows]) for rest in base.rests() if rest is not None]
        self.free = np.linalg.qr(self._free())[0]

    def white(self, rests):
        """Rests of all signals, whitened and put one behind the other."""
        parts = [rest[: self.base.rows] for rest in rests if rest is not None]
        return np.concatenate(
            [lfilter(a, [1.0], part) / s for (a, s), part in zip(self.filters, parts, strict=True)]
        )

    def _free(self):
        """Whitened changes of the rests by what any calibration leaves free."""
        base = self.base
        signals = base.opening, base.recorded_flow
        healthy = self.white(base.unexplained(*signals))
        others = []
        trim = base.trim
        if base.source == "watersafe":
            # nobody knows trim, head, speeds and play of these: all of them are learnt from the record
            for k in range(len(trim.openings)):
                bent = trim.capacities + 1e-3 * trim.capacities.max() * np.eye(len(trim.openings))[k]
                others.append(replace(base, trim=Trim(trim.openings, bent)))
            names = ("delay", "meter_lag", "opening_speed", "closing_speed", "plug_play", "head")
        else:
            tilt = (trim.openings - trim.openings.mean()) / np.ptp(trim.openings)
            for shape in (np.ones(len(tilt)), tilt):
                others.append(replace(base, trim=Trim(trim.openings, trim.capacities * (1 + 1e-3 * shape))))
            others += [replace(base, zero=base.zero + 1e-4), replace(base, gain=base.gain * 1.001)]
            names = ("delay", "lag")
        for name in names:
            value = base.sound[name]
            others.append(replace(base, sound=base.sound | {name: value + max(0.01 * abs(value), 1e-4)}))
        columns = [self.white(other.unexplained(*signals)) - healthy for other in others]
        columns = [c / np.linalg.norm(c) for c in columns if np.linalg.norm(c) > 1e-9]
        return np.column_stack(columns)

    def squared(self, difference):
        """Squared length of a whitened difference, without what a calibration takes up."""
        left = difference - self.free @ (self.free.T @ difference)
        return float(left @ left)

    def from_nothing(self, change):
        """Distance of an effect from no effect."""
        seen, recorded, *_ = self.base.with_effect(change)
        return self.squared(
            self.white(self.base.unexplained(seen, recorded)) - self._own(seen, recorded, change)
        )

    def _own(self, seen, recorded, change):
        return self.white(self.base.unexplained(seen, recorded, change))

    def inflation(self, change):
        """Mean square of the size that real noise seems to hold of an effect, in standard errors; at least 1.

        The rest is shifted in a circle past the effect, which keeps its slow part and its calibration errors.
        """
        seen, recorded, *_ = self.base.with_effect(change)
        mark = self.white(self.base.unexplained(seen, recorded)) - self._own(seen, recorded, change)
        mark = mark - self.free @ (self.free.T @ mark)
        rest = self.white(self.base.rests()).reshape(len(self.filters), -1)
        steps = range(0, self.base.rows, max(self.base.rows // SHIFTS, 1))
        sizes = [np.roll(rest, step, axis=1).ravel() @ mark for step in steps]
        return max(float(np.mean(np.square(sizes)) / (mark @ mark)), 1.0)

    def counted(self, change):
        """Change that an effect makes, rms where it acts: the larger of flow over its largest and opening."""
        _, _, stem_opening, made = self.base.with_effect(change)
        rest, _ = self.base.rests()
        sound = self.base.stem() if rest is None else self.base.opening
        most = float(np.quantile(self.base.recorded_flow, 0.995))
        moved = (made - self.base.passage(sound)) / most, stem_opening + self.base.sensor(change) - sound
        # a stem that nobody recorded shows in the flow alone
        return max(_where_acting(part[: self.base.rows]) for part in moved[: 1 if rest is None else 2])

    def detectable(self, effect, sign, acts):
        """Size from which an effect can be told and counts, with its sign; None beyond what is sensible."""
        change = lambda size: effect.change(sign * size, self.base, acts)  # noqa: E731
        first = _least(lambda size: self.from_nothing(change(size)) >= DETECTABLE, effect.most)
        if first is None:
            return None
        inflated = DETECTABLE * self.inflation(change(first))
        least = _least(
            lambda size: self.from_nothing(change(size)) >= inflated and self.counted(change(size)) >= COUNTS,
            effect.most,
        )
        if least is None:
            return None
        # less than a scan is no delay or lag, and what a sheet leaves open from the start is calibration
        least = max(least, effect.least * self.base.dt) + (effect.allowed if acts.all() else 0.0)
        return sign * least if least <= effect.most else None

    def distances(self, effect, size, acts):
        """Distance from nothing, and from each other effect at its best size and beginning."""
        change = effect.change(size, self.base, acts)
        seen, recorded, *_ = self.base.with_effect(change)
        own = self._own(seen, recorded, change)
        inflation = self.inflation(change)
        nothing = self.squared(self.white(self.base.unexplained(seen, recorded)) - own)
        others: dict[str, float] = {}
        for rival in EFFECTS:
            if rival.name == effect.name or not possible(rival, self.base):
                continue
            begins = [acts] if acts.all() else [acts, np.ones_like(acts)]
            best = min(self._nearest(rival, one, seen, recorded, own) for one in begins)
            for name in (rival.name, *ALSO.get(rival.name, ())):
                if name != effect.name:
                    others[name] = min(best, others.get(name, np.inf), nothing)
        for name in ALSO.get(effect.name, ()):
            others[name] = 0.0
        return nothing / inflation, {name: distance / inflation for name, distance in others.items()}

    def _nearest(self, rival, acts, seen, recorded, own):
        """Least distance over the sizes of one rival: a coarse row of sizes, then closer about the best."""

        def distance(size):
            change = rival.change(size, self.base, acts)
            return self.squared(self._own(seen, recorded, change) - own)

        sizes = [sign * rival.most * share for sign in rival.signs for share in np.geomspace(1e-3, 1.0, 10)]
        found = [distance(size) for size in sizes]
        best, size, reach = min(found), sizes[int(np.argmin(found))], 2.15
        for _ in range(4):
            reach = np.sqrt(reach)
            for trial in (size * reach, size / reach):
                value = distance(trial)
                if value < best:
                    best, size = value, trial
        return best


def _least(enough, most):
    """Smallest size that is enough, by halving in logarithms; None where even the largest is not."""
    if not enough(most):
        return None
    low, high = 1e-4 * most, most
    if enough(low):
        return low
    for _ in range(16):
        middle = np.sqrt(low * high)
        low, high = (low, middle) if enough(middle) else (middle, high)
    return float(high)


def _where_acting(change):
    """Root mean square over the rows in which a change is a fifth of its largest or more."""
    size = np.abs(change)
    acting = size > 0.2 * np.quantile(size[size > 0.0], 0.99) if np.any(size > 0.0) else size > 0.0
    return float(np.sqrt(np.mean(change[acting] ** 2))) if acting.any() else 0.0
