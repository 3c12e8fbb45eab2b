# SPDX-License-Identifier: BSD-3-Clause
"""Simulated years of valves under watch: how often a sound one calls, how soon one that changes does.

    python -m benchmarks.watch_years FOLDER --sound 40 --days 365
    python -m benchmarks.watch_years FOLDER --growing 40 --days 90

Valves, days and noise are those of the concealed benchmark's plant, which shares no code with the package. A
valve keeps its hardware, its meters and its controller; each day it is asked for something else. The liquid's
temperature follows the season, the pressure of the source wanders from day to day. A day is shortened to
`--rows` rows, one a second. What grows begins on a day drawn after the commissioning, and reaches twice the
size that an hour of the valve could just tell 30 days later. `watch_valve` sees what a run every morning
would have seen: its evidence on a day knows nothing of later ones.

A line of JSON a valve is kept in FOLDER; started again it goes on. The table is printed from these.
"""

import argparse
import datetime as dt
import json
import shutil
import time
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import chi2

from benchmarks.concealed.cases import Case
from benchmarks.concealed.distances import Scene
from benchmarks.concealed.distances.detectable import of_times
from benchmarks.concealed.plant import EFFECTS, NAMED, Course, Plant
from benchmarks.concealed.record import recorded, valve_of
from benchmarks.concealed.run import plain_lines
from benchmarks.concealed.scoring.rates import Rate
from sklvalve.recording.valve import Valve
from sklvalve.watch import watch
from sklvalve.watch.plant import Commissioning, Watched
from sklvalve.watch.plant import Plant as WatchedPlant
from sklvalve.watch.record import Finding
from sklvalve.watch.standing import DIAGNOSED, epochs_of, standing_of
from sklvalve.watch.store import Store

FIRST = dt.date(2026, 1, 1)
COMMISSIONED, GROWS, TIMES = 14, 30, 2.0
# how valves are driven, and how often: few stroke over their whole travel for hours
EXCITATIONS, SHARES = ("closed", "cascade", "wide"), (0.4, 0.4, 0.2)
WAYS = ("wandering", "correlated", "growing_with_flow", "quantised", "disturbed", "confounded")
# of the liquid over a year, and of the source from day to day
SEASON, SOURCE = 10.0, 20e3
HOUR = 3600


class Days:
    """One valve: its plant, its season, and what grows in it.

    Parameters
    ----------
    seed : int
    days, rows : int
    grows : bool
        Whether something does.
    """

    def __init__(self, seed, days, rows, grows):
        rng = np.random.default_rng([seed, 21])
        self.seed, self.days, self.rows = seed, days, rows
        self.excitation = str(rng.choice(EXCITATIONS, p=SHARES))
        self.nasty = (str(rng.choice(WAYS)),)
        self.plant = Plant(seed, self.excitation, HOUR, 0, "water", self.nasty)
        self.effect, self.size = self._drawn(rng) if grows else (None, 0.0)
        self.onset = int(rng.integers(COMMISSIONED + 5, days - GROWS - 5)) if self.effect else days
        self.phase = rng.uniform(0.0, 2.0 * np.pi)
        steps = rng.standard_normal(days)
        self.source = SOURCE * np.array([0.5 * np.sum(steps[max(k - 3, 0) : k + 1]) for k in range(days)])
        self.case = Case(seed, "healthy", (), None, self.excitation, "start", self.nasty, "water")

    def _drawn(self, rng):
        """What grows, and its size in the end, among what can be so large here."""
        for name in rng.permutation([n for n in NAMED if EFFECTS[n].fluid == "water"]):
            effect = EFFECTS[name]
            if effect.asks and self.excitation not in effect.asks:
                continue
            sign = float(rng.choice([-1.0, 1.0])) if effect.signed else 1.0
            size, _ = of_times(self.plant, name, Course(), TIMES, (), sign)
            if size is not None:
                return str(name), float(size)
        raise ValueError(f"nothing can grow in the plant of seed {self.seed}")

    def share(self, day):
        """How much of the effect is there on a day."""
        return float(np.clip((day - self.onset + 1) / GROWS, 0.0, 1.0))

    def table(self, day):
        """Columns of one day."""
        rng = np.random.default_rng([self.seed, 22, day])
        middle, swing = self.plant.kept["climate"]
        warm = SEASON * np.sin(2.0 * np.pi * day / 365.25 + self.phase)
        kept = {"climate": (middle + warm, swing), "source": self.plant.kept["source"] + self.source[day]}
        today = self.plant.another_hour(rng, self.excitation, self.rows, self.nasty, kept=kept)
        strengths = {self.effect: self.share(day) * self.size} if self.share(day) > 0.0 else {}
        schedule = today.schedule(strengths, Course())
        scene = Scene(today, schedule, today.run(schedule), ())
        return recorded(rng, today, scene, self.case)[1]

    def write(self, folder):
        """Rows of all days as Parquet, and the data sheet."""
        folder.mkdir(parents=True, exist_ok=True)
        for day in range(self.days):
            table = self.table(day)
            date = FIRST + dt.timedelta(days=day)
            stamps = np.datetime64(f"{date}T06:00:00") + np.arange(self.rows).astype("timedelta64[s]")
            frame = pd.DataFrame({k: v for k, v in table.items() if k not in ("F_sim", "SP")})
            frame.assign(time=np.datetime_as_string(stamps)).to_parquet(folder / f"{date}.parquet")
        return Valve.from_dict(valve_of(self.plant, table, self.case))


