# SPDX-License-Identifier: BSD-3-Clause
"""Effects inside the tolerance of the data sheet, which only a history can show.

    python -m benchmarks.concealed.within FOLDER --seed 7 --records 100

Each record holds one effect from its first row to its last, so small that a valve with it, the plant's own
departure from its sheet counted in, is still one that the sheet allows; its history, an hour of the same
plant, is without. Each is judged without the history and with it. Stopped and started again, it goes on where
it was; FOLDER gets `within.md`.

Frictions, dead bands and zeros of pressures are left out: inside their tolerances they move nothing by as
much as counts.
"""

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.concealed.cases import Case
from benchmarks.concealed.distances.calibration import nuisance_of
from benchmarks.concealed.distances.detectable import scene_of, standing_out
from benchmarks.concealed.draw import broken_seals, only_of, seal, seed_of, write
from benchmarks.concealed.histories import Kind, history_of, kind_of_history
from benchmarks.concealed.plant import EFFECTS, Course, Plant
from benchmarks.concealed.plant.hardware import relative_capacity
from benchmarks.concealed.plant.programs import EXCITATIONS
from benchmarks.concealed.record import make
from benchmarks.concealed.report.within import within_report
from benchmarks.concealed.run import judge_all
from benchmarks.concealed.scoring.lines import read_lines

METHODS = ("sklvalve", "sklvalve_history")
# plants that are tried for one in which the effect is inside the tolerance and counts
ATTEMPTS = 200
# of what counts, half a percent of span or travel where it acts
COUNTS, TIMES = 0.005, 1.5
# other ways to be hard, that leave every signal and the sheet as they are
WAYS = ("wandering", "correlated", "growing_with_flow", "quantised", "compressed", "disturbed", "confounded")
# what a sheet leaves open, as the package's `Tolerance` has it
CAPACITY, TRIM, RECOVERY, RESPONSE, STATIC, FLOW_ZERO = 0.1, 0.1, 0.1, 3.0, 0.01, 0.005


@dataclass(frozen=True)
class Inside:
    """One effect inside the tolerance.

    Attributes
    ----------
    low, high : float
        Between which its size is drawn.
    fits : callable
        ``fits(plant, size)``: whether the plant with it is one that its sheet allows.
    asks : tuple of str
        Excitations in which it can count.
    least : float
        Share of span or travel that it must move.
    """

    low: float
    high: float
    fits: object = lambda plant, size: True
    asks: tuple = EXCITATIONS
    least: float = TIMES * COUNTS


def _gain(plant, size):
    return abs(plant.trim[-1] / plant.sheet["kv_rated"] * (1.0 + size) - 1.0) <= CAPACITY


def _recovery(plant, size):
    return abs(float(np.mean(plant.fl)) / plant.sheet["fl"] * (1.0 - size) - 1.0) <= RECOVERY


def _trim(plant, size):
    grid = np.linspace(plant.sheet["shutoff"], 1.0, plant.trim.size)
    at = np.linspace(0.0, 1.0, plant.trim.size)
    sheet, own = relative_capacity(plant.sheet, grid), np.interp(grid, at, plant.trim) / plant.trim[-1]
    tolerance = TRIM * np.maximum(sheet, 1e-2) ** -0.2
    return bool(np.all(np.abs(own ** (1.0 + size) / sheet - 1.0) <= tolerance))


def _flow_zero(plant, size):
    return abs(plant.sound["meter_bias"] / plant.span + size) <= FLOW_ZERO


def _sum(column, most):
    return lambda plant, size: plant.sound[column] + size <= most


#: Effects by the plant's names. Play in the linkage moves the stem by half its width, less than what counts;
#: it is here all the same, since a user who asks for play of that size means it too.
INSIDE = {
    "capacity_error": Inside(0.03, 0.03, _gain),
    "choked_flow": Inside(0.10, 0.10, _recovery),
    "sensor_bias": Inside(0.009, 0.009),
    "loop_bias": Inside(0.009, 0.009),
    "plug_backlash": Inside(0.007, 0.007, _sum("plug_play", STATIC)),
    "link_backlash": Inside(0.007, 0.007, _sum("link_play", STATIC), least=0.003),
    "seat_leakage": Inside(0.007, 0.007),
    "bypass_open": Inside(0.007, 0.007),
    "leak_before_trim": Inside(0.007, 0.007),
    "leak_behind_trim": Inside(0.007, 0.007),
    "meter_gain": Inside(0.06, 0.09, _gain),
    "meter_zero": Inside(0.003, 0.0045, _flow_zero, asks=("closed", "cascade")),
    "wrong_characteristic": Inside(0.03, 0.045, _trim),
    "sensor_gain": Inside(0.006, 0.009),
    "loop_gain": Inside(0.006, 0.009),
    "actuator_lag": Inside(1.8, 2.7, _sum("lag", RESPONSE), asks=("wide",)),
    "dead_time": Inside(1.8, 2.7, _sum("dead_time", RESPONSE), asks=("wide",)),
    "meter_lag": Inside(1.8, 2.7, _sum("meter_lag", RESPONSE), asks=("wide", "closed")),
}


