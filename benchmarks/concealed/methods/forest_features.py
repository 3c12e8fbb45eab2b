# SPDX-License-Identifier: BSD-3-Clause
"""What a recording's calibrated residuals look like, as numbers that do not depend on its length.

Means of the residual, in units of its own rms, over bins of what may drive it; how it remembers; how it goes
with movements; where a running sum of it turns; how the stem rests and jumps; and where the calibration has
ended, in standard deviations of what was expected. Not a number stands for what a recording cannot show.
"""

from itertools import pairwise

import numpy as np

from benchmarks.concealed.methods.operators import filled, slope_by
from sklvalve.mismatch.describe.cells import direction_of_travel, rate_of_travel

_OPENINGS = (0.0, 0.05, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 1.01)
_RATIOS = (0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 2.0)
_SHARES = (0.0, 0.1, 0.25, 0.45, 0.7, 1.1)
_RATES = (-1.0, -0.004, -0.0008, 0.0008, 0.004, 1.0)
_TIMES = tuple(np.linspace(0.0, 1.0 + 1e-9, 9))
_LAGS = (1, 5, 20, 60, 200)
_MOVES = (0, 1, 2, 4, 8, 16, 40)
_FEWEST = 15
#: Parameters of the calibration whose place is a feature.
CALIBRATION = (
    *("capacity", "meter_lag", "flow_zero", "stem_zero", "dp_zero", "fl_scale", "fl_slope", "knee"),
    *(f"trim_{i}" for i in range(7)),
    *("actuator_filter", "actuator_gain", "actuator_reset", "actuator_rate", "actuator_coulomb"),
    *("actuator_feedback", "actuator_vent", "actuator_loop", "actuator_delay", "position_zero"),
)


def features(nominal):
    """Features of a calibrated recording.

    Parameters
    ----------
    nominal : Nominal

    Returns
    -------
    found : dict
        Name -> number; the names are the same for every recording.
    """
    problem, chain = nominal.problem, nominal.model.chain
    left, found = nominal.residuals, {}
    n = len(chain.time)
    nothing = np.full(n, np.nan)
    free = nominal.model.predictions.get("opening", nothing)
    seen = next((s for s in (chain.measured, free, chain.command) if s is not None), nothing)
    flow = nominal.model.predictions.get("flow", nothing) / problem.spans.get("flow", 1.0)
    common = {
        "dp": _scaled(chain.dp) if chain.has_pressures else nothing,
        "warm": _ranked(chain.temperature) if "temperature" in problem.recording else nothing,
        "time": np.arange(n) / n,
    }
    ratio = nothing if chain.pressure_ratio is None else np.abs(chain.pressure_ratio)
    signals = common | {"opening": seen, "ratio": ratio, "flow": flow}
    found |= _of_channel("flow", left.get("flow", nothing), signals, seen, chain)
    found |= _of_channel("opening", left.get("opening", nothing), common | {"opening": free}, free, chain)
    found |= _shapes(left.get("flow", nothing), flow, seen, chain)
    found |= _of_stem(chain, left.get("opening", nothing))
    expected = {p.name: p for c in problem.channels for p in problem.calibration((c,))}
    for name in CALIBRATION:
        found[f"place of {name}"] = _place(expected.get(name), nominal.model.values.get(name))
    return found


