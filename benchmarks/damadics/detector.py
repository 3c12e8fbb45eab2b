# SPDX-License-Identifier: BSD-3-Clause
"""Our detector: it watches every second, asks the finder for a name while an alarm stands, and tells faults.

A detector of this benchmark has ``fit(X)``, with a frame of a sound run, and ``predict(X)``, which returns a
frame of as many rows: ``detection``, and a column for each diagnosis, named by its faults (``f6`` or
``f6+f18``), all in [0, 1]. X has the columns `runner.SIGNALS`, one row a second. A decision may use what was
recorded until then and no more; ours does not. ``told_`` keeps what was behind the decisions.
"""

import numpy as np

from benchmarks.damadics.naming import LESS_FLOW, MORE_FLOW, OF_THE_ACTUATOR, OF_THE_MEDIUM, faults_of
from benchmarks.damadics.simulations import SIMULATIONS
from benchmarks.damadics.watch import CAUSES, SETTLES, Watch
from sklvalve import MissingPhysicsFinder
from sklvalve.damadics import FAULTS
from sklvalve.recording import InputError

# the finder is asked so long after an alarm, then after twice the time again; it gets what was recorded before
# the alarm, and the last of what came after [s]
_FIRST_ASKED, _BEFORE, _AFTER = 300, 600, 600
# before an alarm an effect may have begun [s]
_EARLIER = 60.0
# rows that make a piece
_FEWEST = 120
# a name is believed where its simulation halves the error of rows held out twice
_PROVEN = 0.25


class ValveDetector:
    """Watch against a simulation, then `MissingPhysicsFinder` on the sound run and the last minutes together.

    Parameters
    ----------
    simulation : {"sheet", "learnt", "nominal"}, default="learnt"
    finder : bool, default=True
        Whether the finder is asked; without it the faults are those of the side that alarms.

    Attributes
    ----------
    told_ : list of dict
        Of the last `predict`: when the finder was asked, what it said, and what was made of it.
    """

    def __init__(self, simulation="learnt", finder=True):
        self.simulation, self.finder = simulation, finder

    def fit(self, X):
        """Calibrate on the first half of a sound frame, learn limits on the second."""
        half = len(X) // 2
        made = self.simulation_ = SIMULATIONS[self.simulation]()
        # the actuator starts from rest, open
        made.fit(made.recording(X.iloc[SETTLES:half]))
        self.watch_ = Watch(made).fit(X.iloc[half:])
        return self

    def predict(self, X):
        """Decisions, a row for each of X."""
        from pandas import DataFrame

        alarms, residuals = self.watch_.alarms(X)
        high = np.logical_or.reduce(list(alarms.values()))
        pointed = {fault: np.zeros(len(X)) for fault in FAULTS}
        self.told_ = []
        for begin, end in _spells(high):
            for start, stop, faults in self._spell(X, begin, end, alarms, residuals):
                for fault in faults:
                    pointed[fault][start:stop] = 1.0
        return DataFrame({"detection": high.astype(float)} | pointed, index=X.index)

    def _spell(self, X, begin, end, alarms, residuals):
        """Start, stop and faults of each part of an alarm; a part ends where what is told changes."""
        moments = _moments(begin, end) if self.finder else []
        name, parts, at = None, [], begin
        of_side = _sides(alarms, residuals, begin, end)
        for moment in [*moments, end]:
            for start, stop, side in of_side:
                low, high = max(start, at), min(stop, moment)
                if low < high:
                    parts.append((low, high, name & side if name and name & side else side))
            at = moment
            if moment < end and not any(alarms[cause][moment - 1] for cause in CAUSES):
                name = self._asked(X, begin, moment)
        return parts

    def _asked(self, X, begin, moment):
        """Faults that the finder names and proves at a moment of an alarm; None where it names none."""
        given, told = self.simulation_, {"asked": moment}
        rows = _recorded(begin, moment)
        finder = MissingPhysicsFinder(given.for_finder(), n_jobs=1)
        try:
            found = finder.fit([given.recording(X.iloc[slice(*part)]) for part in rows]).diagnosis_.to_dict()
        except InputError as error:
            self.told_.append(told | {"verdict": "refused", "reasons": [str(error)]})
            return None
        since = begin - rows[0][0] - _EARLIER
        new = [e for e in found["effects"] if given.sound or (e["onset"] or -1.0) >= since]
        classes = [[member["name"] for member in effect["members"]] for effect in new]
        proven = found["verdict"] == "named" and bool(new) and _proven(found["fit"], new)
        named = frozenset.union(*map(faults_of, classes)) if proven else None
        told |= {"verdict": found["verdict"], "p": found["mismatch"]["p_value"], "classes": classes}
        told |= {"proven": proven, "reasons": found.get("reasons", [])}
        told["rmse"] = {c: [f["rmse"]["nominal"], f["rmse"]["corrected"]] for c, f in found["fit"].items()}
        self.told_.append(told)
        return named


def _recorded(begin, moment):
    """First row and end of what the finder gets: in one piece where an alarm is young, else in two."""
    first, late = max(begin - _BEFORE, SETTLES), max(moment - _AFTER, begin)
    if late <= begin or begin - first < _FEWEST:
        return [(min(first, moment - _AFTER), moment)]
    return [(first, begin), (late, moment)]


def _proven(fit, effects):
    """Whether the simulation with the effects leaves little of the error in what they change."""
    touched = {c for effect in effects for c, size in effect["size"].items() if size > 1e-3 and c in fit}
    errors = [fit[c]["rmse"] for c in touched]
    return bool(errors) and all(e["corrected"] <= _PROVEN * e["nominal"] for e in errors)


def _sides(alarms, residuals, begin, end):
    """Start, stop and faults of the stretches of an alarm in which the same signals alarm."""
    rows = np.column_stack([alarms[name][begin:end] for name in (*CAUSES, "flow", "opening")])
    changes = np.flatnonzero((rows[1:] != rows[:-1]).any(axis=1)) + 1 + begin
    edges = [begin, *changes, end]
    return [
        (start, stop, _side(rows[start - begin], residuals["flow"][start:stop]))
        for start, stop in zip(edges[:-1], edges[1:], strict=True)
    ]


def _side(high, flow):
    """Faults that the signals that alarm point at, the most telling first: causes, flow, position."""
    causes = [OF_THE_MEDIUM[cause] for cause, alarm in zip(CAUSES, high[: len(CAUSES)], strict=True) if alarm]
    if causes:
        return frozenset.union(*causes)
    if high[-2]:
        return MORE_FLOW if np.nanmean(flow) > 0.0 else LESS_FLOW
    return OF_THE_ACTUATOR


def _moments(begin, end):
    """Rows at which the finder is asked: 300 s after an alarm, 600, 1200 and so on, and at its end."""
    after, moments = _FIRST_ASKED, []
    while begin + after < end:
        moments.append(begin + after)
        after *= 2
    return [*moments, end - 1] if moments and end - 1 > moments[-1] else moments


def _spells(high):
    """Begin and end, exclusive, of each run of high rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], high.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
