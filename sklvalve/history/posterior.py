# SPDX-License-Identifier: BSD-3-Clause
"""What windows of a history, each with its own chance of change, let expect of the next one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from sklvalve.simulation.parameters import Parameter, ParameterVector
from sklvalve.simulation.robust import step_inside

# within a history a sound valve changes by this share of what is allowed until the next recording, and the
# scatter of its windows is believed over that as they outweigh so many that are as it says
_SHARE_WITHIN, _WINDOWS_AS_EXPECTED = 0.3, 4.0
_ROUNDS = 40


@dataclass(frozen=True, eq=False)
class Information:
    """What the rows of one window say of a calibration, to second order about a common point.

    Parameters
    ----------
    hessian : ndarray of shape (m, m)
        Of half the weighed squares of whitened errors, in scaled parameters.
    pull : ndarray of shape (m,)
        Where the window's own best lies: ``hessian @ best``, counted from the point.
    moves : ndarray of shape (m, m)
        Mean over the rows of products of what scaled parameters move the signals by, as `moved_by` has it.
    """

    hessian: np.ndarray
    pull: np.ndarray
    moves: np.ndarray


@dataclass(frozen=True, eq=False)
class FromSheet:
    """What a data sheet expects of parameters, in scaled ones counted from a common point.

    Parameters
    ----------
    vector : ParameterVector
    here : ndarray of shape (m,)
        The common point, not scaled.
    precision : ndarray of shape (m,)
        Of the sheet's prior.
    begin : ndarray of shape (m,)
        Its mean.
    reach : tuple of ndarray of shape (m,)
        How far each parameter may lie from the point, down (negative) and up.
    """

    vector: ParameterVector
    here: np.ndarray
    precision: np.ndarray
    begin: np.ndarray
    reach: tuple[np.ndarray, np.ndarray]

    @classmethod
    def of(cls, parameters: Sequence[Parameter], values: Mapping[str, float]) -> FromSheet:
        """Of these parameters, about a calibration."""
        vector = ParameterVector(parameters)
        here, scale = vector.pack(values), vector.scale
        spread = np.array([p.spread or np.inf for p in parameters]) / scale
        begin = (vector.pack({}) - here) / scale
        reach = (vector.low - here) / scale, (vector.high - here) / scale
        return cls(vector, here, np.maximum(spread**-2.0, 1e-9), begin, reach)

    def unscaled(self, point: np.ndarray) -> np.ndarray:
        """A point as the parameters have it, inside of what is possible."""
        return np.clip(self.here + self.vector.scale * point, self.vector.low, self.vector.high)


def centred(windows: Sequence[Information], sheet: FromSheet) -> list[Information]:
    """Windows for which, taken together, the calibration found is the best one.

    A calibration is fitted with a wander held small, and each window weighed by the noise that is left. To
    second order that pulls elsewhere, where the simulation, which is not linear, may fit far worse: the
    recording knows the calibration to be good, and nothing of the kind about the end of that step. What
    windows differ by is kept.

    Parameters
    ----------
    windows : sequence of Information
        All that the calibration was fitted to, counted from it.
    sheet : FromSheet
    """
    away, _ = _of_the_valve(windows, sheet, np.zeros_like(windows[0].hessian))
    share = sheet.precision / len(windows)
    return [replace(w, pull=w.pull - w.hessian @ away - share * away) for w in windows]


def expected(
    windows: Sequence[Information], sheet: FromSheet, allowance: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    r"""Mean and covariance of the calibration of a window that is yet to come.

    The calibration of window w is :math:`\theta_w = \theta + u_w`, with :math:`u_w \sim N(0, Q)`. Q is
    diagonal in the directions in which the allowance is, and found by expectation and maximisation. The next
    recording's calibration has the posterior of :math:`\theta`, another :math:`u`, and the allowance upon it.

    Parameters
    ----------
    windows : sequence of Information
    sheet : FromSheet
        The mean stays inside its reach.
    allowance : ndarray of shape (m, m)
        Covariance of what is allowed without a fault.

    Returns
    -------
    mean : ndarray of shape (m,)
        Counted from the common point.
    covariance : ndarray of shape (m, m)
    """
    sizes, ways = np.linalg.eigh(allowance)
    usual = _SHARE_WITHIN**2 * sizes
    changes = usual.copy()
    for _ in range(_ROUNDS):
        mean, covariance = _of_the_valve(windows, sheet, (ways * changes) @ ways.T)
        sharp, seen = (ways / changes) @ ways.T, np.zeros(len(changes))
        for window in windows:
            # what this window's own change is, given what is known of the valve
            own = np.linalg.inv(window.hessian + sharp)
            step = own @ (window.pull - window.hessian @ mean)
            # no window's calibration is out of bounds, however hard what it hardly tells of is pulled
            step = np.clip(step, *(bound - mean for bound in sheet.reach))
            through = own @ window.hessian
            scatter = own + through @ covariance @ through.T
            seen += (ways.T @ step) ** 2 + np.einsum("ij,ik,kj->j", ways, scatter, ways)
        changes = (seen + _WINDOWS_AS_EXPECTED * usual) / (len(windows) + _WINDOWS_AS_EXPECTED)
    within = (ways * changes) @ ways.T
    mean, covariance = _of_the_valve(windows, sheet, within)
    return mean, covariance + within + allowance


def _of_the_valve(
    windows: Sequence[Information], sheet: FromSheet, changes: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Mean within bounds, and covariance, of what windows have in common."""
    total, pull = np.diag(sheet.precision), sheet.precision * sheet.begin
    for window in windows:
        spread = np.linalg.inv(np.eye(len(changes)) + window.hessian @ changes)
        total = total + spread @ window.hessian
        pull = pull + spread @ window.pull
    total = 0.5 * (total + total.T)
    return step_inside(total, -pull, *sheet.reach), np.linalg.inv(total)
