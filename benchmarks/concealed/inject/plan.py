# SPDX-License-Identifier: BSD-3-Clause
"""Which effect goes into which stretch, how large and from when: drawn from one seed."""

import numpy as np

from benchmarks.concealed.inject import damadics, refinery, watersafe
from benchmarks.concealed.inject.effects import ALSO, EFFECTS, possible
from benchmarks.concealed.inject.noise import APART, DETECTABLE, Ruler
from benchmarks.concealed.inject.writing import of_base, of_loop

# what the diagnosis names on the untouched stretches cannot be told from what is put in on top
HELD_BY_WATERSAFE = ("slew_limit", "backlash", "stiction")
COUNTS = {"watersafe": 16, "damadics": 18, "refinery": 12}
STEPS = (1.0, 2.0, 3.0)
ATTEMPTS = 30
GROWING = ("sedimentation", "flow_meter_drift")


def draw(data, seed, counts=None):
    """Records in a drawn order: dicts of `table`, `behind`, `sheet`, `truth`, `rows`.

    Parameters
    ----------
    data : path
        Holds the folders watersafe, damadics and refinery_loops.
    seed : int
    counts : dict, default=None
        Records with an effect by source; `COUNTS` unless given.
    """
    counts = COUNTS if counts is None else counts
    rng = np.random.default_rng(seed)
    out = []
    for source, stretches in (("watersafe", watersafe), ("damadics", damadics)):
        if counts.get(source):
            out += of_stretches(stretches.stretches(data), counts[source], rng)
    if counts.get("refinery"):
        out += of_windows([w for w in refinery.windows(data) if w.usable], counts["refinery"], rng)
    return [out[i] for i in rng.permutation(len(out))]


def _nothing(source, base_name, noise):
    return {
        "generator": f"injected/{source}", "kind": "healthy", "verdict": "no_mismatch", "effects": [],
        "concealed": [], "blocks": [], "onset": None, "abrupt": None, "intervals": [], "strengths": {},
        "parameters": {}, "excitation": "wide" if source == "watersafe" else "closed", "nasty": ["real"],
        "size_step": None, "noise_rms": noise, "distances": None, "distinguishable": None, "class": None,
        "base": base_name,
    }  # fmt: skip


def _told(truth, effect, block, onset, end, step, nothing, others):
    close = [name for name, d in sorted(others.items(), key=lambda item: item[1]) if d < APART]
    alike = ALSO.get(effect, ())
    return truth | {
        "kind": "single", "verdict": "named", "effects": [effect], "blocks": [block], "onset": onset,
        "intervals": [[onset, end]], "size_step": step,
        "distances": {"nothing": nothing, "others": others},
        # names of one and the same equation count as one
        "distinguishable": nothing >= APART and all(name in alike for name in close),
        "class": [effect, *close],
    }  # fmt: skip


