# SPDX-License-Identifier: BSD-3-Clause
"""Our detector: it watches every second, asks the finder for a name while an alarm stands, and tells faults.

A detector of this benchmark has ``fit(X)``, with a frame of a sound run, and ``predict(X)``, which returns a
frame of as many rows: ``detection``, and a column for each diagnosis, named by its faults (``f6`` or
``f6+f18``), all in [0, 1]. X has the columns `runner.SIGNALS`, one row a second. A decision may use what was
recorded until then and no more; ours does not. ``told_`` keeps what was behind the decisions.
"""

from itertools import pairwise

import numpy as np

from benchmarks.damadics.naming import LESS_FLOW, MORE_FLOW, OF_THE_ACTUATOR, OF_THE_MEDIUM, faults_of
from benchmarks.damadics.simulations import SIMULATIONS
from benchmarks.damadics.watch import CAUSES, SETTLES, Watch
from sklvalve import MissingPhysicsFinder
from sklvalve.damadics import FAULTS
from sklvalve.recording import InputError

# the finder is asked so long after an alarm, then after four times that; it gets what was recorded
# before the alarm, and the last of what came after [s]
_FIRST_ASKED, _BEFORE, _AFTER = 300, 600, 600
# an alarm must stand so long before it points at anything, and its flow is judged over so long [s]
_POINTS_AFTER, _JUDGED_OVER = 10, 100
# rows that make a piece
_FEWEST = 120
# a name is believed where its simulation leaves no more error than this, on rows held out: of that of the
# sound run, or of that without the name
_OF_SOUND, _OF_NOMINAL = 2.0, 0.05


class ValveDetector:
    """Watch against a simulation, then `MissingPhysicsFinder` on what was recorded before and after an alarm.

    Each second, the most telling first: a cause that is measured, P1, P2 or T1, outside its sound range
    points at the fault that moves it, and nothing else is asked; the flow beside that of the recorded
    position points at what takes or adds flow; the position alone, at the actuator. The finder narrows this
    where what it names is proven on held-out rows.

    Parameters
    ----------
    simulation : {"learnt", "nominal"}, default="learnt"
    finder : bool, default=True
        Whether the finder is asked; without it the faults are those of the side that alarms.

    Attributes
    ----------
    told_ : list of dict
        Of the last `predict`: when the finder was asked, what it said, and what was made of it.
    """

    def __init__(self, simulation="learnt", finder=True):
        self.simulation, self.finder = simulation, finder

    @property
    def needs_nominal(self):
        """Whether X must hold the stem of the generator's own sound run, X_nominal."""
        return SIMULATIONS[self.simulation].nominal

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
        moments = _moments(begin, end, end == len(X)) if self.finder else []
        name, parts, at = None, [], begin
        of_side = _sides(alarms, _means(residuals["flow"]), min(begin + _POINTS_AFTER, end), end)
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
        effects = found["effects"]
        classes = [[member["name"] for member in effect["members"]] for effect in effects]
        proven = found["verdict"] == "named" and self._proven(found["fit"], effects)
        named = frozenset.union(*map(faults_of, classes)) if proven else None
        told |= {"verdict": found["verdict"], "p": found["mismatch"]["p_value"], "classes": classes}
        told |= {"proven": proven, "reasons": found.get("reasons", [])}
        told["rmse"] = {c: [f["rmse"]["nominal"], f["rmse"]["corrected"]] for c, f in found["fit"].items()}
        self.told_.append(told)
        return named

    def _proven(self, fit, effects):
        """Whether the simulation with the effects leaves little of the error in what they change."""
        touched = {c for effect in effects for c, size in effect["size"].items() if size > 1e-3 and c in fit}
        # a fault that has just begun is in no row before it: forecasts cannot hold it
        errors = [(self.watch_.errors_[c], fit[c]["interleaved"]["rmse"]) for c in touched]
        return bool(errors) and all(
            e["corrected"] <= max(_OF_SOUND * sound, _OF_NOMINAL * e["nominal"]) for sound, e in errors
        )


def _recorded(begin, moment):
    """First row and end of what the finder gets: in one piece where an alarm is young, else in two."""
    first, late = max(begin - _BEFORE, SETTLES), max(moment - _AFTER, begin)
    if late <= begin or begin - first < _FEWEST:
        return [(max(min(first, moment - _AFTER), 0), moment)]
    return [(first, begin), (late, moment)]


def _sides(alarms, flow, begin, end):
    """Start, stop and faults of the stretches of an alarm in which the same signals alarm, the same way."""
    rows = np.column_stack([*(alarms[name] for name in (*CAUSES, "flow", "opening")), flow > 0.0])[begin:end]
    changes = np.flatnonzero((rows[1:] != rows[:-1]).any(axis=1)) + 1 + begin
    edges = [begin, *changes, end] if len(rows) else []
    return [(start, stop, _side(rows[start - begin])) for start, stop in pairwise(edges)]


def _side(high):
    """Faults that the signals that alarm point at, the most telling first: causes, flow, position."""
    *causes, flow, _, more = high
    elsewhere = [OF_THE_MEDIUM[cause] for cause, alarm in zip(CAUSES, causes, strict=True) if alarm]
    if elsewhere:
        return frozenset.union(*elsewhere)
    if flow:
        return MORE_FLOW if more else LESS_FLOW
    return OF_THE_ACTUATOR


def _means(left):
    """Means over the last seconds, of shape (n,)."""
    total = np.concatenate([np.zeros(_JUDGED_OVER), np.cumsum(np.nan_to_num(left))])
    return (total[_JUDGED_OVER:] - total[:-_JUDGED_OVER]) / _JUDGED_OVER


def _moments(begin, end, ends):
    """Rows at which the finder is asked: 300 s after an alarm, 1200, 4800 and so on, and at the very end."""
    after, moments = _FIRST_ASKED, []
    while begin + after < end:
        moments.append(begin + after)
        after *= 4
    return [*moments, end - 1] if ends and moments and moments[-1] < end - 1 else moments


def _spells(high):
    """Begin and end, exclusive, of each run of high rows."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], high.astype(int), [0]])))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
