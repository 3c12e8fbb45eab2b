# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of a simulated valve loop in which an effect may be concealed."""

import numpy as np
from sklearn.utils import Bunch, check_random_state

from sklvalve.datasets._plant_draw import LOOPS
from sklvalve.datasets._plant_effects import CONCEALABLE, EFFECTS
from sklvalve.datasets._plant_rig import FLOW, PLUG, READING, Plant

COUNTS = 0.5  # percent of span or travel, rms where the effect acts


def make_valve_recording(
    effect=None,
    strength=None,
    *,
    onset=0.0,
    n_samples=5760,
    n_later=1440,
    loop=None,
    noise=1.0,
    concealed=True,
    sheet_physics=("choked_flow",),
    random_state=None,
    return_truth=True,
):
    """Record a simulated control-valve loop in which an effect is concealed.

    A globe valve with a pneumatic positioner passes water between a pump and a tank. The plant is finer
    than the simulations that diagnose it, and shares no code with them: two pneumatic volumes with choked
    ISO 6358 nozzles, a stem under generalised Maxwell-slip friction with a Stribeck curve,

    .. math:: m \\dot v = A p - F_0 - k x - b v - F_f + A_p (p_1 - p_2),

    play between stem and plug, a trim that departs from the sheet within its tolerance, a recovery factor
    that falls with travel, a soft choking knee

    .. math:: Q = C(x) \\sqrt{\\Delta p_e / \\rho}, \\quad
        \\Delta p_e = \\Delta p \\, (1 + (\\Delta p / \\Delta p_c)^n)^{-1/n},

    the inertia of the water column, and meters with filters, zero offsets, wandering noise and
    quantisation. Sheet, hardware, commands, disturbances and noise are drawn from `random_state`; an effect
    does not change the other draws, so that the same seed with `strength=0` is the same plant without it.

    Parameters
    ----------
    effect : str, list of str or None, default=None
        What to conceal, of `sklvalve.datasets.CONCEALABLE`. None: a healthy valve within its tolerances.
    strength : float, list of float or None, default=None
        Size of each effect in the unit that `truth["strengths"]` gives; zero is healthy. Shares of travel
        [1] for plays, dead zone (half width), stem offsets and the blocked part of the travel (clogging);
        [N] of breakaway for stiction and friction; [s] for lags, dead time and the time of a full stroke
        (slew_limit); share of the supply (gauge) that is lost; share of F_L that is lost (choked_flow);
        share of rated kv for leak, bypass, erosion; sum of loss coefficients on the nominal size
        (piping_reducers); share of the flow span (1.5 kv_rated m3/h) for meter bias and drift; share of
        capacity or reading otherwise. None: drawn to move flow or opening by 1.5 to 5 % of the span, rms
        over the rows where it acts, as far as the effect can.
    onset : float or None, default=0.0
        When the effects begin [s]. None: drawn, in half of the cases from the start, else within the middle
        of the recording.
    n_samples, n_later : int, default=5760 and 1440
        Rows, one a second, of the recording and of what follows it.
    loop : {"wide", "closed", "mixed"} or None, default=None
        Command over most of the travel, a flow controller with set-point steps, or the one half after the
        other. None: drawn.
    noise : float, default=1.0
        Factor on the sensors' noise and the turbulence; 1 is about 0.3 % of flow span and 0.13 % of travel.
    concealed : bool, default=True
        False adds to `frame` and `later` what no plant records: `true_opening` (of the plug) [%] and
        `flow_without_noise` [m3/h].
    sheet_physics : sequence of str, default=("choked_flow",)
        What `valve["simulation"]["physics"]` says the simulation holds already. Where it leaves choking out
        and the flow chokes, the truth names choked_flow.
    random_state : int, RandomState instance or None, default=None
        Source of all draws.
    return_truth : bool, default=True
        Whether the result has `truth` and `flow_without_noise`.

    Returns
    -------
    recording : :class:`~sklearn.utils.Bunch`
        `frame` and `later` : DataFrame with time [s], CV, X [%], P1, P2 [kPa, absolute], T1 [degC], F
        [m3/h], and SP [m3/h] where the loop is closed; `valve` : dict, as in a valve.toml; `truth` : dict;
        `flow_without_noise` : DataFrame over both. `truth["flow_rms_change"]` and
        `truth["opening_rms_change"]` compare, from the onset on, with the same plant under the same command
        without the effects [% of the largest flow, % of travel]; `truth["rms_where_acting"]` is the
        same over the rows where the change exceeds a fifth of its 99th percentile, and `truth["counts"]`
        says whether it reaches half a percent.

    Raises
    ------
    ValueError
        If an effect or loop is unknown, or a number lies outside its range.
    ImportError
        If pandas is missing.

    Notes
    -----
    Water at 0 to 100 degC, turbulent flow. Nozzles: ISO 6358-1:2013. Friction: Al-Bender, Lampaert,
    Swevers, IEEE Trans. Automatic Control 50 (2005) 1883. Sizing relations: IEC 60534-2-1. Density: Kell
    1975. Vapour pressure: Goff and Gratch 1946.

    Examples
    --------
    >>> from sklvalve.datasets import make_valve_recording
    >>> recording = make_valve_recording("seat_leakage", 0.05, n_samples=600, n_later=60, random_state=0)
    >>> list(recording.frame.columns)[:4]
    ['time', 'CV', 'X', 'P1']
    >>> recording.truth["effects"]
    ['seat_leakage']
    """
    pd = _pandas()
    names, sizes = _check(effect, strength, onset, n_samples, n_later, loop, noise)
    plant, onset, effect_seed, rng = draw_plant(names, onset, n_samples, n_later, loop, noise, random_state)
    strengths = _draw_sizes(rng, plant, names, sizes, onset)
    target = rng.uniform(1.8, 4.5)
    out, strengths, change = _settle_sizes(plant, strengths, sizes, onset, effect_seed, target)

    table = pd.DataFrame(plant.record(out))
    if not concealed:
        table["true_opening"] = 100.0 * out[:, PLUG]
        table["flow_without_noise"] = out[:, FLOW]
    result = Bunch(
        frame=table.iloc[:n_samples].reset_index(drop=True),
        later=table.iloc[n_samples:].reset_index(drop=True),
        valve=plant.valve_table(sheet_physics),
    )
    if return_truth:
        result.truth = _truth(plant, out, strengths, onset, effect_seed, sheet_physics, noise, change)
        result.flow_without_noise = pd.DataFrame({"time": table["time"], "flow": np.round(out[:, FLOW], 3)})
    return result


