# SPDX-License-Identifier: BSD-3-Clause
"""How many sticking loops could be found at all: detectors that know what no user knows.

    python -m benchmarks.loop_limit FIRST LAST [OUT.csv]

The loops are those of `benchmarks.loop_alarms`. Each detector is a likelihood ratio of the best stem with a
band of 17 % or more of the command's movement over the best with a smaller one or none:

- `steps` knows the process, the law of the noise and the form of friction, and has the command and the value
  in every step, many to a row. Only the sizes of the band are searched.
- `rows` knows the same, but has the recorded rows only, with straight lines between them.
- `process` is `rows` with the noise unknown, and fitted as `diagnose_loop` fits it.
- `noise` knows the law of the noise; process and form of friction are fitted as `diagnose_loop` fits them.
- `neither` knows neither: the fits of `diagnose_loop`, before its rules.
- `code` is the p-value of `diagnose_loop` with all its rules.

The third and the fourth are asked of loops only whose rows are not averaged. The limit of each is set on the
healthy loops of the same run, so that at most 1, 2 or 5 % of them are called.
"""

import sys

import numba as nb
import numpy as np
import pandas as pd

from benchmarks.loop_alarms import drawn_at, is_either
from benchmarks.loop_law import by_rows, law_of, whitened
from benchmarks.loop_plant import _friction, _sliding
from sklvalve.mismatch.loop.constants import RELEVANT_BAND
from sklvalve.mismatch.loop.fit import Regression, fit_stems
from sklvalve.mismatch.loop.least_squares import nonnegative_weights
from sklvalve.mismatch.loop.operators import candidate_stems, friction_parameters, size_grid
from sklvalve.mismatch.loop.process import forecast_command, responses
from sklvalve.mismatch.loop.signals import loop_signals
from sklvalve.mismatch.loop.stretch import examine_stretch
from sklvalve.recording import InputError

#: Of what a step of one row leaves unknown, what straight lines between rows may add to it.
_BETWEEN = (0.0, 0.3, 3.0)
_DETECTORS = ("steps", "rows", "process", "noise", "neither", "code")
_FALSE = (0.01, 0.02, 0.05)


@nb.njit(cache=True)
def _stems(command, sticks, slips, starts, slides, pace):
    out = np.empty((len(sticks), len(command)))
    for g in range(len(sticks)):
        position, sliding = starts[g], 0.0
        state = (1.0, command[0], command[0], 0.0)
        for k in range(len(command)):
            if sticks[g] <= 0.0:
                position = command[k]
            elif slides:
                position, sliding = _sliding(command[k], position, sliding, sticks[g], slips[g], pace)
            else:
                position, state = _friction(command[k], position, state, sticks[g], slips[g])
            out[g, k] = position
    return out


@nb.njit(cache=True)
def _by_rows(
    command, foreseen, every, sticks, slips, starts, slides, pace,
    factor, bend, lag, integrates, dead, middle, first, follow, begin,
):  # fmt: skip
    """What the sensor would show in each row by the command of the rows, and as the rows before foresee it.

    Between two rows the command goes straight; to the row that is foreseen it goes straight to its forecast.
    """
    n = len(command)
    seen_rows, ahead_rows = np.empty((len(sticks), n)), np.empty((len(sticks), n))
    late, before = np.empty(dead + 1), np.empty(dead + 1)
    for g in range(len(sticks)):
        late[:] = command[0]
        position, sliding = starts[g], 0.0
        state = (1.0, command[0], command[0], 0.0)
        y = seen = begin
        seen_rows[g, 0] = ahead_rows[g, 0] = seen
        for k in range(1, n):
            kept = (position, sliding, state, y, seen)
            before[:] = late
            for ahead in (True, False):
                position, sliding, state, y, seen = kept
                late[:] = before
                last = foreseen[k] if ahead else command[k]
                for i in range(1, every + 1):
                    now = command[k - 1] + (last - command[k - 1]) * i / every
                    if sticks[g] <= 0.0:
                        position = now
                    elif slides:
                        position, sliding = _sliding(now, position, sliding, sticks[g], slips[g], pace)
                    else:
                        position, state = _friction(now, position, state, sticks[g], slips[g])
                    for j in range(dead):
                        late[j] = late[j + 1]
                    late[dead] = position
                    seen += follow * (y - seen)
                    away = late[0] - middle
                    drive = factor[(k - 1) * every + i] * (away + bend * away**2 + 0.5) - 0.5
                    y += (drive if integrates else first + drive - y) / lag
                if ahead:
                    ahead_rows[g, k] = seen
                else:
                    seen_rows[g, k] = seen
    return seen_rows, ahead_rows


@nb.njit(cache=True)
def _answers(stems, factor, bend, lag, integrates, dead, middle, first, follow, begin):
    """What the sensor would show without noise."""
    out = np.empty(stems.shape)
    for g in range(len(stems)):
        y = seen = begin
        for k in range(stems.shape[1]):
            seen += follow * (y - seen)
            away = stems[g, max(k - dead, 0)] - middle
            drive = factor[k] * (away + bend * away**2 + 0.5) - 0.5
            y += (drive if integrates else first + drive - y) / lag
            out[g, k] = seen
    return out


def _likelihood(left, spreads=None):
    """Gaussian, of a scale of its own: the law of jumps is not Gaussian, nor are lines between rows."""
    n = left.shape[-1]
    own = 0.0 if spreads is None else 0.5 * np.log(spreads).sum()
    return -0.5 * n * np.log(np.mean(left**2, axis=-1)) - own


