# SPDX-License-Identifier: BSD-3-Clause
"""Healthy recordings through the whole search: what the p-value is held against, and whether it is uniform.

    python benchmarks/healthy_reference.py draw REFERENCE.jsonl --records 360
    python benchmarks/healthy_reference.py table REFERENCE.jsonl sklvalve/mismatch/decide/null_reference.json
    python benchmarks/healthy_reference.py draw OTHER.jsonl --first 2000 --records 36 --nastier
    python benchmarks/healthy_reference.py check OTHER.jsonl

With ``--history`` each is held against the hour before it; that table is `null_reference_with_history.json`.
With ``--residual`` as well only what is left over beyond the noise of that hour is drawn, which no search
changes, and `table` puts it in the place of the one in the file; the other looks stay.
`draw` writes a line of JSON a recording, and goes on where it was stopped; five to ten seconds each. `table`
writes the reference that the package ships. `check` holds recordings of other seeds, and with noise that the
reference has none of, against the table: rates of alarms with exact intervals, and Kolmogorov-Smirnov.

The recordings are those of `sklvalve.datasets`, 2,400 to 4,200 rows, half to three times the noise, in closed
loop, over the whole travel or both. Some have a meter's noise of 0.95 from row to row, coarse readings or a
cycling temperature beside. Half lack the pressures or one of them, the opening or the command, and a fifth
come from a historian that writes a value when it has left the last one by a band, each signal's its own.
"""

import argparse
import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
from data_defects import box_car
from scipy.optimize import minimize_scalar
from scipy.signal import lfilter
from scipy.stats import beta, genpareto, kstest
from threadpoolctl import threadpool_limits

from sklvalve.datasets import make_valve_recording
from sklvalve.mismatch import MissingPhysicsFinder
from sklvalve.mismatch.data.masking import masked
from sklvalve.mismatch.data.preparation import candidates, prepared_problem
from sklvalve.mismatch.decide.detect import Evidence, mismatch_p_value
from sklvalve.mismatch.decide.detect import covariates_of as covariates_of_problem
from sklvalve.mismatch.decide.null_reference import (
    AGAINST_HISTORY,
    AGAINST_SHEET,
    EDGED,
    LOOKS,
    Covariates,
)
from sklvalve.mismatch.decide.suppression import suppressed
from sklvalve.mismatch.inference.calibrating import calibrated
from sklvalve.mismatch.residual.since_history import left_since
from sklvalve.recording import Recording, Valve
from sklvalve.recording.measured import screened
from sklvalve.simulation.parallel_map import with_threads

KINDS = ("wander", "heavy tails", "noise that grows with the flow", "noisy pressures")
# what half of the recordings lack, and up to which draw of 0 to 1
LACKING = ((0.12, ("P1", "P2")), (0.24, ("X",)), (0.32, ("CV",)), (0.46, ("P2",)), (0.5, ("P1",)))
# share of recordings that a historian held, and widths of its bands, shares of a signal's range
HELD, BANDS = 0.2, (0.001, 0.01)
# share of the reference above the threshold of its tail, and knots below
ABOVE, KNOTS = 0.15, 18
# rows of a history
BEFORE = 3600
# strengths below are as good as none: of effects; of what is left over beside a data sheet, and a history
WEAKEST, WEAKEST_RESIDUAL = 2.0, {False: 0.1, True: 1.0}
CIRCUMSTANCES = ("noise", "travel", "no_opening", "no_drop", "one_pressure", "held_opening", "held_flow")
# what else the typical strength is a line in
LINE = (*CIRCUMSTANCES, "noise_without_opening", "noise_without_drop")


def correlated(rng, rows, share):
    """Noise of variance 1 that keeps a share from row to row."""
    steps = np.sqrt(1.0 - share**2) * rng.standard_normal(rows)
    steps[0] = rng.standard_normal()
    return lfilter([1.0], [1.0, -share], steps)