def draw_plant(names, onset, n_samples, n_later, loop, noise, random_state):
    """Plant, onset, seed of what the effects draw themselves, and the source of what is drawn after."""
    seeds = np.random.SeedSequence(check_random_state(random_state).randint(2**31 - 1)).spawn(3)
    plant = Plant(np.random.default_rng(seeds[0]), names, loop, noise, n_samples + n_later)
    rng = np.random.default_rng(seeds[1])
    if onset is None:
        onset = 0.0 if rng.uniform() < 0.5 else float(round(rng.uniform(0.3, 0.65) * n_samples))
    return plant, onset, int(seeds[2].generate_state(1)[0]), rng


def _check(effect, strength, onset, n_samples, n_later, loop, noise):
    names = [] if effect is None else [effect] if isinstance(effect, str) else list(effect)
    for name in names:
        if name not in EFFECTS:
            raise ValueError(f"effect must be one of {', '.join(CONCEALABLE)}; got {name!r}.")
    if len(set(names)) < len(names):
        raise ValueError(f"effect must name each effect once; got {names}.")
    sizes = (
        [None] * len(names) if strength is None else list(np.atleast_1d(np.asarray(strength, dtype=float)))
    )
    if len(sizes) != len(names):
        raise ValueError(
            f"strength must give one number per effect; got {len(sizes)} for {len(names)} effects."
        )
    for name, size in zip(names, sizes, strict=True):
        if size is not None and (not np.isfinite(size) or (size < 0.0 and not EFFECTS[name].signed)):
            raise ValueError(f"strength of {name} must be a finite number, zero or above; got {size}.")
    if loop is not None and loop not in LOOPS:
        raise ValueError(f"loop must be one of {', '.join(LOOPS)}, or None to draw it; got {loop!r}.")
    if n_samples < 1 or n_later < 0:
        raise ValueError(f"n_samples must be 1 or more and n_later 0 or more; got {n_samples} and {n_later}.")
    if onset is not None and not 0.0 <= onset < n_samples:
        raise ValueError(f"onset must lie within the recording, 0 to {n_samples} s; got {onset}.")
    if not noise >= 0.0:
        raise ValueError(f"noise must be zero or above; got {noise}.")
    return names, sizes


