# SPDX-License-Identifier: BSD-3-Clause
"""One case made real: a plant drawn, its effect sized, its loop run, its signals recorded."""

from dataclasses import dataclass

import numpy as np

from benchmarks.concealed.distances import Scene, between
from benchmarks.concealed.distances.between import APART
from benchmarks.concealed.distances.detectable import of_times, scene_of, standing_out
from benchmarks.concealed.plant import EFFECTS, Course, Plant, sensors
from benchmarks.concealed.plant.columns import COLUMNS
from benchmarks.concealed.plant.fluids import OIL_DENSITY, properties
from benchmarks.concealed.plant.hardware import relative_capacity
from benchmarks.concealed.plant.march import A_SECOND, COMMAND, METER
from benchmarks.concealed.plant.rig import WARM_UP

LATER = 900


class Impossible(ValueError):
    """A size that an effect cannot have in the plant that was drawn."""


@dataclass
class Made:
    """A record: its table, its sheet, what is behind it, its truth, its plant, and a table of its history."""

    table: dict
    valve: dict
    given: dict | None
    behind: dict
    truth: dict
    plant: Plant
    history: dict | None = None


def make(case, seed, *, rows=None, strengths=None, distances=True):
    """Draw the record of a case.

    Parameters
    ----------
    case : Case
    seed : int
    rows : int, default=None
        Of the record; drawn where none are given.
    strengths : dict, default=None
        Sizes of the effects, where they are known from an earlier draw, so that they are not looked for.
    distances : bool, default=True
        Whether to tell the distances to all other explanations, which takes most of the time.

    Raises
    ------
    Impossible
        If the effect cannot be so large in this plant.
    """
    rng = np.random.default_rng([seed, 3])
    drawn = int(rng.choice([2400, 3000, 3600, 4800]))
    rows = drawn if rows is None else rows
    plant = Plant(seed, case.excitation, rows, LATER, case.fluid, case.nasty)
    course = Course.drawn(rng, case.course, rows)
    lacking = tuple(n[3:] for n in case.nasty if n.startswith("no_"))
    _write_sheet(rng, plant, case)
    sizes: dict = {}
    signs = {name: float(rng.choice([-1.0, 1.0])) for name in case.effects if EFFECTS[name].signed}
    if strengths is None:
        strengths, sizes = _sized(plant, case, course, lacking, signs)
    whole = Scene(plant, *_run(plant, strengths, course), lacking, later=True)
    if "compensated" in case.nasty:
        _compensate(plant, whole)
    clean, table = recorded(rng, plant, whole, case)
    behind = _behind(whole, clean)
    truth = _truth(case, plant, course, strengths, sizes, clean, table, behind)
    if distances:
        truth |= _distances(case, scene_of(plant, strengths, course, lacking), course)
    valve = valve_of(plant, table, case)
    given = _given(valve) if "F_sim" in table and case.kind in ("healthy", "single") else None
    return Made(table, valve, given, behind, truth, plant)


def _run(plant, strengths, course):
    schedule = plant.schedule(strengths, course)
    return schedule, plant.run(schedule)


def _write_sheet(rng, plant, case):
    """What the sheet says, where it differs from what the maker meant: at the edge of its tolerance."""
    plant.written = dict(plant.sheet)
    if "wrong_sheet" in case.nasty:
        own = plant.trim[-1]
        plant.written["kv_rated"] = float(round(own / (1.0 + rng.choice([-1.0, 1.0]) * 0.09), 2))
        recovery = np.mean(plant.fl) / (1.0 + rng.choice([-1.0, 1.0]) * 0.08)
        plant.written["fl"] = float(min(round(recovery, 3), 1.0))


def _compensate(plant, scene):
    """A capacity on the sheet that hides the effect's mean, as far as a tolerance goes."""
    with_, without = scene.seen("flow", scene.schedule), scene.seen("flow", scene.sound)
    some = without > 0.02 * plant.span
    mean = float(np.median(with_[some] / without[some])) if some.any() else 1.0
    plant.written["kv_rated"] = float(round(plant.trim[-1] * np.clip(mean, 0.92, 1.08), 2))


def _sized(plant, case, course, lacking, signs):
    """Sizes of the effects, and what is told of how they were found."""
    strengths, told = {}, {}
    for name in case.effects:
        size, found = of_times(plant, name, course, case.step, lacking, signs.get(name, 1.0))
        if size is None:
            raise Impossible(f"{name} of {case.step:g} times its detectable size is not possible here")
        strengths[name] = float(size)
        told[name] = {"size": float(found.size), "distance": found.distance, "share": found.share}
    return strengths, told


