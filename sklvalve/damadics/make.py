# SPDX-License-Identifier: BSD-3-Clause
"""Recordings of the benchmark's actuator as data frames."""

from dataclasses import replace

import numpy as np

from sklvalve.damadics.actuator import constants_of
from sklvalve.damadics.checks import number
from sklvalve.damadics.excitation import in_range
from sklvalve.damadics.faults import OF_THE_MEDIUM, Profile
from sklvalve.damadics.loop import LevelLoop
from sklvalve.damadics.scenarios import BEGINS, GOES_ON, Scenario, scenario_of
from sklvalve.damadics.simulator import SIGMA, TEMPERATURE_SPAN, ActuatorSimulator

# the benchmark's noise comes after the end of the range, which is not told by one value: four sigmas below it
_END_OF_RANGE = 1.0 - 4.0 * SIGMA


def make_damadics(
    scenario=None,
    *,
    duration=None,
    settled=0.0,
    actuator=3,
    loop=None,
    extended=False,
    nominal=False,
    noise=True,
    random_state=None,
    callback=None,
):
    """Record the benchmark's actuator, sound or with a fault, once a second.

    Parameters
    ----------
    scenario : str, Scenario, Profile or None, default=None
        One of the forty-four by its name, such as ``"f13_incipient"`` (`sklvalve.damadics.SCENARIOS`); the
        course of a fault of one's own; None is without a fault.
    duration : float or None, default=None
        [s]. None: to the end of the scenario's zone; for a course of one's own until 600 s after it has
        developed; 1500 s without a fault.
    settled : float, default=0.0
        Whole seconds that the actuator has run before the recording and its clock begin [s]. It starts from
        rest, open and without pressure; 0, as the benchmark has it, records this too.
    actuator : {1, 2, 3} or Actuator, default=3
        See `sklvalve.damadics.preset`; 3 is the benchmark's own.
    loop : LevelLoop or None, default=None
        A loop that the valve closes (example IV), with actuator 3 or one of like pressures; None is the
        standard excitation of an open loop.
    extended : bool, default=False
        Add what the benchmark forbids a diagnosis to use.
    nominal : bool, default=False
        Add the stem of the sound actuator under the same command, pressures and temperature: a simulation for
        a diagnosis to correct. Of an open loop only.
    noise : bool, default=True
        Of the sensors, and of the command within the positioner.
    random_state : int, Generator or None, default=None
        Of the noise. One seed gives other noise where the duration is another one, before the fault too.
    callback : callable, default=None
        Called as ``callback(stage, done)`` with a plain word and the share done.

    Returns
    -------
    frame : DataFrame
        One row a second, in engineering units, as the recordings of the sugar factory have them: ``time``
        [s], command ``CV`` and stem ``X`` [% of *closing*], ``P1``, ``P2`` [kPa], ``T1`` [degC], ``F`` [t/h],
        ``F_in_range``, the same but for gaps where the meter stands at the end of its range (40 t/h for
        actuator 3, which the standard excitation exceeds in a third of the rows), and ``fault``, the signed
        strength of the fault [1]. In a loop also ``PV``, the level [%]. Nominal: ``X_nominal`` [%].
        Extended: pressures of chamber and supply as shown, ``Ps``, ``Pz`` [kPa, gauge], output of the
        positioner's controller ``CVI`` [%], and without noise, saturation and sensor faults ``true_X`` [%],
        ``true_F`` [t/h], ``true_Ps`` [kPa, gauge] and ``Fvc``, the force of the jet [N]. `valve_sheet`
        describes the frame to a `Recording`.

    Raises
    ------
    ValueError
        If there is no such scenario or actuator, the duration is below a second, a loop does not fit the
        actuator, or the nominal stem of a loop is asked for.
    ImportError
        If pandas is missing.

    See Also
    --------
    ActuatorSimulator : signals over their spans, other excitations, several faults at once.

    Examples
    --------
    >>> from sklvalve.damadics import make_damadics
    >>> frame = make_damadics("f7_big", random_state=0)
    >>> list(frame.columns)
    ['time', 'CV', 'P1', 'P2', 'T1', 'X', 'F', 'F_in_range', 'fault']
    >>> len(frame), float(frame["fault"].iloc[-1])
    (1500, 0.75)
    """
    pd = _pandas()
    if not (loop is None or isinstance(loop, LevelLoop)):
        raise ValueError(f"loop must be a LevelLoop or None, got {loop!r}.")
    if nominal and loop:
        raise ValueError("nominal is the stem of an open loop; leave nominal or loop out.")
    known = (
        scenario if scenario is None or isinstance(scenario, Profile | Scenario) else scenario_of(scenario)
    )
    profile = known.profile if isinstance(known, Scenario) else known
    constants, faults = constants_of(actuator), [profile] if profile else []
    excitation = loop or in_range(constants.pressure_range)
    times = settled, lasts(known) if duration is None else duration
    simulator = ActuatorSimulator(constants, noise=noise)
    half = 0.5 if nominal else 1.0
    say = _part_of(callback, "simulating", 0.0, half)
    run = _recorded(simulator, *times, excitation, faults, random_state=random_state, callback=say)
    columns = _signals(run, constants) | {"fault": run[profile.fault] if profile else 0.0}
    if loop:
        columns["PV"] = 100.0 * run["PV"]
    if nominal:
        seen = [fault for fault in faults if fault.fault in OF_THE_MEDIUM]
        say = _part_of(callback, "simulating the sound actuator", half, 1.0)
        sound = _recorded(ActuatorSimulator(constants, noise=False), *times, excitation, seen, callback=say)
        columns["X_nominal"] = 100.0 * sound["X"]
    return pd.DataFrame(columns | (_extended(run, simulator) if extended else {}))