def _of_channel(name, left, signals, moving, chain):
    """Size, memory, conditional means, movement and turning point of one residual."""
    told, size = {}, float(np.sqrt(np.nanmean(left**2))) if np.isfinite(left).any() else np.nan
    told["log rms"] = np.log(max(size, 1e-6)) if np.isfinite(size) else np.nan
    scaled = np.clip(left / size, -8.0, 8.0) if np.isfinite(size) and size > 0.0 else left
    bridged = filled(scaled)
    centred = bridged - bridged.mean()
    power = max(float(centred @ centred), 1e-12)
    for lag in _LAGS:
        told[f"memory {lag}"] = (
            float(centred[lag:] @ centred[:-lag]) / power if len(centred) > lag else np.nan
        )
    told["third"], told["fourth"] = _mean(scaled**3), _mean(scaled**4)
    known = np.isfinite(moving).any()
    rate = rate_of_travel(moving, chain.time) if known else np.full(len(left), np.nan)
    way = direction_of_travel(moving) if known else rate
    edges = {"opening": _OPENINGS, "ratio": _RATIOS, "dp": _SHARES, "flow": _SHARES, "time": _TIMES}
    edges["warm"] = (0.0, 1 / 3, 2 / 3, 1.01)
    for by, signal in (signals | {"rate": rate}).items():
        bounds = edges.get(by, _RATES)
        told |= {f"{by} {i}": m for i, m in enumerate(_means(scaled, signal, bounds))}
    for i, (low, high) in enumerate(((0.0, 1.01), (0.0, 0.3), (0.3, 0.6), (0.6, 1.01))):
        here = (signals["opening"] >= low) & (signals["opening"] < high)
        told[f"way {i}"] = _mean(scaled[here & (way > 0.0)]) - _mean(scaled[here & (way < 0.0)])
    command = chain.command if chain.command is not None else moving
    moves = np.gradient(filled(command))
    for lag in _MOVES:
        told[f"after moves {lag}"] = _correlation(bridged[lag:], moves[: len(moves) - lag])
    told["turn at"] = int(np.argmax(np.abs(np.cumsum(centred)))) / len(centred)
    halves = [np.nanstd(h) if np.isfinite(h).any() else np.nan for h in np.array_split(scaled, 2)]
    told["louder"] = halves[1] - halves[0]
    return {
        f"{name} {key}": float(value) if np.isfinite(left).any() else np.nan for key, value in told.items()
    }


def _shapes(left, flow, opening, chain):
    """Correlations of the flow's residual with plain shapes."""
    names = ("root", "flow", "opening", "warm", "time", "grows", "quick", "bent", "play", "cubed", "low")
    if not np.isfinite(left).any():
        return {f"flow as {name}": np.nan for name in names}
    q, x, dp = filled(flow), filled(opening), np.abs(filled(chain.dp))
    time = np.arange(len(q)) / len(q)
    gain = slope_by(x, q)
    root = np.sqrt(dp)
    columns = (
        *(root, q, x, chain.temperature, time, q * time, np.gradient(q)),
        *(x * (1.0 - x) * q, gain * np.nan_to_num(direction_of_travel(x))),
        *(q**3 / np.maximum(dp, 1.0), root * np.exp(-x / 0.1)),
    )
    return {
        f"flow as {n}": _correlation(filled(left), filled(c)) for n, c in zip(names, columns, strict=True)
    }


def _of_stem(chain, left):
    """How the recorded stem rests and jumps."""
    names = ("rests", "jumps", "highest", "lowest", "still", "moving", "spread of jumps")
    x, command = chain.measured, chain.command
    if x is None or command is None:
        return {f"stem {name}": np.nan for name in names}
    x, command = filled(x), filled(command)
    ahead = 10
    asked, made = np.abs(command[ahead:] - command[:-ahead]), np.abs(x[ahead:] - x[:-ahead])
    moves, quick = asked > 0.01, np.abs(np.diff(x))
    rests = float(np.mean(made[moves] < 0.003)) if moves.sum() > _FEWEST else np.nan
    jumps = float(np.mean(quick**4) / max(np.mean(quick**2) ** 2, 1e-20))
    sizes = np.log(max(float(np.quantile(quick, 0.999)), 1e-5))
    parts = [
        np.sqrt(np.nanmean(filled(left)[ahead:][m] ** 2)) if m.any() else np.nan for m in (~moves, moves)
    ]
    told = (rests, np.log(jumps + 1e-9), x.max() - command.max(), x.min() - command.min())
    told = (*told, *(np.log(p + 1e-6) for p in parts), sizes)
    return {f"stem {n}": float(v) for n, v in zip(names, told, strict=True)}


def _place(parameter, value):
    if parameter is None or value is None or parameter.spread is None:
        return np.nan
    start = parameter.start
    away = np.log(max(value, 1e-12) / start) if parameter.log else value - start
    return float(away / parameter.spread)


def _means(left, signal, edges):
    return [_mean(left[(signal >= low) & (signal < high)]) for low, high in pairwise(edges)]


def _mean(values):
    values = values[np.isfinite(values)]
    return float(np.mean(values)) if len(values) >= _FEWEST else np.nan


def _correlation(a, b):
    a, b = a - a.mean(), b - b.mean()
    size = np.sqrt(float(a @ a) * float(b @ b))
    return float(a @ b) / size if size > 1e-12 else 0.0


def _scaled(values):
    values = np.abs(values)
    return values / max(float(np.nanquantile(values, 0.99)), 1e-12)


def _ranked(values):
    order = np.argsort(np.argsort(filled(values)))
    return order / len(order)
