# SPDX-License-Identifier: BSD-3-Clause
"""What makes the transformer the mechanism of a hybrid: output from a flow coefficient, and back."""

import numpy as np
from sklearn.utils.metaestimators import available_if

from sklvalve.mechanism._binding import per_row
from sklvalve.mechanism.liquid import choked_pressure_drop, liquid_kv


class MechanismMixin:
    """Methods of a mechanism, over the rows that the class with the parameters binds.

    That class gives ``_check(X)``, the checked array, and ``_rows(X, warn=None)``, its `ValveRows`.
    """

    @available_if(lambda self: self.kv_rated is not None)
    def predict(self, X):
        """Output of the valve by its own characteristic; there with `kv_rated` only.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Measured signals in SI.

        Returns
        -------
        output : ndarray of shape (n_samples,)
            Flow [m3/s] or outlet pressure [Pa], by the parameter `output`.
        """
        X = self._check(X)
        rows = self._rows(X)
        return self._forward(rows, rows.kv)

    def forward(self, X, parameter):
        """Output of the valve with given flow coefficients, the paper's equation 16.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Measured signals in SI.
        parameter : array-like of shape (n_samples,)
            Flow coefficient of each row. [m3/h]

        Returns
        -------
        output : ndarray of shape (n_samples,)
            Flow [m3/s] or outlet pressure [Pa], by the parameter `output`.
        """
        X = self._check(X)
        return self._forward(self._rows(X), per_row(parameter, X, "parameter"))

    def invert(self, X, y):
        """Flow coefficients with which `forward` gives the measured output.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Measured signals in SI.
        y : array-like of shape (n_samples,)
            Measured flow [m3/s] or outlet pressure [Pa].

        Returns
        -------
        parameter : ndarray of shape (n_samples,)
            Flow coefficient [m3/h]; NaN where the output says nothing about it: at zero pressure drop, and
            for the outlet pressure in choked flow or without flow.
        """
        X = self._check(X)
        y = per_row(y, X, "y")
        rows = self._rows(X)
        p1, p2, flow = (
            (rows.signal("p1"), rows.signal("p2"), y)
            if self.output == "flow"
            else (rows.signal("p1"), y, rows.signal("flow"))
        )
        kv = liquid_kv(flow, p1, p2, rows.density, warn=self.warn, **rows.choking)
        if self.output == "flow":
            return kv
        # a choked valve gives the same flow at any lower p2, and no valve lets flow run against its drop
        determined = kv > 0.0
        if rows.choking:
            determined &= p1 - p2 < choked_pressure_drop(
                p1, rows.vapour_pressure, rows.critical_pressure, rows.fl
            )
        return np.where(determined, kv, np.nan)

    def sensitivity(self, X, parameter):
        """Derivative of the output of `forward` by the flow coefficient.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Measured signals in SI.
        parameter : array-like of shape (n_samples,)
            Flow coefficient of each row. [m3/h]

        Returns
        -------
        derivative : ndarray of shape (n_samples,)
            In units of the output per m3/h; it goes to zero where the output says nothing about the
            parameter, so its square serves as the weight of a row when parameters are learnt. NaN where
            `forward` is.
        """
        X = self._check(X)
        rows = self._rows(X, warn=False)
        kv = per_row(parameter, X, "parameter")
        if self.output == "flow":
            return np.where(np.isnan(kv), np.nan, rows.flow_through(1.0))
        p1, flow = rows.signal("p1"), rows.signal("flow")
        p2 = rows.outlet_pressure_behind(kv)
        # p2 differs from a pressure that kv does not move by a drop that falls with the square of kv
        anchor = p1
        if rows.choking:
            boiling = rows.ff * rows.vapour_pressure
            turbulent = liquid_kv(flow, p1, p2, rows.density, warn=False)
            anchor = np.where((flow < 0.0) & (turbulent < kv * (1.0 - 1e-9)), boiling, p1)
        return 2.0 * (anchor - p2) / kv

    def _forward(self, rows, kv):
        return rows.flow_through(kv) if self.output == "flow" else rows.outlet_pressure_behind(kv)