def watched(seed, days, rows, grows, place):
    """What came of one valve, as a line of the file."""
    began, tag = time.process_time(), f"FV-{seed}"
    valve = Days(seed, days, rows, grows)
    work = place / tag
    shutil.rmtree(work, ignore_errors=True)
    sheet = valve.write(work / "data" / tag)
    made = time.process_time()
    plant = WatchedPlant("years", (Watched(tag, sheet, tag, Commissioning(COMMISSIONED)),))
    [ends] = watch(plant, work / "data", work / "state", n_jobs=1)
    found = Store(work / "state").findings(tag)
    line = {
        "seed": seed, "days": days, "rows": rows, "excitation": valve.excitation, "nasty": valve.nasty,
        "effect": valve.effect, "told": EFFECTS[valve.effect].told if valve.effect else None,
        "size": valve.size, "onset": valve.onset, "state": ends.state, "said": ends.said[:5],
        "findings": [asdict(f) for f in found], "series": _series(tag, work / "state"),
        "seconds_drawn": made - began, "seconds_watched": time.process_time() - made,
    }  # fmt: skip
    shutil.rmtree(work)
    return line


def _series(tag, state):
    """Sizes day by day since the last look, so that another detector can be tried without simulating anew."""
    store = Store(state)
    epoch = epochs_of(tag, store)[-1]
    trend = standing_of(tag, store, epoch).trend
    return {
        "first": trend.days[0].isoformat() if trend.days else None,
        "reference": trend.reference,
        "keys": trend.keys,
        "sizes": np.round(trend.sizes, 6).tolist(),
    }


def number(iso):
    """Number of a day."""
    return (dt.date.fromisoformat(iso) - FIRST).days


def rate(many, years):
    """A rate a valve-year with its exact 95 % interval (Poisson)."""
    low = 0.5 * chi2.ppf(0.025, 2 * many) if many else 0.0
    high = 0.5 * chi2.ppf(0.975, 2 * many + 2)
    return f"{many / years:.3f} ({low / years:.3f}-{high / years:.3f}): {many} in {years:.1f} valve-years"


def share(many, of):
    """A share with its exact 95 % interval."""
    return f"{Rate(many, of)} of {of}"


