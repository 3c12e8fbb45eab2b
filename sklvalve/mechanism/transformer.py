# SPDX-License-Identifier: BSD-3-Clause
"""The physics of a valve as a scikit-learn transformer, and as the mechanism of a hybrid."""

from numbers import Integral, Real
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, TransformerMixin, _fit_context
from sklearn.utils._param_validation import Interval, StrOptions
from sklearn.utils.validation import _check_feature_names_in, check_is_fitted, validate_data

from sklvalve.mechanism._binding import column_of
from sklvalve.mechanism._mechanism import MechanismMixin
from sklvalve.mechanism.features import DEFAULT_FEATURES, FEATURES, ValveRows, compute_features
from sklvalve.mechanism.fluid import Fluid, fluid_from

_ROLES = ("opening", "p1", "p2", "temperature", "flow")
_SETTINGS = ("characteristic", "fl", "kv_rated", "rangeability", "shutoff", "warn")
_ROLE = [Interval(Integral, 0, None, closed="left"), str, None]
_PROPERTY = [Interval(Real, 0, None, closed="neither"), callable, None]


class ValveMechanismTransformer(MechanismMixin, TransformerMixin, BaseEstimator):
    r"""Physical features of a control valve in liquid service, and its mechanism for a hybrid model.

    As a transformer it turns measured columns into quantities in which a valve is simple. As a mechanism it
    computes the output from a flow coefficient that something else predicts (`forward`) and finds that
    coefficient from the measured output (`invert`). With a rated coefficient it predicts by itself
    (`predict`). Everything is in SI: Pa absolute, m3/s, K; flow coefficients in m3/h.

    Parameters
    ----------
    opening : int, str or None, default=0
        Column of the relative travel, by position or by name; None where there is none. [1]
    p1 : int, str or None, default=1
        Column of the pressure before the valve, absolute. [Pa]
    p2 : int, str or None, default=2
        Column of the pressure behind the valve, absolute. [Pa]
    temperature : int, str or None, default=None
        Column of the liquid's temperature; None takes 20 degC. [K]
    flow : int, str or None, default=None
        Column of the volume flow, needed for ``output="outlet_pressure"``. [m3/s]
    kv_rated : float, default=None
        Flow coefficient of the open valve; without it there is no `predict`. [m3/h]
    characteristic : str or list of pairs, default="linear"
        Inherent characteristic, see `relative_capacity`.
    rangeability : float, default=None
        Inherent rangeability. [1]
    shutoff : float, default=0.0
        Opening below which the trim closes down to nothing. [1]
    fl : float or list of pairs, default=None
        Pressure recovery factor, or a table of pairs opening, factor; None leaves choking out. [1]
    fluid : str or Fluid, default="water"
        Name of the fluid, see `fluid_from`.
    density : float or callable, default=None
        Density, or a function of the temperature; None takes the fluid's. [kg/m3]
    kinematic_viscosity : float or callable, default=None
        Likewise. [m2/s]
    vapour_pressure : float or callable, default=None
        Likewise. [Pa]
    critical_pressure : float, default=None
        Likewise. [Pa]
    features : list of str, default=None
        Names of the columns that `transform` gives; `available_features` lists them all. None takes, as far
        as roles and fluid allow, relative_capacity, dp, sqrt_dp_over_density, pressure_ratio, density and
        vapour_pressure.
    output : {"flow", "outlet_pressure"}, default="flow"
        What `forward` and `predict` give: flow from the pressures, or `p2` from flow and `p1`.
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows outside the validity of the physics.

    Attributes
    ----------
    columns_ : dict
        Position of each role's column.
    features_ : list of str
        Names of the columns that `transform` gives.
    n_features_in_ : int
        Number of columns seen in `fit`.
    feature_names_in_ : ndarray of shape (n_features_in_,)
        Their names, where all are strings.

    See Also
    --------
    liquid_flow, liquid_outlet_pressure : The equations themselves.

    Notes
    -----
    The paper's equation 16 leaves the area f(x) of the vena contracta unknown. For a liquid that area is
    proportional to :math:`F_L K_v` (see `area_from_kv`), so the unknown parameter is the flow coefficient
    here: a data sheet knows it.

    Examples
    --------
    >>> import numpy as np
    >>> X = np.array([[0.5, 6e5, 4e5], [1.0, 6e5, 4e5]])
    >>> valve = ValveMechanismTransformer(kv_rated=40.0, features=["dp", "relative_capacity"]).fit(X)
    >>> valve.transform(X)
    array([[2.e+05, 5.e-01],
           [2.e+05, 1.e+00]])
    >>> (valve.predict(X) * 3600).round(1)
    array([28.3, 56.6])
    >>> valve.invert(X, valve.predict(X)).round(6)
    array([20., 40.])
    """

    _doc_link_module = "sklvalve"

    _parameter_constraints: ClassVar[dict] = {
        "opening": _ROLE,
        "p1": _ROLE,
        "p2": _ROLE,
        "temperature": _ROLE,
        "flow": _ROLE,
        "kv_rated": [Interval(Real, 0, None, closed="neither"), None],
        "characteristic": [str, "array-like"],
        "rangeability": [Interval(Real, 1, None, closed="neither"), None],
        "shutoff": [Interval(Real, 0, 1, closed="left")],
        "fl": [Interval(Real, 0, 1, closed="right"), "array-like", None],
        "fluid": [str, Fluid],
        "density": _PROPERTY,
        "kinematic_viscosity": _PROPERTY,
        "vapour_pressure": _PROPERTY,
        "critical_pressure": [Interval(Real, 0, None, closed="neither"), None],
        "features": ["array-like", None],
        "output": [StrOptions({"flow", "outlet_pressure"})],
        "warn": ["boolean"],
    }

    def __init__(
        self,
        *,
        opening=0,
        p1=1,
        p2=2,
        temperature=None,
        flow=None,
        kv_rated=None,
        characteristic="linear",
        rangeability=None,
        shutoff=0.0,
        fl=None,
        fluid="water",
        density=None,
        kinematic_viscosity=None,
        vapour_pressure=None,
        critical_pressure=None,
        features=None,
        output="flow",
        warn=True,
    ):
        self.opening = opening
        self.p1 = p1
        self.p2 = p2
        self.temperature = temperature
        self.flow = flow
        self.kv_rated = kv_rated
        self.characteristic = characteristic
        self.rangeability = rangeability
        self.shutoff = shutoff
        self.fl = fl
        self.fluid = fluid
        self.density = density
        self.kinematic_viscosity = kinematic_viscosity
        self.vapour_pressure = vapour_pressure
        self.critical_pressure = critical_pressure
        self.features = features
        self.output = output
        self.warn = warn

    @staticmethod
    def available_features():
        """Names of all features, each with what it is and its unit."""
        return dict(FEATURES)

    @_fit_context(prefer_skip_nested_validation=True)
    def fit(self, X, y=None):
        """Bind the roles to the columns; nothing is estimated.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Measured signals in SI; NaN is a gap.
        y : None
            Ignored.

        Returns
        -------
        self : ValveMechanismTransformer

        Raises
        ------
        ValueError
            If a role names no column, or a feature is unknown.
        """
        X = validate_data(self, X, dtype=np.float64, ensure_all_finite="allow-nan")
        unknown = [name for name in self.features or () if name not in FEATURES]
        if unknown:
            raise ValueError(
                f"unknown feature {unknown[0]!r} in features: use some of {', '.join(FEATURES)}."
            )
        names = getattr(self, "feature_names_in_", None)
        self.columns_ = {
            role: column_of(role, where, names, X.shape[1])
            for role in _ROLES
            if (where := getattr(self, role)) is not None
        }
        # the first row tells at once what can be had from these roles and this fluid, and what is wrong
        rows = self._rows(X[:1], warn=False)
        _ = rows.choking
        if self.features is None:
            self.features_ = [name for name in DEFAULT_FEATURES if rows.can_give(name)]
        else:
            self.features_ = [str(name) for name in self.features]
            compute_features(rows, self.features_, 1)
        return self

    def transform(self, X):
        """Compute the features.

        Parameters
        ----------
        X : array-like of shape (n_samples, n_features)
            Measured signals in SI; NaN in gives NaN out, row by row.

        Returns
        -------
        features : ndarray of shape (n_samples, n_features_out)
            In the order of `features_`; a data frame after ``set_output``.
        """
        X = self._check(X)
        return compute_features(self._rows(X), self.features_, X.shape[0])

    def get_feature_names_out(self, input_features=None):
        """Names of the columns that `transform` gives.

        Parameters
        ----------
        input_features : array-like of str, default=None
            Checked against the columns seen in `fit`, as scikit-learn demands; not used otherwise.

        Returns
        -------
        names : ndarray of str objects
        """
        check_is_fitted(self)
        _check_feature_names_in(self, input_features)
        return np.asarray(self.features_, dtype=object)

    def _check(self, X):
        check_is_fitted(self)
        return validate_data(self, X, reset=False, dtype=np.float64, ensure_all_finite="allow-nan")

    def _rows(self, X, warn=None):
        settings = SimpleNamespace(**{name: getattr(self, name) for name in _SETTINGS})
        settings.warn = self.warn if warn is None else warn
        fluid = fluid_from(
            self.fluid,
            density=self.density,
            kinematic_viscosity=self.kinematic_viscosity,
            vapour_pressure=self.vapour_pressure,
            critical_pressure=self.critical_pressure,
        )
        return ValveRows({role: X[:, at] for role, at in self.columns_.items()}, settings, fluid)

    def __sklearn_tags__(self):
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        return tags
