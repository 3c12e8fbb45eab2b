# SPDX-License-Identifier: BSD-3-Clause
"""A drawn plant that is recorded, and then moved by hand through a test behind the same recording."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from benchmarks.concealed import record
from benchmarks.concealed.cases import Case
from benchmarks.concealed.distances import Scene, between
from benchmarks.concealed.distances.detectable import of_times
from benchmarks.concealed.plant import EFFECTS, NAMED, Course, Plant, programs
from benchmarks.concealed.plant.rig import WARM_UP
from sklvalve.recording import Recording, Valve, join_recordings

ROWS, TEST_ROWS = 2400, 900
STEPS = (1.0, 2.0, 3.0)
# what conceals besides, and leaves every signal that a test needs
WAYS = ("wandering", "correlated", "growing_with_flow", "wrong_sheet", "quantised", "disturbed", "confounded")
# a tank is not emptied below this [Pa], nor brought nearer to the source than this share of its pressure
_LOWEST, _NEAREST = 1.1e5, 0.1


@dataclass(frozen=True)
class Drawn:
    """What one record conceals, and how."""

    effect: str
    excitation: str
    course: str
    step: float
    nasty: tuple
    seed: int


def drawn(seed, number, kinds=()):
    """The case of this number: kinds of effects in a drawn order, over and over.

    Parameters
    ----------
    seed, number : int
    kinds : sequence of str, default=()
        Names of effects; all that water can have unless given.
    """
    names = list(kinds) or [n for n in NAMED if EFFECTS[n].fluid == "water"]
    order = np.random.default_rng([seed, 31, number // len(names)]).permutation(names)
    rng = np.random.default_rng([seed, 32, number])
    effect = EFFECTS[str(order[number % len(names)])]
    excitation = str(rng.choice(effect.asks or programs.EXCITATIONS))
    course = {"start": "start", "within": "within"}.get(effect.when) or str(rng.choice(["start", "within"]))
    nasty = (str(rng.choice(WAYS)),) if rng.random() < 0.5 else ()
    own = int(rng.integers(2**31))
    return Drawn(effect.name, excitation, course, float(rng.choice(STEPS)), nasty, own)


class Stand:
    """A plant with one effect.

    Parameters
    ----------
    what : Drawn
    rows : int, default=2400
        Of the recording.

    Raises
    ------
    benchmarks.concealed.record.Impossible
        If the effect cannot be so large in the plant that was drawn.
    """

    def __init__(self, what, rows=ROWS):
        self.what, self.rows = what, rows
        self.told = EFFECTS[what.effect].told
        self.plant = Plant(what.seed, what.excitation, rows, TEST_ROWS, "water", what.nasty)
        self.case = Case(0, "single", (what.effect,), what.step, what.excitation, what.course, what.nasty)
        rng = np.random.default_rng([what.seed, 3])
        self.course = Course.drawn(rng, what.course, rows)
        record._write_sheet(rng, self.plant, self.case)
        sign = float(rng.choice([-1.0, 1.0])) if EFFECTS[what.effect].signed else 1.0
        size, _ = of_times(self.plant, what.effect, self.course, what.step, (), sign)
        if size is None:
            raise record.Impossible(f"{what.effect} is not possible here")
        self.strengths = {what.effect: float(size)}
        self.scene = self._run()
        self.recording = self._read(self.scene).slice(0, rows)

    def _run(self):
        schedule = self.plant.schedule(self.strengths, self.course)
        return Scene(self.plant, schedule, self.plant.run(schedule), later=True)

    def _read(self, scene):
        # the same dice for every run: what was recorded before a test stays as it was
        rng = np.random.default_rng([self.what.seed, 4])
        _, table = record.recorded(rng, self.plant, scene, self.case)
        frame = pd.DataFrame({k: v for k, v in table.items() if k not in ("F_sim", "SP")})
        return Recording.from_frame(frame, Valve.from_dict(record.valve_of(self.plant, table, self.case)))

    def tested(self, plan):
        """The recording and that of the test behind it, joined, and its scene.

        The valve is taken by hand; "as now" leaves it to its controller. Pressures are moved at source and
        tank, so that those at the valve follow less far, as a line lets them.
        """
        rows = slice(WARM_UP + self.rows, WARM_UP + self.rows + len(plan.command))
        by_hand = plan.name != "as now"
        moved = {"p1": plan.moved.get("p1", 0.0), "p2": plan.moved.get("p2", 0.0)}
        scene = self._driven(rows, plan.command if by_hand else None, moved)
        whole, last = self._read(scene), self.rows + len(plan.command)
        parts = [(0, self.rows, "recording"), (self.rows, last, "test")]
        return join_recordings([replace(whole.slice(a, b), source=name) for a, b, name in parts]), scene

    def _driven(self, rows, command, moved):
        plant = self.plant
        before = plant.given, plant.auto, plant.weather
        plant.given, plant.auto, plant.weather = (series.copy() for series in before)
        if command is not None:
            plant.given[rows], plant.auto[rows] = command, 0
        # surroundings go on a line from second to second: a second later, so that no row before sees it
        late = slice(rows.start + 1, rows.stop)
        source, tank = plant.weather[late, 0], plant.weather[late, 1]
        source += _but_the_last(moved["p1"])
        tank[:] = np.clip(tank + _but_the_last(moved["p2"]), _LOWEST, (1.0 - _NEAREST) * source)
        scene = self._run()
        plant.given, plant.auto, plant.weather = before
        return scene

    def apart(self, scene, names):
        """The plant's own distances of the truth from members of a class; those it cannot make are left out.

        Parameters
        ----------
        scene : Scene
        names : sequence of str
            Of the catalogue.
        """
        found = between(scene, self.course, (self.what.effect,), set(names))
        return {name: found[name] for name in names if name in found}

    def apart_at_best(self, names):
        """The same after a rich test of the plant's own: the whole travel, with the tank moved besides."""
        rng = np.random.default_rng([self.what.seed, 5])
        rows = slice(WARM_UP + self.rows, self.plant.n_all)
        many = rows.stop - rows.start
        moved = {"p1": 0.0, "p2": programs.levels(rng, many, -1.5e5, 1.5e5, (40.0, 120.0), (2.0, 10.0))}
        return self.apart(self._driven(rows, programs.wide_command(rng, many), moved), names)


def _but_the_last(series):
    return series[:-1] if np.ndim(series) else series
