# SPDX-License-Identifier: BSD-3-Clause
"""What makes the transformer the mechanism of a hybrid: output from a flow coefficient, and back."""

from copy import copy

import numpy as np
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import check_is_fitted

from sklvalve.mechanism._binding import per_row

# the output by the column that it is computed from, beside p1: each of the two is the other's output
_READS = {"flow": "p2", "outlet_pressure": "flow"}


class MechanismMixin:
    """Methods of a mechanism, over the rows that the class with the parameters binds.

    That class gives ``_check(X)``, the checked array, ``_rows(X, warn=None)``, its rows, and ``_settings_``,
    the parameters of the fit.
    """

    @available_if(lambda self: _setting(self, "kv_rated") is not None)
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
        r"""Output of the valve with given flow coefficients, the paper's equation 16.

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

        Notes
        -----
        The paper's unknown f(x) is an area, and its pressure difference that to the vena contracta, which
        nobody measures. Here the unknown is the flow coefficient, :math:`f(x) \propto F_L K_v` (see
        `area_from_kv`), and the pressures are those before and behind the valve; choking, viscosity and
        reducers come in where they are known.
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
        if self._settings_["output"] == "flow":
            return rows.kv_for(y, rows.signal("p1"), rows.signal("p2"))
        kv = rows.kv_for(rows.signal("flow"), rows.signal("p1"), y)
        # a choked valve gives the same flow at any lower p2, and no valve lets flow run against its drop
        return np.where((kv > 0.0) & rows.determined(kv, rows.signal("p1"), y), kv, np.nan)

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
        if self._settings_["output"] == "flow":
            return rows.flow_slope(kv)
        return rows.outlet_pressure_slope(kv)

    @property
    def output_columns(self):
        """Positions of the columns that hold an output: p2 and flow, as far as there are any."""
        check_is_fitted(self)
        return {self.columns_[role] for role in _READS.values() if role in self.columns_}

    def for_output(self, output, column=None):
        """Fitted copy that gives the other output, with the same valve and fluid.

        Parameters
        ----------
        output : {"flow", "outlet_pressure"}
            What the copy is to give.
        column : str, default=None
            Name of the column that the copy reads instead of the one it gives; None is ``"p2"`` or
            ``"flow"``. Matters for data with named columns only.

        Returns
        -------
        mechanism : ValveMechanismTransformer
            Where there is a column for p2 and one for the flow, it reads the same data. Otherwise the flow
            stands where p2 stood, or p2 where the flow did; all else stays in its place. Of the features
            those that can be had from the new columns are kept.

        Raises
        ------
        ValueError
            If the output is unknown, or there is a column neither for p2 nor for the flow.

        Examples
        --------
        >>> from sklvalve.mechanism import ValveMechanismTransformer
        >>> valve = ValveMechanismTransformer(kv_rated=40.0).fit([[0.5, 6e5, 4e5]])
        >>> flow = valve.predict([[0.5, 6e5, 4e5]])
        >>> valve.for_output("outlet_pressure").predict([[0.5, 6e5, flow[0]]]).round(3)
        array([400000.])
        """
        check_is_fitted(self)
        if output not in _READS:
            raise ValueError(f"output must be one of {', '.join(_READS)}; got {output!r}.")
        other, settings = copy(self), self._settings_ | {"output": output}
        wanted, freed = _READS[output], _READS[self._settings_["output"]]
        if not {wanted, freed} & set(self.columns_):
            raise ValueError(f"{output} needs a column of {wanted}, and there is none: set {wanted}=...")
        if wanted not in self.columns_:
            at = self.columns_[freed]
            if hasattr(self, "feature_names_in_"):
                names = np.array(self.feature_names_in_, dtype=object)
                names[at] = wanted if column is None else column
                other.feature_names_in_ = names
            by_name = isinstance(settings[freed], str)
            settings |= {wanted: other.feature_names_in_[at] if by_name else at, freed: None}
            other.columns_ = {role: where for role, where in self.columns_.items() if role != freed}
            other.columns_[wanted] = at
        other._settings_ = settings
        # of the copy both say the same, so that one can fit it anew
        other.set_params(**settings | {"warn": self.warn})
        rows = other._rows(np.full((1, self.n_features_in_), np.nan), warn=False)
        other.features_ = [name for name in self.features_ if rows.can_give(name)]
        return other

    def _forward(self, rows, kv):
        if self._settings_["output"] == "flow":
            return rows.flow_through(kv)
        return rows.outlet_pressure_behind(kv)


def _setting(estimator, name):
    """A parameter of the fit, or of the one to come where there was none."""
    return getattr(estimator, "_settings_", {}).get(name, getattr(estimator, name))
