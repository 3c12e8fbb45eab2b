# SPDX-License-Identifier: BSD-3-Clause
"""Days of a simulated valve in which something may develop, and a whole plant of such valves as files."""

import datetime as dt
import json
from pathlib import Path

import numpy as np
from sklearn.utils import Bunch

from sklvalve.datasets.concealed import to_toml
from sklvalve.datasets.plant import make_valve_recording

#: What develops in the valves of `write_plant`, in turn; the others stay as they are.
DEVELOPING = ("seat_leakage", "backlash", "clogging", "flow_meter_gain", "stiction")
# growth is made of so many sizes, each a run of its own
_LEVELS = 4


def make_valve_days(
    effect=None, strength=None, *, days=60, rows=900, onset=30, grown=15, loop=None, random_state=0
):
    """Record a valve for some time each day; an effect may begin, and grow until it is whole.

    Parameters
    ----------
    effect, strength, loop
        As `make_valve_recording` takes them; `strength` is the size in the end.
    days : int, default=60
    rows : int, default=900
        Rows of a day, one a second.
    onset : int, default=30
        Number of the first day with the effect.
    grown : int, default=15
        Days after which it is whole; it grows in four steps.
    random_state : int, default=0

    Returns
    -------
    recorded : :class:`~sklearn.utils.Bunch`
        `days` : list of DataFrame, columns as of `make_valve_recording`; `valve` : dict; `truth` : dict, that
        of the whole effect, and the share of it on each day as ``"shares"``.
    """
    settings = {"n_samples": days * rows, "n_later": 0, "loop": loop, "random_state": random_state}
    number = np.arange(days)
    shares = np.zeros(days)
    if effect is not None:
        step = np.floor(_LEVELS * (number - onset) / max(grown, 1)) + 1.0
        shares = np.where(number < onset, 0.0, np.minimum(step, _LEVELS) / _LEVELS)
    whole = make_valve_recording(effect, strength, **settings)
    size = None if effect is None else whole.truth["strengths"][effect]
    runs = {1.0 if effect is not None else 0.0: whole}
    for share in np.unique(shares):
        if share not in runs:
            runs[share] = make_valve_recording(effect, share * size, **settings)
    frames = [
        runs[share].frame.iloc[k * rows : (k + 1) * rows].reset_index(drop=True)
        for k, share in enumerate(shares)
    ]
    truth = whole.truth | {"shares": shares.tolist(), "first_day": onset if effect is not None else None}
    return Bunch(days=frames, valve=whole.valve, truth=truth)


def write_plant(folder, *, valves=20, days=60, rows=900, first=dt.date(2026, 1, 1), random_state=0):
    """Write a plant of simulated valves for `sklvalve watch`: rows, data sheets, plant.toml, and the truth.

    In up to five of the valves, drawn by `random_state`, something develops.

    Parameters
    ----------
    folder : path-like
    valves, days, rows : int
    first : date
        First day.
    random_state : int, default=0

    Returns
    -------
    truth : dict
        Tag -> effect, first day and size; None for a valve that stays as it is.
    """
    place = Path(folder)
    rng = np.random.default_rng(random_state)
    concealed = dict(zip(rng.permutation(valves)[: len(DEVELOPING)].tolist(), DEVELOPING, strict=False))
    sections, truth = [], {}
    for k in range(valves):
        tag, effect = f"FV-{101 + k}", concealed.get(k)
        onset = int(rng.integers(days // 3, 2 * days // 3))
        made = make_valve_days(
            effect, days=days, rows=rows, onset=onset, random_state=int(rng.integers(2**31 - 1))
        )
        _write_valve(place, tag, made, first)
        sections.append(f'[valve.{tag}]\nsheet = "sheets/{tag}.toml"\n')
        truth[tag] = effect and {
            "effect": effect,
            "first_day": (first + dt.timedelta(days=onset)).isoformat(),
            "size": made.truth["strengths"][effect],
        }
    (place / "plant.toml").write_text('name = "Simulated plant"\n\n' + "\n".join(sections), encoding="utf-8")
    (place / "truth.json").write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")
    return truth


def _write_valve(place, tag, made, first):
    for folder in (place / "rows" / tag, place / "sheets"):
        folder.mkdir(parents=True, exist_ok=True)
    (place / "sheets" / f"{tag}.toml").write_text(to_toml(made.valve), encoding="utf-8")
    for number, frame in enumerate(made.days):
        day = first + dt.timedelta(days=number)
        begins = np.datetime64(f"{day}T06:00:00")
        stamps = begins + np.arange(len(frame)).astype("timedelta64[s]")
        frame.assign(time=np.datetime_as_string(stamps)).to_parquet(place / "rows" / tag / f"{day}.parquet")