def recorded(rng, plant, scene, case):
    """Signals behind the noise, and the table that the historian holds, both of all rows."""
    schedule, loop, rows = scene.schedule, scene.loop, slice(WARM_UP, None)
    column = lambda name: np.repeat(schedule[:, COLUMNS.index(name)], A_SECOND)  # noqa: E731
    fine = {
        "X": scene.reading,
        "P1": scene.p1,
        "P2": scene.p2,
        "F": column("meter_gain") * loop[:, METER] + column("meter_bias"),
        "T1": np.repeat(plant.weather[:, 2], A_SECOND),
    }
    missed = np.broadcast_to(scene.lost(schedule) * fine["F"], fine["F"].shape)[::A_SECOND]
    fine["F"] = fine["F"] * (1.0 - scene.lost(schedule))
    n = plant.n_all
    clean, table = (
        {},
        {"time": np.arange(plant.n), "CV": np.round(100.0 * loop[::A_SECOND, COMMAND], 2)[rows]},
    )
    roles = {"X": "opening", "P1": "p1", "P2": "p2", "T1": "temperature", "F": "flow"}
    scale = {"X": 100.0, "P1": 1e-3, "P2": 1e-3}
    for name, role in roles.items():
        place = plant.places.setdefault(name, sensors.scan_place(rng))
        values = sensors.scan(fine[name], sensors.scan_moments(rng, n, place), A_SECOND)
        noise = plant.noise[role]
        if name == "F":
            noise = noise * plant.law.envelope(values, plant.span) + values * plant.noise["turbulence"]
            # what it misses, it misses by bursts
            noise = noise + 0.5 * missed * rng.standard_normal(n)
        clean[name] = (values * scale.get(name, 1.0))[rows]
        width = sensors.RANGES.get(name, plant.span * sensors.FLOW_WIDTH)
        few = "quantised" in case.nasty and name in ("X", "F")
        bits = sensors.FEW_BITS if few else sensors.BITS
        read = sensors.convert((values + noise) * scale.get(name, 1.0), width, bits)
        if "compressed" in case.nasty:
            read = sensors.held(read, sensors.HELD * width)
        table[name] = np.round(read, 4)[rows]
    table["F"] = np.maximum(table["F"], -0.02 * plant.span)
    if plant.excitation == "closed":
        table["SP"] = np.where(plant.auto > 0, plant.setpoint, np.nan)[rows]
    table["F_sim"] = _plain(plant, table)
    for role in (n for n in case.nasty if n.startswith("no_")):
        del table[{"no_opening": "X", "no_p2": "P2"}[role]]
        table.pop("F_sim", None)
    return clean, _spoilt(table, case)


def _plain(plant, table):
    """Flow [m3/h] of a plain simulation of the user's: the sheet, recorded opening and pressures."""
    sheet = plant.written
    kv = sheet["kv_rated"] * relative_capacity(sheet, np.clip(table["X"] / 100.0, 0.0, 1.0))
    density, _, floor = properties(plant.fluid, np.asarray(table["T1"], dtype=float))
    drop = np.maximum(table["P1"] - table["P2"], 0.0) * 1e-2
    # without vapour pressure and density hot water would choke elsewhere, which is physics left out
    choked = sheet["fl"] ** 2 * np.maximum(table["P1"] * 1e-2 - floor * 1e-5, 0.0)
    return np.round(kv * np.sqrt(np.minimum(drop, choked) / (1e-3 * density)), 4)


def _spoilt(table, case):
    if "exchanged" in case.nasty:
        table["P1"], table["P2"] = table["P2"], table["P1"]
    if "rescaled" in case.nasty:
        table["F"] = np.round(table["F"] / 3.6, 4)
    return table


def _behind(scene, clean):
    """What is behind the noise, and what it would be without the effects."""
    rows = scene.recorded
    return {
        "time": np.arange(scene.plant.n),
        "flow": np.round(clean["F"], 5),
        "healthy_flow": np.round(
            clean["F"] - (scene.seen("flow", scene.schedule) - scene.seen("flow", scene.sound))[rows], 5
        ),
        "opening": np.round(clean["X"], 4),
        "healthy_opening": np.round(
            clean["X"]
            - 100.0 * (scene.seen("opening", scene.schedule) - scene.seen("opening", scene.sound))[rows],
            4,
        ),
    }


