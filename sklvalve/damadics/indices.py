# SPDX-License-Identifier: BSD-3-Clause
"""How well a fault was detected and isolated: the performance indices of the benchmark."""

from dataclasses import asdict, dataclass

import numpy as np

from sklvalve.damadics import march
from sklvalve.damadics.decisions import covering_times, finite, integral, is_high, pointed_at
from sklvalve.damadics.faults import FAULTS, Profile
from sklvalve.damadics.scenarios import SET_UP, Scenario, scenario_of

#: What an index is that cannot be had.
UNDEFINED = -1.0


@dataclass(frozen=True)
class Zone:
    """When a fault is there, and from when until when decisions count.

    Attributes
    ----------
    begins : float
        Of the fault, the benchmark's t_from [s].
    horizon : float
        End of what counts, t_hor [s].
    ends : float, default=inf
        Of the fault, t_to [s].
    set_up : float, default=300
        Before which nothing counts, t_on [s].

    Raises
    ------
    ValueError
        If they do not follow each other.

    Examples
    --------
    >>> from sklvalve.damadics import Zone, scenario_of
    >>> Zone.of(scenario_of("f13_big"))
    Zone(begins=900.0, horizon=1500.0, ends=inf, set_up=300.0)
    """

    begins: float
    horizon: float
    ends: float = np.inf
    set_up: float = SET_UP

    def __post_init__(self):
        if not (self.set_up <= self.begins < self.horizon < np.inf and self.begins < self.ends):
            raise ValueError(
                "A zone must have set_up <= begins < horizon and begins < ends, got "
                f"{self.set_up!r}, {self.begins!r}, {self.horizon!r} and {self.ends!r}."
            )

    @classmethod
    def of(cls, scenario):
        """Zone of a `Scenario`."""
        return cls(scenario.profile.begins, scenario.horizon, scenario.profile.ends)

    @property
    def until(self):
        """Last moment of the fault that counts [s]."""
        return min(self.ends, self.horizon)


@dataclass(frozen=True)
class Indices:
    """The eighteen indices; -1 is one that cannot be had.

    Attributes
    ----------
    t_dt : float
        Detection time, from the fault's beginning to the last rise of the decision while the fault is there
        [s]; -1 where the decision was high before and stayed so.
    t_drt : float
        Detection recovery time, from the fault's end to the decision's last fall [s].
    t_dm, t_drm : float
        The same two moments on the clock of the file [s].
    r_fd : float
        False detection rate: share of the time without the fault in which the decision is high [1].
    r_td : float
        True detection rate: share of the time with the fault in which it is high [1].
    fs_d : float
        How strong the fault is when it is detected, without its sign [1].
    t_it, t_irt, t_im, t_irm, r_fi, r_ti, fs_i : float
        The same seven of isolation: of the decision for the diagnosis that holds the true fault.
    r_mi : float
        Mismatch isolation rate: how many other diagnoses are pointed at, in the mean over the zone [1].
    dacc_t : float
        Accuracy of the diagnosis that holds the true fault: one over the number of its faults [1].
    dacc_tm : float
        Mean of this over all diagnoses, among them "no fault", which holds what no other does [1].
    dacc : float
        One over the number of faults pointed at when the true one is isolated for the last time [1].
    """

    t_dt: float
    t_drt: float
    t_dm: float
    t_drm: float
    r_fd: float
    r_td: float
    fs_d: float
    t_it: float
    t_irt: float
    t_im: float
    t_irm: float
    r_fi: float
    r_ti: float
    fs_i: float
    r_mi: float
    dacc_t: float
    dacc_tm: float
    dacc: float

    def to_dict(self):
        """Indices by name."""
        return asdict(self)