def draw(seed, *, nastier=False, history=False):
    """A healthy recording, the hour before it if asked for, and what was drawn of it."""
    rng = np.random.default_rng([seed, 17])
    told = {"seed": seed, "loop": ("wide", "closed", "mixed")[rng.integers(3)]}
    told["times_noise"] = float(np.exp(rng.uniform(np.log(0.5), np.log(3.0))))
    rows = int(np.exp(rng.uniform(np.log(2400), np.log(4200)))) + (BEFORE if history else 0)
    settings = {"loop": told["loop"], "noise": told["times_noise"], "n_samples": rows, "n_later": 0}
    made = make_valve_recording(None, **settings, random_state=int(rng.integers(2**31)))
    frame, span, time = made.frame, made.frame.F.max(), np.arange(rows)
    if rng.random() < 0.4:
        frame["F"] += rng.uniform(0.001, 0.004) * span * correlated(rng, rows, 0.95)
    if rng.random() < 0.4:
        for column, step in (("F", rng.uniform(0.001, 0.005) * span), ("X", rng.uniform(0.1, 0.4))):
            frame[column] = step * np.round(frame[column] / step)
    if rng.random() < 0.3:
        frame["T1"] += rng.uniform(1.0, 5.0) * np.sin(2.0 * np.pi * time / rng.uniform(600.0, 2400.0))
    if nastier:
        told["kind"] = KINDS[rng.integers(4)]
        add_noise(frame, told["kind"], span, rng)
    chance, columns = rng.random(), made.valve["recording"]
    told["lacks"] = next((list(names) for up_to, names in LACKING if chance < up_to), [])
    if history and told["lacks"] == ["P1", "P2"]:
        # nothing is learnt of a loop of which no pressure is known
        told["lacks"] = ["P2"]
    for name in told["lacks"]:
        role = next(r for r, d in columns.items() if isinstance(d, dict) and d.get("column") == name)
        del frame[name], columns[role]
    frame["F"] = frame.F.round(3)
    if rng.random() < HELD:
        held = frame.columns.drop(["time", "CV"], errors="ignore")
        told["bands"] = {column: float(rng.uniform(*BANDS)) for column in held}
        for column, band in told["bands"].items():
            reach = 100.0 if column == "X" else frame[column].max()
            frame[column] = box_car(frame[column].to_numpy(), band * reach, hold=True)
    recording = Recording.from_frame(frame, Valve.from_dict(made.valve))
    if not history:
        return recording, None, told
    return recording.slice(BEFORE, rows), recording.slice(0, BEFORE), told


def add_noise(frame, kind, span, rng):
    """Noise of a kind that the reference has none of."""
    rows = len(frame)
    if kind == "wander":
        size = rng.uniform(0.001, 0.004) * span
        frame["F"] += size * correlated(rng, rows, np.exp(-1.0 / rng.uniform(100.0, 600.0)))
    elif kind == "heavy tails":
        frame["F"] += 0.003 * span * rng.standard_t(3, rows)
    elif kind == "noise that grows with the flow":
        frame["F"] *= 1.0 + rng.uniform(0.003, 0.01) * rng.standard_normal(rows)
    else:
        for column in ("P1", "P2"):
            frame[column] += rng.uniform(0.001, 0.004) * frame[column].max() * correlated(rng, rows, 0.9)


def residual_of(recording, before):
    """What the calibrated simulation leaves over beyond the noise of the history; nothing is searched."""
    recording, data, history = prepared(recording, before)
    with threadpool_limits(1, user_api="blas"), with_threads(1):
        problem, nominal = calibrated(prepared_problem(recording, None, None, history=history))
        left = left_since(problem, problem.least_squares(nominal))
    told = asdict(covariates_of_problem(problem, data))
    return told | {"residual": None if left is None else left.effect_size}


def prepared(recording, before):
    """The recording without the rows that its data spoil, what was found of them, and its history."""
    # learnt as `sklvalve learn` does it: from where a diagnosis of the history ended
    history = None if before is None else MissingPhysicsFinder(n_jobs=1).history_of([before])
    data = screened(recording)
    return masked(recording, recording, data)[1], data, history