def of_stretches(bases, count, rng):
    """Every stretch untouched, and `count` records with an effect."""
    out = []
    rulers = {base.name: Ruler(base) for base in bases}
    noise = {}
    for base in bases:
        rests = dict(zip(("opening", "flow"), base.rests(), strict=True))
        noise[base.name] = {
            key: None if rest is None else rest[: base.rows].std() for key, rest in rests.items()
        }
        if noise[base.name]["opening"] is not None:
            noise[base.name]["opening"] *= 100.0
        table, behind = of_base(base)
        truth = _nothing(base.source, base.name, noise[base.name])
        out.append({"table": table, "behind": behind, "sheet": base.sheet, "truth": truth, "rows": base.rows})
    source = bases[0].source
    open_to = [
        effect for effect in EFFECTS
        if effect.injected and any(possible(effect, base) for base in bases)
        and not (source == "watersafe" and effect.name in HELD_BY_WATERSAFE)
    ]  # fmt: skip
    queue = [open_to[i] for _ in range(count // len(open_to) + 2) for i in rng.permutation(len(open_to))]
    steps = [STEPS[i % 3] for i in range(count)]
    done = 0
    while done < count and queue:
        effect = queue.pop(0)
        case = _sized(effect, steps[done], bases, rulers, rng)
        if case is not None:
            out.append(_with_effect(*case, effect, steps[done], rulers, noise))
            done += 1
    return out


def _sized(effect, step, bases, rulers, rng):
    """A base, a size and a beginning; None where no draw gives a size that is sensible."""
    for _ in range(ATTEMPTS):
        base = bases[rng.integers(len(bases))]
        if not possible(effect, base):
            continue
        late = effect.late or rng.random() < 0.6
        first = int(rng.uniform(0.25, 0.65) * base.rows) if late else 0
        acts = (np.arange(len(base.command)) >= first).astype(float)
        sign = effect.signs[rng.integers(len(effect.signs))]
        least = rulers[base.name].detectable(effect, sign, acts)
        if least is None:
            continue
        if abs(step * least) <= effect.most:
            return base, step * least, first, acts
    return None


def _with_effect(base, size, first, acts, effect, step, rulers, noise):
    change = effect.change(size, base, acts)
    table, behind = of_base(base, change)
    nothing, others = rulers[base.name].distances(effect, size, acts)
    truth = _told(
        _nothing(base.source, base.name, noise[base.name]), effect.name, effect.block, first * base.dt,
        base.rows * base.dt, step, nothing, others,
    )  # fmt: skip
    truth |= {
        "concealed": [effect.key],
        "abrupt": effect.name not in GROWING,
        "strengths": {effect.key: size},
        "parameters": {effect.name: effect.told(size, base)} if effect.told else {},
    }
    return {"table": table, "behind": behind, "sheet": base.sheet, "truth": truth, "rows": base.rows}


def of_windows(loops, count, rng):
    """Every usable window untouched, and `count` with stiction or play in the closed loop."""
    out = []
    for loop in loops:
        table, behind, sheet = of_loop(loop)
        quiet = {"flow": None, "opening": None}
        truth = _nothing("refinery", loop.name, quiet)
        out.append({"table": table, "behind": behind, "sheet": sheet, "truth": truth, "rows": loop.rows})
    drawn: set[tuple] = set()
    done, attempts = 0, 0
    while done < count and attempts < 10 * count:
        attempts += 1
        loop, step = loops[rng.integers(len(loops))], STEPS[done % 3]
        share = (0.0, float(rng.uniform(0.3, 1.0)))[(done // 3) % 2]
        onset = float(loop.dt * int(rng.uniform(0.25, 0.5) * loop.rows)) if rng.random() < 0.4 else 0.0
        case = loop.name, share == 0.0, step, onset
        least = None if case in drawn else loop.detectable(share, onset)
        if least is None:
            continue
        record = _sticking(loop, step * least, share, onset, step)
        # a wide band can hide what a narrow one shows, where the stem hardly moves any more
        if record["truth"]["distances"]["nothing"] >= DETECTABLE:
            drawn.add(case)
            out.append(record)
            done += 1
    return out


def _sticking(loop, band, share, onset, step):
    name, rival = ("stiction", "backlash") if share > 0.0 else ("backlash", "stiction")
    table, behind, sheet = of_loop(loop, band, share * band, onset)
    nothing, other = loop.distances(band, share * band, onset)
    span = float(np.ptp(np.quantile(table["CV"][: loop.rows], [0.01, 0.99])))
    truth = _told(
        _nothing("refinery", loop.name, {"flow": None, "opening": None}), name, "actuator", onset,
        loop.rows * loop.dt, step, nothing, {rival: other},
    )  # fmt: skip
    truth |= {
        "concealed": [name], "abrupt": True,
        "strengths": {"band": 0.01 * band, "jump": 0.01 * share * band, "band_of_movement": band / span},
        "parameters": {"backlash": {"parameter": "width", "value": 0.01 * band, "unit": "1"}}
        if name == "backlash" else {},
    }  # fmt: skip
    return {"table": table, "behind": behind, "sheet": sheet, "truth": truth, "rows": loop.rows}