def case_of(seed, number):
    """Case of this number: effects in a drawn order, over and over.

    Parameters
    ----------
    seed, number : int

    Returns
    -------
    case : Case
    """
    names = list(INSIDE)
    order = np.random.default_rng([seed, 41, number // len(names)]).permutation(names)
    rng = np.random.default_rng([seed, 42, number])
    name = str(order[number % len(names)])
    nasty = (str(rng.choice(WAYS)),) if rng.random() < 0.5 else ()
    return Case(number, "single", (name,), excitation=str(rng.choice(INSIDE[name].asks)), nasty=nasty)


def made_inside(case, seed):
    """The record of a case with its history, in the first plant that has room for the effect.

    Parameters
    ----------
    case : Case
    seed : int

    Returns
    -------
    made : benchmarks.concealed.record.Made

    Raises
    ------
    ValueError
        If none of the plants that are tried has.
    """
    (name,) = case.effects
    inside = INSIDE[name]
    for attempt in range(ATTEMPTS):
        own = seed_of(case, seed, attempt)
        rng = np.random.default_rng([own, 43])
        size = rng.uniform(inside.low, inside.high)
        if EFFECTS[name].signed:
            size *= rng.choice([-1.0, 1.0])
        # a plant of a minute tells what it is made of
        if not inside.fits(Plant(own, case.excitation, 60, 0, case.fluid, case.nasty), size):
            continue
        made = make(case, own, strengths={name: float(size)}, distances=False)
        share = moved_share(made)
        if share >= inside.least:
            return _with_clean_history(case, made, share)
    raise ValueError(f"{name} has no room in {ATTEMPTS} plants; take another seed")


def moved_share(made):
    """Rms of what the effect moves, where it acts, as share of the flow's span or of travel; the larger."""
    behind, rows = made.behind, made.truth["rows"]
    shares = []
    for channel, span in (("flow", np.ptp(behind["flow"][:rows])), ("opening", 100.0)):
        size = np.abs(behind[channel] - behind[f"healthy_{channel}"])[:rows] / span
        acting = size > 0.2 * np.quantile(size, 0.99)
        shares.append(float(np.sqrt(np.mean(size[acting] ** 2))) if acting.any() else 0.0)
    return max(shares)


def distances_of(made):
    """Squared distance of the record from a valve without the effect, by the plant's own noise.

    Returns
    -------
    sheet, known : float
        What calibration within the sheet's tolerance leaves of it, and all of it, as it were of a healthy
        valve that is known to the last digit; a history comes to lie between.
    """
    scene = scene_of(made.plant, made.truth["strengths"], Course())
    known = 0.0
    for channel in scene.channels():
        if scene.touches(scene.schedule, channel):
            change = scene.seen(channel, scene.schedule) - scene.seen(channel, scene.sound)
            white = nuisance_of(scene, channel).law(change[scene.recorded][:, None])
            known += float(np.sum(white**2))
    return standing_out(scene)[0], known


def _with_clean_history(case, made, share):
    """The record and an hour without the effect; a fifth of these are excited in another way, too."""
    excitation = kind_of_history(case, made.plant.seed).excitation
    table, told = history_of(case, made, Kind(excitation))
    sheet, known = (round(distance, 1) for distance in distances_of(made))
    more = {"history": told, "moved_share": share, "known_distance": known}
    distances = {"distances": {"nothing": sheet, "others": {}}}
    return replace(made, history=table, truth=made.truth | more | distances)


def draw_within(folder, seed, records, report=print):
    """Draw the records that are not there yet."""
    only_of(folder, seed, {"within": records})
    for number in range(records):
        case = case_of(seed, number)
        if not (folder / case.name).exists():
            write(folder / case.name, made_inside(case, seed))
            report(f"{case.name} written")
    seal(folder)


def main(arguments=None):
    """Draw, judge, tell; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.concealed.within", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--records", type=int, default=100, help="100")
    parser.add_argument("--methods", nargs="*", choices=METHODS, default=list(METHODS), metavar="NAME")
    parser.add_argument("--jobs", type=int, default=1, help="processes; 1")
    options = parser.parse_args(arguments)
    folder = options.folder.resolve()
    if broken := broken_seals(folder):
        parser.error(f"the truth of {', '.join(broken)} is not the one that was sealed")
    try:
        draw_within(folder, options.seed, options.records)
    except ValueError as error:
        parser.error(str(error))
    if options.methods:
        files = judge_all(folder, options.methods, options.jobs)
        text = within_report(read_lines(*files))
        (folder / "within.md").write_text(text + "\n", encoding="utf-8")
        print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
