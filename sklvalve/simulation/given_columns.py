# SPDX-License-Identifier: BSD-3-Clause
"""A simulation of the user's own, a regressor or a function, evaluated once to a column of the recording."""

from dataclasses import replace

import numpy as np

from sklvalve.recording import InputError
from sklvalve.recording.signal import si_signal

_INPUTS = (
    "command",
    "opening",
    "p1",
    "p2",
    "temperature",
    "actuator_pressure",
    "supply_pressure",
    "setpoint",
)
_SIMULATED = {"flow": "simulated_flow", "opening": "simulated_opening"}


def with_given(recording, given, role=None):
    """Recording with what the user's simulation makes of it; as it is where there is no need.

    Parameters
    ----------
    recording : Recording
    given : None, fitted regressor or callable
        A regressor predicts the flow in SI, or the opening where no flow is recorded, from the roles that it
        was fitted to (``feature_names_in_``; without names, from the signals recorded, in the order command,
        opening, p1, p2, temperature). A callable takes the recording and returns such an array, or a dict
        of arrays by role, ``flow`` and ``opening``.
    role : {"flow", "opening"}, default=None
        What an array stands for: the flow where one is recorded, else the opening, unless given.

    Returns
    -------
    recording : Recording

    Raises
    ------
    InputError
        If the simulation wants what is not recorded, or returns something else than one value a row.
    """
    if given is None or set(_SIMULATED.values()) & set(recording):
        return recording
    role = role or ("opening" if "opening" in recording and "flow" not in recording else "flow")
    made = _predicted(recording, given, role) if hasattr(given, "predict") else given(recording)
    made = made if isinstance(made, dict) else {role: made}
    signals, roles = dict(recording.signals), dict(recording.valve.roles)
    for role, values in made.items():
        column = _SIMULATED.get(role)
        if column is None:
            raise InputError(
                f"the simulation given returned {role!r}; it may return one array, or a dict with flow, "
                "opening or both"
            )
        signals[column] = _one_a_row(values, role, len(recording))
        like = roles.get(role) or si_signal(column, mass_flow=recording.mass_flow)
        roles[column] = replace(like, column=column)
    return replace(recording, signals=signals, valve=replace(recording.valve, roles=roles))


def _predicted(recording, regressor, target):
    names = getattr(regressor, "feature_names_in_", None)
    named = names is not None
    if not named:
        names = [role for role in _INPUTS if role in recording and role != target]
        wanted = getattr(regressor, "n_features_in_", len(names))
        if len(names) != wanted:
            raise InputError(
                f"the regressor given was fitted to {wanted} columns without names, and the recording holds "
                f"{', '.join(names)}; fit it to a data frame whose columns are roles"
            )
    missing = [str(name) for name in names if name not in recording]
    if missing:
        raise InputError(
            f"{recording.source}: the regressor given was fitted to {missing[0]!r}, which is not recorded; "
            "fit it to a data frame whose columns are roles that the recording holds"
        )
    X = np.column_stack([recording[str(name)] for name in names])
    rows = np.isfinite(X).all(axis=1)
    made = np.full(len(X), np.nan)
    if rows.any():
        table = _frame(X[rows], names) if named else X[rows]
        made[rows] = np.asarray(regressor.predict(table), dtype=float).reshape(-1)
    return made


def _frame(values, names):
    try:
        from pandas import DataFrame
    except ImportError:
        raise ImportError(
            'a regressor fitted to a data frame needs pandas: pip install "sklvalve[io]"'
        ) from None
    return DataFrame(values, columns=names)


def _one_a_row(values, role, n):
    values = np.asarray(values, dtype=float)
    if values.shape != (n,):
        raise InputError(
            f"the simulation given returned an array of shape {values.shape} for the {role}; it must return "
            f"one value for each of the {n} rows"
        )
    return values
