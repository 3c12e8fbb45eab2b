# SPDX-License-Identifier: BSD-3-Clause
"""One drawn plant, which runs with any effects on the same surroundings."""

import zlib
from copy import copy
from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.plant import hardware, march, programs
from benchmarks.concealed.plant.columns import COLUMNS
from benchmarks.concealed.plant.effects import EFFECTS
from benchmarks.concealed.plant.fluids import properties
from benchmarks.concealed.plant.noise import Law

WARM_UP = 120  # seconds before the first recorded row
# ways in which an effect is there: throughout, from a moment on, on and off, growing until it is mended
COURSES = ("start", "within", "on_and_off", "mended")


@dataclass(frozen=True)
class Course:
    """When an effect acts: its kind, its onset [s from the first row], and its spells."""

    kind: str = "start"
    onset: float = 0.0
    spells: tuple = ()

    @classmethod
    def drawn(cls, rng, kind, rows):
        """A course of this kind, its onset in the middle of the record."""
        if kind == "start":
            return cls()
        onset = float(int(rng.uniform(0.25, 0.6) * rows))
        spells, t = [], onset
        while kind in ("on_and_off", "mended") and t < 2 * rows:
            busy = rng.uniform(0.08, 0.2) * rows if kind == "on_and_off" else rng.uniform(0.25, 0.4) * rows
            spells.append((t, t + busy))
            t += busy + (rng.uniform(0.05, 0.15) * rows if kind == "on_and_off" else 0.0)
        return cls(kind, onset, tuple(spells))

    def active(self, n, grows):
        """0 to 1 over the seconds, the warm-up among them."""
        t = np.arange(n) - WARM_UP
        on = np.ones(n) if self.kind == "start" else (t >= self.onset).astype(float)
        if self.spells:
            on = np.zeros(n)
            for begin, end in self.spells:
                inside = (t >= begin) & (t < end)
                on[inside] = (t[inside] - begin) / (end - begin) if grows and self.kind == "mended" else 1.0
            if self.kind == "mended":
                return on
        return on * np.cumsum(on) / max(on.sum(), 1.0) if grows else on


