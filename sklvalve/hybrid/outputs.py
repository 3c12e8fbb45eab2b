# SPDX-License-Identifier: BSD-3-Clause
"""One learnt parameter for every output of the mechanism."""

from copy import copy

import numpy as np
from sklearn.utils.metaestimators import available_if
from sklearn.utils.validation import check_is_fitted

from sklvalve.hybrid.inner import clone_model, mechanism_of, seen_columns


def _mechanism_has_outputs(hybrid):
    return hasattr(mechanism_of(hybrid), "for_output")


class OutputsMixin:
    """`for_output` of a hybrid that has `mechanism_`, `regressor_` and `regressor_columns_`."""

    @available_if(_mechanism_has_outputs)
    def for_output(self, output, column=None):
        """Predict another output of the mechanism with the parameter that this hybrid has learnt.

        Parameters
        ----------
        output : str
            For a valve ``"flow"``, from p1 and p2, or ``"outlet_pressure"``, from p1 and the flow.
        column : str, default=None
            Name of the input column that takes the place of the new output: that of the flow for
            ``"outlet_pressure"``, that of p2 for ``"flow"``. None is ``"flow"`` or ``"p2"``. For named
            columns only.

        Returns
        -------
        hybrid : SeriesHybridRegressor
            Fitted, with the same `regressor_`. Its X holds the flow in the column of p2, or p2 in the column
            of the flow; all other columns stay. If the mechanism has a column for each of the two, X stays
            as it is. An outlet pressure is NaN, with a `ValidityWarning`, where the valve cannot pass the
            flow, or where it is choked: then any lower outlet pressure gives the same flow.

        Raises
        ------
        ValueError
            If the regressor sees a column that is an output now or then: its f(x) would not be the same.

        Examples
        --------
        >>> import numpy as np
        >>> from sklvalve.hybrid import SeriesHybridRegressor
        >>> from sklvalve.mechanism import ValveMechanismTransformer, liquid_flow
        >>> rng = np.random.default_rng(0)
        >>> p1, p2, opening, kelvin = rng.uniform([5e5, 2e5, 0.2, 290], [6e5, 4e5, 1.0, 330], (200, 4)).T
        >>> valve = ValveMechanismTransformer(p1=0, p2=1, opening=2, temperature=3, fl=0.9)
        >>> flow = valve.fit([[6e5, 4e5, 0.5, 300]]).forward(np.c_[p1, p2, opening, kelvin], 40 * opening**2)
        >>> model = SeriesHybridRegressor(valve, link="log", regressor_columns=[2])
        >>> model = model.fit(np.c_[p1, p2, opening, kelvin], flow)
        >>> (model.predict([[6e5, 3e5, 0.5, 300]]) * 3600).round(1)
        array([17.3])
        >>> (model.for_output("outlet_pressure").predict([[6e5, 17.3 / 3600, 0.5, 300]]) / 1e5).round(1)
        array([3.])
        """
        check_is_fitted(self)
        other = copy(self)
        other.mechanism_ = self.mechanism_.for_output(output, column)
        names = getattr(self, "feature_names_in_", np.arange(self.n_features_in_))
        seen = seen_columns(self.regressor_columns_, names)
        changing = seen & {*self.mechanism_.output_columns, *other.mechanism_.output_columns}
        if changing and output != self.mechanism_.output:
            raise ValueError(
                f"The regressor sees the column {names[min(changing)]}, which is an output of the mechanism: "
                "its parameter serves no other output; fit with regressor_columns=... that leave it out."
            )
        other.mechanism = clone_model(other.mechanism_)
        if hasattr(self, "feature_names_in_"):
            other.feature_names_in_ = other.mechanism_.feature_names_in_
        return other