def performance_indices(t, detection, isolation=None, *, fault, zone, strength=None, diagnoses=None):
    """Indices of the decisions on one fault.

    A decision is high above 0.5, and is held from one sample to the next (the last one as long as the one
    before it). A rise belongs to the fault while it is there, ``begins <= t < ends``; a fall belongs to its
    recovery from its end on. As in the benchmark's calculator, all rates of a fault whose decision is never
    high while it is there are -1, and where it ends within the zone the time after it counts as free of it.

    Parameters
    ----------
    t : array-like of shape (n,)
        Increasing times since the beginning of the file [s].
    detection : array-like of shape (n,)
        Whether there is a fault, in [0, 1].
    isolation : array-like of shape (n, m), data frame or dict of columns, default=None
        Whether each of m diagnoses is pointed at, in [0, 1]. Without `diagnoses` each is one fault: a frame
        names them, an array has all nineteen in order. None: only detection is judged.
    fault : str
        The true one, ``"f1"`` to ``"f19"``.
    zone : Zone
    strength : Profile, array-like of shape (n,) or None, default=None
        Of the fault [1].
    diagnoses : sequence of m sequences of str, default=None
        Faults that each column of `isolation` stands for, each fault in one of them at most.

    Returns
    -------
    indices : Indices

    Raises
    ------
    ValueError
        If a fault is unknown, isolation holds no column, an array has another shape or other values than it
        should, or the times do not cover the zone.

    Notes
    -----
    Definitions: DAMADICS Benchmark Definition v1.0, 2002; Syfert, Patton, Bartys and Quevedo, SAFEPROCESS
    2003. They leave open what a strength of negative sign is (here its size counts, so that -1 stays what
    cannot be had), and whether a rise after the fault's end is its detection (here it is not).

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.damadics import Zone, performance_indices
    >>> t = np.arange(1500.0)
    >>> found = performance_indices(t, t >= 912.0, fault="f7", zone=Zone(begins=900.0, horizon=1500.0))
    >>> found.t_dt, found.r_fd, found.r_td
    (12.0, 0.0, 0.98)
    """
    if fault not in FAULTS:
        raise ValueError(f"fault must be one of f1 to f19, got {fault!r}.")
    t = covering_times(t, zone.set_up, zone.horizon)
    detected = is_high(detection, (len(t),), "detection")
    if not (strength is None or isinstance(strength, Profile)):
        strength = finite(strength, (len(t),), "strength")
    of_detection, _ = _of_decision(t, detected, zone, strength)
    if isolation is None:
        return Indices(*of_detection, *(UNDEFINED,) * 11)
    pointed = pointed_at(isolation, diagnoses, len(t))
    own = np.array([fault in faults for faults in pointed.faults])
    of_isolation, rise = _of_decision(t, pointed.high[:, own].any(axis=1), zone, strength)
    mismatch = UNDEFINED
    if _ever_high(t, detected, zone):
        others = pointed.high[:, ~own].sum(axis=1)
        mismatch = integral(t, others, zone.set_up, zone.horizon) / (zone.horizon - zone.set_up)
    accuracy = UNDEFINED if rise is None else 1.0 / float(pointed.high[rise] @ pointed.sizes)
    return Indices(*of_detection, *of_isolation, mismatch, *_resolution(pointed.sizes, own), accuracy)


def scenario_indices(scenario, t, detection, isolation=None, *, diagnoses=None):
    """Indices of the decisions on a scenario of the benchmark.

    Parameters
    ----------
    scenario : Scenario or str
        Or its name.
    t, detection, isolation, diagnoses
        As in `performance_indices`.

    Returns
    -------
    indices : Indices

    Raises
    ------
    ValueError
        As in `performance_indices`, or if there is no such scenario.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.damadics import scenario_indices
    >>> t = np.arange(2400.0)
    >>> scenario_indices("f13_incipient", t, t >= 1125.0).fs_d
    0.25
    """
    known = scenario if isinstance(scenario, Scenario) else scenario_of(scenario)
    return performance_indices(
        t,
        detection,
        isolation,
        fault=known.fault,
        zone=Zone.of(known),
        strength=known.profile,
        diagnoses=diagnoses,
    )


def _ever_high(t, high, zone):
    return integral(t, high, zone.begins, zone.until) > 0.0


def _of_decision(t, high, zone, strength):
    """Seven indices of a decision, and the row of its last rise while the fault is there, or None."""
    if not _ever_high(t, high, zone):
        return (UNDEFINED,) * 7, None
    change = np.diff(high.astype(int), prepend=0)
    rise = _last((change > 0) & (t >= zone.begins) & (t < zone.until))
    fall = _last((change < 0) & (t >= zone.ends) & (t <= zone.horizon))
    rose, fell = (UNDEFINED if row is None else float(t[row]) for row in (rise, fall))
    free = zone.begins - zone.set_up + zone.horizon - zone.until
    false = integral(t, high, zone.set_up, zone.begins) + integral(t, high, zone.until, zone.horizon)
    seven = (
        UNDEFINED if rise is None else rose - zone.begins,
        UNDEFINED if fall is None else fell - zone.ends,
        rose,
        fell,
        false / free if free > 0.0 else UNDEFINED,
        integral(t, high, zone.begins, zone.until) / (zone.until - zone.begins),
        UNDEFINED if rise is None else _strength(strength, t, rise),
    )
    return seven, rise


def _last(rows):
    where = np.flatnonzero(rows)
    return int(where[-1]) if len(where) else None


def _strength(strength, t, row):
    if strength is None:
        return UNDEFINED
    if not isinstance(strength, Profile):
        return float(abs(strength[row]))
    of_all = np.zeros(len(FAULTS) + 1)
    march.strengths(t[row], np.array([strength.row()]), of_all)
    return float(abs(of_all[FAULTS[strength.fault].number]))


def _resolution(sizes, own):
    """Accuracy of the true fault's diagnosis, and the mean over all of them with that of no fault."""
    without = 1 + len(FAULTS) - sizes.sum()
    of_true = sizes[own][0] if own.any() else without
    return float(1.0 / of_true), float(np.mean(1.0 / np.append(sizes, without)))
