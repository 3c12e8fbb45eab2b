# SPDX-License-Identifier: BSD-3-Clause
"""Any detector on the scenarios: what it is given, and the line that is kept of each."""

import time
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pandas as pd

from sklvalve.damadics import make_damadics, scenario_indices, scenario_of

#: Columns that a detector sees: time [s], the six signals, and the flow with gaps where its meter ends. One
#: whose ``needs_nominal`` is true also gets the stem of the generator's own sound run, X_nominal.
SIGNALS = ("time", "CV", "P1", "P2", "T1", "X", "F", "F_in_range")
#: Sigma of a transducer's noise, share of its span [1], and what is invisible beside it [1].
NOISE, INVISIBLE = 1.414e-3, 2e-3
#: What the line of sound hours has in place of a scenario.
SOUND = "sound hours"
HOUR, _SETTLED = 3600.0, 905


def run_for(detector, name, seed, duration=None):
    """Frame of a scenario, or without a fault where its name is None, as a detector sees it."""
    nominal = getattr(detector, "needs_nominal", False)
    frame = make_damadics(name, duration=duration, nominal=nominal, random_state=seed)
    return frame[[*SIGNALS, "X_nominal"] if nominal else list(SIGNALS)]


def fitted(detector, seed):
    """A detector, fitted to a sound hour: what its ``fit`` returns, or itself where that is nothing."""
    made = detector.fit(run_for(detector, None, seed, HOUR))
    return detector if made is None else made


def decisions_of(detector, frame):
    """Decisions of a fitted detector on a frame of n rows.

    Returns
    -------
    detection : ndarray of shape (n,)
    isolation : ndarray of shape (n, m) or None
        None where the detector tells no faults apart.
    diagnoses : list of m lists of str
        Faults of each column.

    Raises
    ------
    ValueError
        If what ``predict`` returns is neither a frame with a column ``detection`` and a column for each
        diagnosis nor an array of n decisions.
    """
    made = detector.predict(frame)
    if not hasattr(made, "columns"):
        made = pd.DataFrame({"detection": _alone(made, len(frame))})
    if "detection" not in made.columns:
        raise ValueError(
            "predict must return a frame with a column 'detection', got the columns "
            f"{', '.join(map(str, made.columns)) or 'of none'}."
        )
    isolation = made.drop(columns="detection")
    diagnoses = [str(column).split("+") for column in isolation]
    return made["detection"].to_numpy(), isolation.to_numpy() if diagnoses else None, diagnoses


def _alone(decisions, rows):
    decisions = np.asarray(decisions)
    if decisions.shape != (rows,):
        raise ValueError(
            "predict must return a frame with a column 'detection' and one for each diagnosis, or one "
            f"decision for each of {rows} rows, got the shape {decisions.shape}."
        )
    return decisions


def score(detector, name, seed):
    """Line of a fitted detector on a scenario.

    Parameters
    ----------
    detector : object with ``predict``
    name : str
        Of one of the forty-four.
    seed : int
        Of the noise.

    Returns
    -------
    line : dict
        ``scenario``, ``fault``, ``seed``, the eighteen ``indices``, ``pointed`` (each set of faults that was
        pointed at after the fault began -> seconds for which it was, the last of them last), ``told`` (of
        ours), ``seconds`` of the processor.

    Raises
    ------
    ValueError
        If the decisions are not what they should be.
    """
    frame = run_for(detector, name, seed)
    began = time.process_time()
    detection, isolation, diagnoses = decisions_of(detector, frame)
    seconds = time.process_time() - began
    t, known = frame["time"].to_numpy(), scenario_of(name)
    found = scenario_indices(known, t, detection, isolation, diagnoses=diagnoses or None)
    pointed = {}
    if isolation is not None:
        pointed = _pointed(isolation > 0.5, diagnoses, t >= known.profile.begins)
    return {
        "scenario": name,
        "fault": known.fault,
        "seed": seed,
        "indices": found.to_dict(),
        "pointed": pointed,
        "told": getattr(detector, "told_", []),
        "seconds": seconds,
    }


def false_alarms(detector, seed):
    """Share of a sound hour, past 300 s, in which a fitted detector alarms [1]."""
    frame = run_for(detector, None, seed, HOUR)
    high = decisions_of(detector, frame)[0] > 0.5
    return float(high[frame["time"].to_numpy() >= 300.0].mean())


@lru_cache(maxsize=64)
def visibility(name):
    """What a scenario's fault changes where it has its full strength: rms from 5 s to 600 s, without noise.

    Returns
    -------
    changes : dict
        ``X``, ``F``, ``P1``, ``P2``, ``T1``, shares of their spans [1].
    """
    spans = {"X": 100.0, "F": 40.0, "P1": 4000.0, "P2": 4000.0, "T1": 200.0}
    faulty = make_damadics(replace(scenario_of(name).profile, takes=0.0), noise=False)
    sound = make_damadics(None, duration=len(faulty), noise=False)
    return {
        signal: float(np.sqrt(np.mean((faulty[signal] - sound[signal])[_SETTLED:] ** 2)) / span)
        for signal, span in spans.items()
    }


def _pointed(high, diagnoses, late):
    """Each set of faults that was pointed at after the fault began, with the seconds for which it was."""
    stood = {}
    for row in high[late]:
        faults = {fault for group, up in zip(diagnoses, row, strict=True) if up for fault in group}
        key = " ".join(sorted(faults, key=_number))
        if key:
            stood[key] = stood.pop(key, 0) + 1
    return stood


def _number(fault):
    return int(fault[1:])