def _ratio(likelihoods, shares):
    relevant = shares >= RELEVANT_BAND
    return float(likelihoods[relevant].max() - likelihoods[~relevant].max())


_PROCESS = ("bend", "lag", "integrates", "dead", "middle", "first", "follow")


def _known(plant):
    process = plant.factor, *(plant.process[name] for name in _PROCESS), plant.value[0]
    return (plant.friction["slides"], plant.friction["pace"]), process


def answers_of(plant, sizes):
    """What the sensor would show in every step without noise, for stems of some sizes."""
    friction, process = _known(plant)
    return _answers(_stems(plant.command, *friction_parameters(plant.command, sizes), *friction), *process)


def limits_of(seed):
    """Evidence of each detector on the loop of a seed; None where it counts as neither or is refused."""
    drawn, sticking, recording, plant = drawn_at(seed, plant=True)
    if is_either(drawn, sticking):
        return None
    try:
        loop = loop_signals(recording)
    except InputError:
        return None
    sizes = np.vstack([np.zeros(3), size_grid(loop.span)])
    shares = sizes[:, 0] / loop.span
    every, rows = plant.steps, drawn.process_value
    law = by_rows(law_of(plant, float(np.std(rows - plant.value[::every]))), every)
    finest = whitened(plant.value - answers_of(plant, sizes), law_of(plant, 0.0))[0]
    friction, process = _known(plant)
    forecast = forecast_command(drawn.command, rows, drawn.setpoint)
    begins = friction_parameters(drawn.command, sizes)
    answers, ahead = _by_rows(drawn.command, forecast, every, *begins, *friction, *process)
    tried = [_likelihood(*whitened(rows - answers, law, extra, rows - ahead)) for extra in _BETWEEN]
    out = {
        "seed": seed, "kind": drawn.kind, "scene": drawn.scene, "sticking": sticking,
        "rows_a_period": drawn.rows_a_period, "share": drawn.share,
        "steps": _ratio(_likelihood(finest), shares), "rows": _ratio(np.max(tried, axis=0), shares),
    }  # fmt: skip
    if loop.decimation == 1:
        relevant = shares >= RELEVANT_BAND
        regression = Regression(ahead[:, None] - rows[0], rows - rows[0], loop.used, 1)
        out["process"] = _best_of(fit_stems(regression, relevant, ~relevant & (shares > 0.0)))
        out["noise"] = _noise_known(loop, law)
    results = [examine_stretch(part) for part in loop.stretches()]
    best = min(results, key=lambda each: (each.p_value, -each.evidence))
    out["p"] = min(1.0, len(results) * best.p_value)
    out["neither"] = max(_best_of(each.comparison) for each in results)
    # of equal p-values the one with more evidence comes first
    out["code"] = -np.log(out["p"]) + 1e-6 * best.evidence
    return out


def _best_of(comparison):
    simpler = max(comparison.command.log_likelihood, comparison.small_band.log_likelihood)
    return float(comparison.sticking.log_likelihood - simpler)


def _noise_known(loop, law):
    forecast = forecast_command(loop.command, loop.value, loop.setpoint)
    tried = candidate_stems(loop, forecast)
    columns = responses(tried.stem, tried.stem_forecast, not loop.is_flow)
    columns = whitened(columns - columns[..., :1], law)[0]
    value = whitened((loop.value - loop.value[0])[None], law)[0][0]
    level = whitened(np.ones((1, len(value))), law)[0][0]
    level /= np.linalg.norm(level)
    value = value - level * (level @ value)
    likelihoods = np.empty(len(columns))
    for place, answers in enumerate(columns):
        answers = answers - np.outer(answers @ level, level)
        sizes = np.linalg.norm(answers, axis=1) + 1e-300
        answers = answers / sizes[:, None]
        gain = nonnegative_weights(answers @ answers.T, answers @ value)[1]
        likelihoods[place] = -0.5 * len(value) * np.log(max(value @ value - gain, 1e-12))
    return _ratio(likelihoods, tried.stick / loop.span)


def main(first, last, out=None):
    """Print how many each detector finds; write every loop to OUT."""
    table = pd.DataFrame([row for row in map(limits_of, range(first, last)) if row])
    if out:
        table.to_csv(out, index=False)
    table["swing"] = pd.cut(table.rows_a_period, [5, 20, 100, 500], include_lowest=True)
    for chosen, name in ((table, "all"), (table.dropna(subset="process"), "rows not averaged")):
        healthy, sticking = chosen[~chosen.sticking], chosen[chosen.sticking]
        print(f"{name}: {len(healthy)} healthy, {len(sticking)} sticking")
        for detector in _DETECTORS:
            if chosen[detector].isna().any():
                continue
            ranked = np.sort(healthy[detector])[::-1]
            limits = [ranked[int(share * len(ranked))] for share in _FALSE]
            found = [int((sticking[detector] > limit).sum()) for limit in limits]
            print(f"  {detector:8s}", *(f"{share:.0%}: {n}" for share, n in zip(_FALSE, found, strict=True)))
            for by in ("kind", "swing"):
                called = (sticking[detector] > limits[1]).groupby(sticking[by], observed=True)
                print("      ", *(f"{k}: {v.sum()} of {len(v)}" for k, v in called))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(int(sys.argv[1]), int(sys.argv[2]), *sys.argv[3:])