def _truth(case, plant, course, strengths, sizes, clean, table, behind):
    told = [EFFECTS[name].told for name in case.effects if EFFECTS[name].told]
    verdict = {"healthy": "no_mismatch", "outside": "none_of_these", "defect": "cannot_tell"}
    noise = {
        role: float(np.std((table[name] - clean[name])[: plant.rows]))
        for name, role in (("F", "flow"), ("X", "opening"))
        if name in table and case.kind != "defect"
    }
    onset = course.onset if case.effects else 0.0
    spells = [list(s) for s in course.spells] or ([[onset, float(plant.rows)]] if case.effects else [])
    return {
        "name": case.name,
        "generator": "benchmarks.concealed.plant",
        "kind": case.kind,
        "verdict": verdict.get(case.kind, "named"),
        "effects": [] if case.kind == "defect" else told,
        "concealed": list(case.effects),
        "blocks": sorted({EFFECTS[name].block for name in case.effects}),
        "onset": onset,
        "course": course.kind,
        "abrupt": course.kind == "within" and not any(EFFECTS[n].grows for n in case.effects),
        "intervals": [[a, min(b, float(plant.rows))] for a, b in spells if a < plant.rows],
        "strengths": strengths,
        "units": {name: EFFECTS[name].unit for name in case.effects},
        "parameters": _parameters(case, plant, course, strengths),
        "detectable": sizes,
        "excitation": case.excitation,
        "nasty": list(case.nasty),
        "size_step": case.step,
        "rows": plant.rows,
        "duration": float(plant.rows),
        "rows_later": plant.n - plant.rows,
        "noise_rms": noise,
        "fluid": plant.fluid,
        "physics": ["choked_flow"],
    }


def _parameters(case, plant, course, strengths):
    found = {}
    for name, size in strengths.items():
        effect = EFFECTS[name]
        plant.schedule({name: size}, course)  # says how long it grew
        if effect.parameter is not None and course.kind != "mended":
            parameter, unit, of = effect.parameter
            found[effect.told] = {"parameter": parameter, "value": float(of(size, plant)), "unit": unit}
    return found


def _distances(case, scene, course):
    """The plant's own distances, of records with something in them."""
    nothing = {"distances": {"nothing": None, "others": {}}, "distinguishable": None, "class": []}
    if case.kind in ("healthy", "defect"):
        return nothing
    if case.kind == "outside":
        return nothing | {"distances": {"nothing": round(standing_out(scene)[0], 1), "others": {}}}
    found = between(scene, course, case.effects)
    alone = found.pop("nothing")
    names = [EFFECTS[n].told for n in case.effects]
    near = sorted((d, name) for name, d in found.items() if d < APART)
    return {
        "distances": {"nothing": alone, "others": found},
        "distinguishable": alone >= APART and not near,
        "class": names + [name for _, name in near],
    }


def valve_of(plant, table, case):
    """What the engineer knows, as valve.toml has it."""
    kpa, sheet = {"unit": "kPa", "gauge": False}, plant.written
    columns = {
        "command": ("CV", {"unit": "%"}), "opening": ("X", {"unit": "%"}), "p1": ("P1", kpa),
        "p2": ("P2", kpa),         "temperature": ("T1", {"unit": "degC"}), "flow": ("F", {"unit": "m3/h"}),
    }  # fmt: skip
    fluid = {"name": "water"}
    if plant.fluid == "oil":
        fluid = {"density": OIL_DENSITY, "vapour_pressure": 0.02}
    recording: dict = {"time": "time"}
    recording |= {role: {"column": c} | more for role, (c, more) in columns.items() if c in table}
    return {
        "valve": {"tag": case.name} | {k: v for k, v in sheet.items() if k not in ("area", "supply")},
        "fluid": fluid,
        "actuator": {
            "fail": "closed",
            "supply_pressure": sheet["supply"],
            "spring_range": [20.0, 100.0],
            "effective_area": sheet["area"],
            "positioner": True,
        },
        "simulation": {"physics": ["choked_flow"]},
        "recording": recording,
    }


def _given(valve):
    """The same with the user's own simulation of the flow."""
    more = {"simulated_flow": {"column": "F_sim", "unit": "m3/h"}}
    return valve | {"recording": valve["recording"] | more}