def searched(recording, before=None):
    """Evidence and verdict of a recording, as the finder judges it; what follows the verdict is left out."""
    finder = MissingPhysicsFinder(n_jobs=1)
    recording, data, history = prepared(recording, before)
    with threadpool_limits(1, user_api="blas"), with_threads(1):
        problem = prepared_problem(recording, None, None, history=history)
        effects, _ = candidates(problem, "all", data)
        judged, _ = suppressed(finder._judged(problem, None, effects, data, 0), data, recording)
    told = dict(judged.evidence.looks)
    told |= {name: getattr(judged.evidence.covariates, name) for name in CIRCUMSTANCES}
    told["strengths"] = {
        look: {key: round(found, 3) for key, found in strengths.items()}
        for look, strengths in judged.evidence.effect_sizes.items()
    }
    return told | {"verdict": judged.verdict, "p_value": judged.p_value}


def table_of(rows, name, *, history):
    """The table of one strength, as `sklvalve.mismatch.decide.null_reference.Table` takes it."""
    weakest = WEAKEST_RESIDUAL[history] if name == "residual" else WEAKEST
    rows = [row for row in rows if row[name] is not None]
    found = np.array([row[name] for row in rows])
    typical, offset, slopes = typical_of(rows, found, weakest)
    relative = found / typical
    quantiles = np.quantile(relative, np.linspace(0.0, 1.0 - ABOVE, KNOTS))
    excess = relative[relative > quantiles[-1]] ** 2 - quantiles[-1] ** 2
    scale, shape = tail_of(excess)
    return {
        "recordings": len(rows),
        "offset": short(offset),
        "slopes": {c: short(s) for c, s in zip(LINE, slopes, strict=True)},
        "ranges": {c: (short(min(k)), short(max(k))) for c, k in ranged(rows).items()},
        "quantiles": tuple(short(q) for q in quantiles),
        "above": ABOVE,
        "scale": short(scale),
        "shape": short(shape),
    }


def ranged(rows):
    """Covariates beyond whose range the edge is taken, with their values in the reference."""
    found = {c: [row[c] for row in rows] for c in EDGED}
    found |= {"noise": [], **{c: [] for c in LINE[-2:]}}
    for row in rows:
        found[covariates_of(row).noise_among].append(row["noise"])
    return found


def short(value):
    """Four digits tell all that some hundred recordings know."""
    return float(f"{value:.4g}")


def covariates_of(row):
    """Covariates of a recording, as a line of the file tells them."""
    return Covariates(*(row[c] for c in CIRCUMSTANCES))


def typical_of(rows, found, weakest):
    """Typical strength of each recording in its covariates, and the line that gives its logarithm."""
    known = np.array([[getattr(covariates_of(row), c) for c in LINE] for row in rows])
    columns = np.column_stack([np.ones(len(rows)), known])
    line, *_ = np.linalg.lstsq(columns, np.log(np.maximum(found, weakest)), rcond=None)
    return np.exp(columns @ line), line[0], line[1:]


def tail_of(excess):
    """Scale and shape of the generalised Pareto law of excesses, of squares.

    A few tens tell little of the shape: it is expected at 0.1, give or take 0.1. It is not let below zero,
    for a law that ends would make the next stronger recording impossible.
    """

    def loss(scale, shape):
        return -np.sum(genpareto.logpdf(excess, shape, scale=scale)) + 0.5 * ((shape - 0.1) / 0.1) ** 2

    found = []
    for shape in np.linspace(0.0, 0.5, 51):
        best = minimize_scalar(
            loss, bounds=(0.1 * excess.mean(), 3.0 * excess.mean()), args=(shape,), method="bounded"
        )
        found.append((best.fun, best.x, shape))
    return min(found)[1:]


def recordings_of(rows, history):
    """What the recordings of a reference were, in a sentence."""
    seeds = [row["seed"] for row in rows]
    told = f"healthy ones of sklvalve.datasets, seeds {min(seeds)} to {max(seeds)}"
    # what is left over is known without a search
    told += ", through the whole search" * ("verdict" in rows[0])
    if any(row.get("kind") for row in rows):
        told += ", half of them with noise of other kinds"
    return f"{told}, each held against the hour before it" if history else told