def _part_of(callback, stage, start, end):
    """Callback of one of the runs; None where nobody listens."""
    if callback is None:
        return None
    return lambda done: callback(stage, start + (end - start) * done)


def lasts(scenario):
    """How long a recording of a `Scenario`, of a `Profile` or of no fault is by itself [s]."""
    if isinstance(scenario, Scenario):
        return scenario.horizon
    if isinstance(scenario, Profile):
        return scenario.begins + abs(scenario.strength) * scenario.takes + GOES_ON
    return BEGINS + GOES_ON


def _recorded(simulator, settled, duration, excitation, faults, **settings):
    """A run whose clock begins when the actuator has run for some whole seconds."""
    rows = round(number("settled", settled, 0.0))
    if rows != settled:
        raise ValueError(f"settled must be whole seconds, got {settled!r}.")
    if not number("duration", duration) >= 1.0:
        raise ValueError(f"duration must be at least 1 s, got {duration!r}.")
    later = [replace(fault, begins=fault.begins + rows, ends=fault.ends + rows) for fault in faults]
    driven = excitation if isinstance(excitation, LevelLoop) else lambda t: excitation(t - rows)
    run = simulator.simulate(rows + duration, driven, later, **settings)
    return {name: values[rows:] for name, values in run.items()} | {"t": run["t"][rows:] - rows}


def _signals(run, actuator):
    kilopascal, flow = 1e-3 * actuator.pressure_range, actuator.flow_range * run["F"]
    return {
        "time": run["t"],
        "CV": 100.0 * run["CV"],
        "P1": kilopascal * run["P1"],
        "P2": kilopascal * run["P2"],
        "T1": TEMPERATURE_SPAN * run["T1"],
        "X": 100.0 * run["X"],
        "F": flow,
        "F_in_range": np.where(run["F"] < _END_OF_RANGE, flow, np.nan),
    }


def _extended(run, simulator):
    kilopascal = 1e-3 * simulator.pressure_span
    return {
        "Ps": kilopascal * run["Ps_shown"],
        "Pz": kilopascal * run["Pz_shown"],
        "CVI": 100.0 * run["CVI_shown"],
        "true_X": 100.0 * run["x"] / simulator.actuator.stroke,
        "true_F": run["F_tph"],
        "true_Ps": 1e-3 * run["Ps"],
        "Fvc": run["Fvc"],
    }


def _pandas():
    try:
        import pandas
    except ImportError:
        raise ImportError(
            'Recordings are made as data frames; install pandas with: pip install "sklvalve[io]"'
        ) from None
    return pandas