def rows_of_table(lines):
    """What is printed."""
    every = [line for line in lines if line["effect"] is None]
    sound = [line for line in every if line["state"] in ("sound", "calls")]
    grown = [line for line in lines if line["effect"] is not None]
    if sound:
        # a valve that has called is no longer watched until somebody looks
        ends = [number(c[0]["called"]) if (c := calls_of(line)) else line["days"] for line in sound]
        years = sum(end - COMMISSIONED for end in ends) / 365.25
        yield "sound valves: calls a valve-year", rate(sum(bool(calls_of(v)) for v in sound), years)
        looks = sum(len(line["findings"]) - len(calls_of(line)) for line in sound)
        yield "- looks that found nothing", rate(looks, years)
        yield "- that name something", str(sum(any(c["names"] for c in calls_of(v)) for v in sound))
        yield "- not watched in the end, and not counted", str(len(every) - len(sound))
    if grown:
        early = [v for v in grown if any(number(c["called"]) < v["onset"] for c in calls_of(v))]
        rest = [v for v in grown if v not in early]
        first = {v["seed"]: calls_of(v)[0] for v in rest if calls_of(v)}
        delay = {
            v["seed"]: number(first[v["seed"]]["called"]) - v["onset"] for v in rest if v["seed"] in first
        }
        yield "called before it began", share(len(early), len(grown))
        yield (
            "growing: called before twice the size",
            share(sum(d < GROWS for d in delay.values()), len(rest)),
        )
        yield "- called at all", share(len(delay), len(rest))
        last = {v["seed"]: [c["names"] for c in calls_of(v) if c["names"]][-1:] for v in rest}
        named = [v for v in rest if last[v["seed"]]]
        right = [v for v in named if any(v["told"] in n.split("/") for n in last[v["seed"]][0])]
        yield "- named, of those called", share(len(named), len(delay))
        yield "- named rightly, of those called", share(len(right), len(delay))
        yield "- named rightly, of those named", share(len(right), len(named))
        twice = [v for v in named if named_twice(calls_of(v))]
        yield "- named by two diagnoses that share no day, of those named", share(len(twice), len(named))
        yield "- of these rightly", share(sum(v in right for v in twice), len(twice))
        if delay:
            yield "- days from its beginning to the call, median", f"{np.median(list(delay.values())):.0f}"
    days = sum(v["days"] for v in lines)
    spent = sum(v["seconds_watched"] for v in lines)
    yield "processor time a valve-day, all in", f"{spent / days:.2f} s"


def calls_of(line):
    """The diagnosis by which a valve called, and those of later days; none where it has not."""
    found = [f["verdict"] != "no_mismatch" for f in line["findings"]]
    return line["findings"][found.index(True) :] if any(found) else []


def named_twice(calls):
    """Whether a diagnosis shares a name of each of its classes with one that it shares no day with.

    Of two days each: `sklvalve.watch.standing.DIAGNOSED`.
    """
    found = [Finding(**(call | {"names": tuple(call["names"])})) for call in calls]
    return any(
        one.shared_with(other)
        for k, one in enumerate(found)
        for other in found[:k]
        if number(one.called) - number(other.called) >= DIAGNOSED
    )


def made_side_by_side(task, work, jobs, file, lines):
    """Add the line that a task makes of each piece of work to a file and to those that are there already."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for job in as_completed([pool.submit(task, *each) for each in work]):
            if job.exception() is not None:
                # one plant that cannot be drawn keeps no other from it
                print(f"left out: {job.exception()}", flush=True)
                continue
            lines.append(job.result())
            with file.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps(lines[-1], default=float) + "\n")
            print(f"{len(lines)} made", flush=True)


def main(arguments=None):
    """Run it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--sound", type=int, default=0, help="valves in which nothing happens")
    parser.add_argument("--growing", type=int, default=0, help="valves in which something grows")
    parser.add_argument("--days", type=int, default=365)
    parser.add_argument("--rows", type=int, default=900, help="rows of a day; 900")
    parser.add_argument("--first", type=int, default=1, help="first seed")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args(arguments)
    options.folder.mkdir(parents=True, exist_ok=True)
    file = options.folder / "years.jsonl"
    lines = plain_lines(file)
    done = {(line["seed"], line["days"], line["rows"], line["effect"] is not None) for line in lines}
    wanted = [(options.first + k, False) for k in range(options.sound)]
    wanted += [(options.first + k, True) for k in range(options.growing)]
    work = [w for w in wanted if (w[0], options.days, options.rows, w[1]) not in done]
    place = options.folder / "work"
    work = [(seed, options.days, options.rows, grows, place) for seed, grows in work]
    made_side_by_side(watched, work, options.jobs, file, lines)
    for what, told in rows_of_table(lines):
        print(f"| {what} | {told} |")


if __name__ == "__main__":
    main()
