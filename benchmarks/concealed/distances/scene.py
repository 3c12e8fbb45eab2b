# SPDX-License-Identifier: BSD-3-Clause
"""What the recorded signals of one record would be under an explanation, everything else as it was.

An explanation is driven by what was recorded: the opening by the command and the drop, the flow by the
recorded opening and pressures, after the explanation has mended what it says is wrong with them. So
a controller hides nothing, and an effect shows in the channel where it acts.
"""

import numpy as np

from benchmarks.concealed.plant.columns import COLUMNS, FLOW_SIDE
from benchmarks.concealed.plant.march import A_SECOND, COMMAND, P1_READ, P2_READ, STEM_READ
from benchmarks.concealed.plant.rig import WARM_UP, Course

_AT = {name: i for i, name in enumerate(COLUMNS)}
_READING = ("x_gain", "x_bias", "loop_gain", "loop_bias")
_BEHIND = FLOW_SIDE + _READING
# what moves the stem itself; the reading's own errors do not
_BEFORE = tuple(name for name in COLUMNS if name not in FLOW_SIDE and name not in ("x_gain", "x_bias"))
_STEM = [_AT[name] for name in _BEFORE]


class Scene:
    """One plant after one run of its loop with some effects.

    Parameters
    ----------
    plant : Plant
    schedule : ndarray
        Of the run.
    loop : ndarray
        What the run gave.
    lacking : sequence of str
        Roles that the record does not have, of "opening" and "p2".
    later : bool, default=False
        Whether the rows after the record count too.
    """

    def __init__(self, plant, schedule, loop, lacking=(), later=False):
        self.n = plant.n_all if later else WARM_UP + plant.rows
        self.plant, self.lacking = plant, tuple(lacking)
        self.schedule, self.loop = schedule[: self.n], loop[: self.n * A_SECOND]
        fine = self._fine(self.schedule)
        self.command = self.loop[::A_SECOND, COMMAND].copy()
        self.reading = self._read(self.loop[:, STEM_READ], fine)
        self.p1 = self.loop[:, P1_READ] + fine["p1_bias"]
        self.p2 = self.loop[:, P2_READ] + fine["p2_bias"]
        self.sound = self.scheduled({}, Course())
        self.recorded = slice(WARM_UP, self.n)
        self._stem = None

    def scheduled(self, strengths, course):
        """Schedule of these effects over the rows that count."""
        return self.plant.schedule(strengths, course)[: self.n]

    @staticmethod
    def _fine(schedule):
        names = (*_READING, "p1_bias", "p2_bias")
        return {name: np.repeat(schedule[:, _AT[name]], A_SECOND) for name in names}

    @staticmethod
    def _read(stem, fine):
        return fine["x_gain"] * (fine["loop_gain"] * stem + fine["loop_bias"]) + fine["x_bias"]

    def opening(self, schedule):
        """Opening that the record would hold [1], a row each fifth of a second."""
        return self._read(self._moved(schedule)[:, 0], self._fine(schedule))

    def _moved(self, schedule):
        """Stem under a schedule; of a sound actuator it is marched once."""
        if np.array_equal(schedule[:, _STEM], self.sound[:, _STEM]):
            if self._stem is None:
                self._stem = self.plant.actuator(self.sound, self.command, self.p1 - self.p2)
            return self._stem
        return self.plant.actuator(schedule, self.command, self.p1 - self.p2)

    def flow(self, schedule, trim=None, fl=None):
        """Flow that the record would hold [m3/h], a row each fifth of a second."""
        fine = self._fine(schedule)
        if "opening" in self.lacking:
            stem = self._moved(schedule)[:, 0]
        else:
            stem = ((self.reading - fine["x_bias"]) / fine["x_gain"] - fine["loop_bias"]) / fine["loop_gain"]
        p1, p2 = self.p1 - fine["p1_bias"], self.p2 - fine["p2_bias"]
        meter = self.plant.valve(schedule, stem, p1, p2, trim, fl)
        gain = np.repeat(schedule[:, _AT["meter_gain"]], A_SECOND)
        return gain * meter * (1.0 - self.lost(schedule)) + np.repeat(
            schedule[:, _AT["meter_bias"]], A_SECOND
        )

    def lost(self, schedule):
        """Share of the flow that an ultrasonic meter misses in the noise of a throttled jet, in the mean."""
        strength = schedule[:, _AT["hum"]]
        if not strength.any():
            return 0.0
        loud = np.clip((self.p1 - self.p2) / np.maximum(self.p1, 1e3) - 0.25, 0.0, 1.0)
        return np.repeat(strength, A_SECOND) * loud

    def touches(self, schedule, channel):
        """Whether a schedule differs from the sound one in what the channel depends on."""
        names = _BEHIND if channel == "flow" else _BEFORE + _READING
        if channel == "flow" and "opening" in self.lacking:
            names = COLUMNS
        columns = [_AT[name] for name in names]
        return not np.array_equal(schedule[:, columns], self.sound[:, columns])

    def channels(self):
        """Those in which an explanation can show."""
        return ("flow",) if "opening" in self.lacking else ("opening", "flow")

    def seen(self, channel, schedule):
        """What the record would hold of a channel: flow [m3/h] or opening [1], a row a second."""
        fine = self.flow(schedule) if channel == "flow" else self.opening(schedule)
        return fine[::A_SECOND]