class Plant:
    """A plant, its surroundings, and what it is asked to do; runs with any effects without drawing anew.

    Parameters
    ----------
    seed : int
    excitation : {"wide", "closed", "cascade"}
    rows, later : int
        Rows recorded, one a second, and rows after them.
    fluid : {"water", "hot_water", "oil"}
    nasty : sequence of str
        What makes the record harder; those of them that concern the plant are known here.
    """

    def __init__(self, seed, excitation="wide", rows=3600, later=900, fluid="water", nasty=()):
        rng = np.random.default_rng([seed, 1])
        self.seed, self.excitation, self.fluid, self.nasty = seed, excitation, fluid, tuple(nasty)
        self.rows, self.n, self.n_all = rows, rows + later, rows + later + WARM_UP
        self.sheet = hardware.draw_sheet(rng)
        self.written = dict(self.sheet)
        self.trim, self.fl = hardware.draw_trim(rng, self.sheet)
        self.hard, self.sound = hardware.draw_hardware(rng, self.sheet)
        self.law = Law.drawn(rng, nasty)
        self.span = 1.5 * self.sheet["kv_rated"]
        self.kept, self.places = {}, {}
        self._surround(rng)
        self.noise = self.law.draw(rng, self.n_all, self.span)
        self.grown_for, self._dice = float(self.n), rng

    def another_hour(self, rng, excitation, rows, nasty, kept=None, zeros=None, sound=None):
        """The same plant at another time.

        Hardware, meters, scan and what `kept` and the sensors' zeros hold stay; what it is asked to do,
        pressures, the course of the temperature and the noise are drawn from `rng`.

        Parameters
        ----------
        rng : Generator
        excitation : {"wide", "closed", "cascade"}
        rows : int
        nasty : sequence of str
        kept, zeros, sound : dict, default=None
            What differs from this plant's `kept`, zeros of sensors, and sound columns of the schedule.
        """
        other = copy(self)
        other.excitation, other.nasty = excitation, tuple(nasty)
        other.rows, other.n, other.n_all = rows, rows, rows + WARM_UP
        other.kept = self.kept | (kept or {})
        other.sound = self.sound | (sound or {})
        other._surround(rng)
        other.noise = self.law.draw(rng, other.n_all, self.span, self.noise["zeros"] | (zeros or {}))
        other.grown_for, other._dice = float(rows), rng
        return other

    def _keep(self, name, drawn):
        """What was drawn of this before, or what is drawn now."""
        return self.kept.setdefault(name, drawn)

    def _surround(self, rng):
        n, kv = self.n_all, self.sheet["kv_rated"]
        source, tank = programs.pressures(rng, n, self.excitation, self.fluid == "hot_water")
        source = source + self._keep("source", 0.0)
        celsius = programs.temperature(rng, n, *self._keep("climate", programs.climate(rng, self.fluid)))
        self.given = np.round(programs.wide_command(rng, n), 4)
        self.setpoint = np.round(programs.flow_setpoint(rng, n, kv), 2)
        outflow = np.zeros(n)
        self.auto = np.zeros(n, dtype=np.int64)
        if self.excitation != "wide":
            self.auto[40:] = 1 if self.excitation == "closed" else 2
            self.given[:] = 0.6
        if self.excitation == "cascade":
            self.setpoint, outflow = programs.level_task(rng, n, kv)
        if "disturbed" in self.nasty:
            source = source + programs.levels(rng, n, -150e3, 60e3, (120.0, 400.0), (2.0, 20.0))
        if "rare" in self.nasty:
            self.given = self._mostly(self.given, rng)
        if "confounded" in self.nasty:
            # warmer, and against more pressure, when more is asked
            load = self.setpoint / kv if self.excitation == "closed" else self.given
            slow = np.convolve(np.pad(load, (60, 60), mode="edge"), np.ones(121) / 121.0, mode="valid")
            celsius = celsius + 5.0 * slow
            tank = tank + 80e3 * slow
        rho, vapour, floor = properties(self.fluid, celsius)
        self.weather = np.column_stack([source, tank, celsius, rho, vapour, floor, outflow])
        tuning = np.ones(n)
        if "retuned" in self.nasty:
            tuning[WARM_UP + int(rng.uniform(0.3, 0.6) * self.rows) :] = 0.3
        gain = self._keep("gain", rng.uniform(0.2, 0.4))
        gain = gain / (2.0 * kv) * (2.2 if "badly_tuned" in self.nasty else 1.0)
        ones = np.ones(n)
        columns = (
            gain * tuning,
            self._keep("reset", rng.uniform(5.0, 12.0)),
            0.02,
            1.0,
            2.0 * kv,
            900.0,
            0.25 * kv,
        )
        self.controller = np.column_stack([column * ones for column in columns])

    def _mostly(self, command, rng):
        """The command within a narrow band but for a few percent of the time."""
        often = 0.45 + 0.25 * (command - 0.5)
        visits = np.zeros(command.size, dtype=bool)
        for _ in range(3):
            begin = int(rng.uniform(0.05, 0.65) * self.rows) + WARM_UP
            visits[begin : begin + int(0.012 * self.rows)] = True
        visits[visits.size - int(0.5 * (self.n - self.rows)) :] = True
        return np.where(visits, command, often)

    def share(self, low, high):
        """A number that goes with the effect at hand, the same at every size."""
        return float(self._dice.uniform(low, high))

    def dice(self):
        """Source of all that an effect draws for itself, the same at every size."""
        return self._dice

    def schedule(self, strengths, course):
        """Columns by second, with these effects."""
        table = np.tile(np.array([self.sound[name] for name in COLUMNS]), (self.n_all, 1))
        columns = {name: table[:, i] for i, name in enumerate(COLUMNS)}
        for name, size in strengths.items():
            effect = EFFECTS[name]
            active = course.active(self.n_all, effect.grows)
            self.grown_for = float(np.count_nonzero(active > 0.0))
            self._dice = np.random.default_rng([self.seed, 2, zlib.crc32(name.encode())])
            if size != 0.0:
                effect.apply(columns, size, active, self)
        return table

    def run(self, schedule):
        """The whole loop, a row each fifth of a second (see `march.march_loop`)."""
        noise = self.noise["flow"]
        given = (self.given, self.auto, self.setpoint, self.weather, noise)
        return march.march_loop(schedule, *given, self.hard, self.trim, self.fl, self.controller)

    def actuator(self, schedule, command, drop):
        """Stem as read, and as it stands [1], under a command of every second and a drop [Pa]."""
        return march.march_actuator(schedule, command, drop, self.hard)

    def valve(self, schedule, stem, p1, p2, trim=None, fl=None):
        """Flow at the meter [m3/h], its gain and zero left out."""
        trim = self.trim if trim is None else trim
        fl = self.fl if fl is None else fl
        return march.march_valve(schedule, stem, p1, p2, self.weather, self.hard, trim, fl)
