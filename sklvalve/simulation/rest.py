# SPDX-License-Identifier: BSD-3-Clause
"""What data say beyond the physics: a rest learnt by an LS-SVM, kept as plain arrays."""

import numpy as np

from sklvalve.lssvm import LSSVMRegressor
from sklvalve.simulation.given import ROLES as GIVEN_ROLES
from sklvalve.simulation.stages import first_order_lag

_WAVES = {"cosine": np.cos, "sine": np.sin}


def rest_inputs(chain, values, names, stem=None):
    """Signals on which a learnt rest hangs, one column for each name (opening, command, dp [bar], ...).

    ``simulated_flow 40 s`` is a simulated flow behind a first-order lag of 40 s: what the rest remembers;
    ``cosine 640 s`` and ``sine 640 s`` are the waves of that period on the recording's clock.
    """
    columns = {"command": chain.command, "temperature": chain.temperature, "dp": chain.dp / 1e5}
    columns["pressure_ratio"] = chain.pressure_ratio
    columns |= {role: chain.recording[role] for role in GIVEN_ROLES if any(role in name for name in names)}
    if "opening" in names:
        columns["opening"] = chain.drive(values) if stem is None else stem
    return np.column_stack([_remembered(chain, columns, *name.split(" ")) for name in names])


def input_words(name: str) -> str:
    """Words of an input, as `rest_inputs` names it; what it remembers is said behind it.

    Examples
    --------
    >>> from sklvalve.simulation.rest import input_words
    >>> input_words("simulated_flow 40 s")
    'simulated flow lagged by 40 s'
    """
    signal, _, memory = name.partition(" ")
    return signal.replace("_", " ") + (f" lagged by {memory}" if memory else "")


def _remembered(chain, columns, signal, seconds=None, _unit="s"):
    if signal in _WAVES:
        return _WAVES[signal](2.0 * np.pi * chain.clock / float(seconds))
    values = columns[signal]
    return values if seconds is None else first_order_lag(values, chain.step, float(seconds), 1.0)


def learnt_rest(correction, chain, values, stem=None):
    """Rest that a stored LS-SVM predicts for the signals of a chain; zero where one of them is a gap.

    Parameters
    ----------
    correction : dict
        Plain data: names of the inputs, their centre and scale; support, coefficients, intercept and gamma
        of the LS-SVM; span, the unit of what it predicts.
    chain : Chain
    values : dict
        Values of the simulation's parameters.
    stem : ndarray of shape (n,), default=None
        Opening that drives the flow [1]; that of the chain unless given.

    Returns
    -------
    rest : ndarray of shape (n,)
        To be added to the simulated signal.
    """
    X = rest_inputs(chain, values, correction["inputs"], stem)
    return learnt_at(correction, (X - correction["centre"]) / correction["scale"])


def learnt_at(correction, Z):
    """Rest that a stored LS-SVM predicts for its scaled inputs; zero where one of them is a gap.

    Parameters
    ----------
    correction : dict
    Z : ndarray of shape (n, n_inputs)

    Returns
    -------
    rest : ndarray of shape (n,)
    """
    support = correction["support"]
    # beyond what it was trained on it must not guess: the nearest edge holds
    Z = np.clip(Z, support.min(axis=0), support.max(axis=0))
    known = np.isfinite(Z).all(axis=1)
    rest = np.zeros(len(Z))
    if known.any():
        rest[known] = _lssvm_of(correction).predict(Z[known])
    return rest * correction["span"]


def _lssvm_of(correction):
    """The fitted estimator whose numbers a model file holds: plain data in, nothing executed."""
    regressor = LSSVMRegressor(gamma=float(correction["gamma"]))
    return regressor.with_solution(
        correction["support"], correction["coefficients"], float(correction["intercept"])
    )