def interval(many, of):
    """Exact interval of a rate, 95 % (Clopper and Pearson)."""
    low = beta.ppf(0.025, many, of - many + 1) if many else 0.0
    high = beta.ppf(0.975, many + 1, of - many) if many < of else 1.0
    return f"{many} of {of} ({many / of:.1%}, {low:.1%} to {high:.1%})"


def check(rows, law):
    """Lines that say whether the p-values of the law in place are uniform, and what was alarmed."""

    def again(row):
        return mismatch_p_value(Evidence.of(row["strengths"], row["residual"], covariates_of(row), law))

    p_values = np.array([again(row) for row in rows])
    uniform = kstest(p_values, "uniform").pvalue
    yield f"p-values of {len(rows)} recordings, Kolmogorov-Smirnov p = {uniform:.3f}"
    yield "in tenths: " + " ".join(str(n) for n in np.histogram(p_values, np.linspace(0.0, 1.0, 11))[0])
    for alpha in (0.01, 0.05, 0.1):
        yield f"p <= {alpha:g}: {interval(int(np.sum(p_values <= alpha)), len(rows))}"
    alarms = sum(row["verdict"] != "no_mismatch" for row in rows)
    yield f"verdicts other than no_mismatch, at 0.01: {interval(alarms, len(rows))}"
    for row in rows:
        row["historian"] = "keeps values" if row.get("bands") else "every row"
    for key in ("loop", "kind", "lacks", "historian"):
        for value in sorted({str(row.get(key)) for row in rows}):
            some = p_values[[str(row.get(key)) == value for row in rows]]
            below, uniform = np.mean(some <= 0.05), kstest(some, "uniform").pvalue
            told = f"median {np.median(some):.2f}, <= 0.05 {below:.1%}, KS {uniform:.2f}"
            yield f"  {key} {value}: {len(some)}, {told}"


def read(path):
    return (
        [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []
    )


def write_table(rows, options):
    """The tables of the looks that the rows tell of; with `--residual` the others stay as they are."""
    tables = {name: table_of(rows, name, history=options.history) for name in LOOKS if name in rows[0]}
    made_by = f"python benchmarks/healthy_reference.py table {options.rows.name} {options.table}"
    made_by += " --history" * options.history + " --residual" * options.residual
    told = {"made_by": made_by, "recordings": recordings_of(rows, options.history), **tables}
    if options.residual:
        before = json.loads(options.table.read_text(encoding="utf-8"))
        of_residual = {
            "made_by_of_residual": made_by,
            "recordings_of_residual": told["recordings"],
            "residual": told["residual"],
        }
        told = before | of_residual
    options.table.write_text(json.dumps(told, indent=1) + "\n", encoding="utf-8")


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("draw", "table", "check"))
    parser.add_argument("rows", type=Path, help="file of one line of JSON a recording")
    parser.add_argument("table", type=Path, nargs="?", help="JSON file to be written")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--records", type=int, default=260)
    parser.add_argument("--history", action="store_true", help="hold each against the hour before it")
    parser.add_argument("--nastier", action="store_true", help="noise that the reference has none of")
    parser.add_argument("--residual", action="store_true", help="only what is left over since the history")
    options = parser.parse_args(arguments)
    if options.residual and not options.history:
        parser.error("--residual is what is left over since a history: give --history as well")
    rows = read(options.rows)
    if options.what == "check":
        print("\n".join(check(rows, AGAINST_HISTORY if options.history else AGAINST_SHEET)))
    elif options.what == "table":
        write_table(rows, options)
    else:
        done = {row["seed"] for row in rows}
        for seed in range(options.first, options.first + options.records):
            if seed in done:
                continue
            recording, before, told = draw(seed, nastier=options.nastier, history=options.history)
            told |= residual_of(recording, before) if options.residual else searched(recording, before)
            with options.rows.open("a", encoding="utf-8") as file:
                file.write(json.dumps(told) + "\n")
            print(told, flush=True)


if __name__ == "__main__":
    main()