def _draw_sizes(rng, plant, names, sizes, onset):
    drawn = {}
    for name, size in zip(names, sizes, strict=True):
        effect = EFFECTS[name]
        own = rng.uniform(effect.low, effect.high) * (rng.choice([-1.0, 1.0]) if effect.signed else 1.0)
        if size is None and effect.limit:
            healthy, _ = plant.run({}, 0.0, 0)
            limit = float(np.quantile(healthy[int(onset) :, READING], own))
            # the supply must fall to the bench pressure of that opening
            own = 1.0 - (20.0 + 80.0 * limit) / 340.0 if name == "supply_pressure_drop" else 1.0 - limit
        drawn[name] = float(own if size is None else size)
    return drawn


def _change(out, healthy, onset):
    """Change of flow [% of the largest] and opening [%]: rms from the onset on, and where it acts."""
    begin = int(np.ceil(onset))
    span = max(healthy[:, FLOW].max(), 1e-9)
    flow = 100.0 * (out[begin:, FLOW] - healthy[begin:, FLOW]) / span
    opening = 100.0 * (out[begin:, READING] - healthy[begin:, READING])
    where = {}
    for name, delta in (("flow", flow), ("opening", opening)):
        size = np.abs(delta)
        acting = size > 0.2 * np.quantile(size, 0.99)
        where[name] = float(np.sqrt(np.mean(size[acting] ** 2))) if acting.any() else 0.0
    return {
        "flow": float(np.sqrt(np.mean(flow**2))),
        "opening": float(np.sqrt(np.mean(opening**2))),
        "where": where,
    }


def _settle_sizes(plant, strengths, given, onset, seed, target):
    """Run; where one size was left open and the effect allows it, scale it until it matters enough."""
    names = list(strengths)
    free = len(names) == 1 and given[0] is None and EFFECTS[names[0]].sized
    for attempt in range(5):
        out, command = plant.run(strengths, onset, seed)
        healthy, _ = plant.run({}, onset, seed, replay=command)
        change = _change(out, healthy, onset)
        if not free or attempt == 4:
            break
        effect, size = EFFECTS[names[0]], strengths[names[0]]
        goal = target * (0.6 if effect.moves == "opening" else 1.0)
        reached = change["where"][effect.moves]
        low = effect.low if onset <= 0.0 else 0.25 * effect.low
        scaled = abs(size) * np.clip(goal / max(reached, 1e-6), 0.4, 2.5)
        new = float(np.copysign(np.clip(scaled, low, 1.5 * effect.high), size))
        if 0.85 * goal <= reached <= 1.18 * goal or new == size:
            break
        strengths = {names[0]: new}
    return out, strengths, change


def _chokes(plant, out, strengths, onset, seed):
    """Whether choking moves the flow by half a percent of span, rms where it acts."""
    free, _ = plant.run(
        strengths | {"no_choking": 1.0}, onset, seed, replay=plant.run(strengths, onset, seed)[1]
    )
    return _change(out, free, 0.0)["where"]["flow"] >= 0.5


def _truth(plant, out, strengths, onset, seed, sheet_physics, noise, change):
    acting = {name: size for name, size in strengths.items() if size != 0.0}
    told = {EFFECTS[name].told: EFFECTS[name].block for name in acting if EFFECTS[name].told}
    if "choked_flow" not in sheet_physics and _chokes(plant, out, strengths, onset, seed):
        told.setdefault("choked_flow", "valve")
    strange = any(EFFECTS[name].told is None for name in acting)
    return {
        "name": "_and_".join(acting) or "nothing",
        "verdict": "named" if told else "none_of_these" if strange else "no_mismatch",
        "effects": list(told),
        "blocks": sorted(set(told.values())),
        "region": None,
        "onset": float(onset) if acting else 0.0,
        "strengths": acting,
        "units": {name: EFFECTS[name].unit for name in acting},
        "concealed": list(acting),
        "physics": list(sheet_physics),
        "loop": plant.loop,
        "noise": float(noise),
        "counts": max(change["where"].values()) >= COUNTS,
        "flow_rms_change": round(change["flow"], 4),
        "opening_rms_change": round(change["opening"], 4),
        "rms_where_acting": {name: round(value, 4) for name, value in change["where"].items()},
    }


def _pandas():
    try:
        import pandas
    except ImportError:
        raise ImportError(
            'Recordings are made as data frames; install pandas with: pip install "sklvalve[io]"'
        ) from None
    return pandas
