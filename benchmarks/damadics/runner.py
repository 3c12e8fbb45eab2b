# SPDX-License-Identifier: BSD-3-Clause
"""Any detector on the scenarios: what it is given, and the line that is kept of each."""

import time
from functools import lru_cache

import numpy as np

from sklvalve.damadics import make_damadics, scenario_indices, scenario_of

#: Columns that a detector sees: time [s], the six signals, the flow with gaps where its meter ends, and the
#: stem of the generator's own sound run, which only a detector that is told so may use.
SIGNALS = ("time", "CV", "P1", "P2", "T1", "X", "F", "F_in_range", "X_nominal")
#: Sigma of a transducer's noise, share of its span [1], and what is invisible beside it [1].
NOISE, INVISIBLE = 1.414e-3, 2e-3
_SOUND_RUN, _SETTLED = 3600.0, 905


def sound_run(seed, duration=_SOUND_RUN):
    """Frame without a fault, as a detector sees it."""
    return _seen(make_damadics(None, duration=duration, nominal=True, random_state=seed))


def scenario_run(name, seed):
    """Frame of a scenario as a detector sees it."""
    return _seen(make_damadics(name, nominal=True, random_state=seed))


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
        ``scenario``, ``fault``, the eighteen ``indices``, ``pointed`` (the faults pointed at when last
        something was), ``named`` (the smallest diagnosis pointed at after the fault began), ``visible`` (what
        the fault does, see `visibility`), ``told`` (of ours) and ``seconds``.
    """
    frame = scenario_run(name, seed)
    began = time.process_time()
    decisions = detector.predict(frame)
    seconds = time.process_time() - began
    detection = decisions["detection"].to_numpy()
    isolation = decisions.drop(columns="detection")
    diagnoses = [column.split("+") for column in isolation]
    t = frame["time"].to_numpy()
    found = scenario_indices(name, t, detection, isolation.to_numpy(), diagnoses=diagnoses)
    return {
        "scenario": name,
        "fault": scenario_of(name).fault,
        "seed": seed,
        "indices": found.to_dict(),
        "pointed": _pointed(isolation.to_numpy() > 0.5, diagnoses, t >= scenario_of(name).profile.begins),
        "told": getattr(detector, "told_", []),
        "seconds": seconds,
    }


def false_alarms(detector, seed, duration=_SOUND_RUN):
    """Share of a sound hour, past 300 s, in which a fitted detector alarms [1]."""
    frame = sound_run(seed, duration)
    high = detector.predict(frame)["detection"].to_numpy() > 0.5
    return float(high[frame["time"].to_numpy() >= 300.0].mean())


@lru_cache(maxsize=64)
def visibility(name):
    """What a scenario's fault changes: rms of each signal without noise, past 905 s, share of its span.

    Returns
    -------
    changes : dict
        ``X``, ``F``, ``P1``, ``P2``, ``T1`` [1].
    """
    spans = {"X": 100.0, "F": 40.0, "P1": 4000.0, "P2": 4000.0, "T1": 200.0}
    faulty = make_damadics(name, noise=False)
    sound = make_damadics(None, duration=len(faulty), noise=False)
    return {
        signal: float(np.sqrt(np.mean((faulty[signal] - sound[signal])[_SETTLED:] ** 2)) / span)
        for signal, span in spans.items()
    }


def _seen(frame):
    return frame[list(SIGNALS)]


def _pointed(high, diagnoses, late):
    """Faults of each set of diagnoses that was pointed at after the fault began, with the seconds it stood."""
    stood = {}
    for row in high[late]:
        faults = sorted({f for group, up in zip(diagnoses, row, strict=True) if up for f in group}, key=_number)
        key = " ".join(faults)
        stood[key] = stood.get(key, 0) + 1
    return {key: seconds for key, seconds in stood.items() if key}


def _number(fault):
    return int(fault[1:])
