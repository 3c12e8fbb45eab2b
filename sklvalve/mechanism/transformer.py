# SPDX-License-Identifier: BSD-3-Clause
"""The physics of a valve as a scikit-learn transformer, and as the mechanism of a hybrid."""

from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from sklearn.base import BaseEstimator, TransformerMixin, _fit_context
from sklearn.utils.validation import _check_feature_names_in, check_is_fitted, validate_data

from sklvalve._refits import whole_or_nothing
from sklvalve.mechanism._binding import column_of
from sklvalve.mechanism._gas_rows import GasRows
from sklvalve.mechanism._liquid_rows import LiquidRows
from sklvalve.mechanism._mechanism import MechanismMixin
from sklvalve.mechanism._parameters import CONSTRAINTS, OF_GAS, OF_LIQUID, ROLES
from sklvalve.mechanism.features import DEFAULT_FEATURES, FEATURES, check_names, compute_features
from sklvalve.mechanism.fluid import fluid_from


class ValveMechanismTransformer(MechanismMixin, TransformerMixin, BaseEstimator):
    r"""Physical features of a control valve in liquid or gas service, and its mechanism for a hybrid model.

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
        Column of the fluid's temperature; None takes 20 degC for a liquid, and a gas needs it. [K]
    flow : int, str or None, default=None
        Column of the volume flow, needed for ``output="outlet_pressure"``; of a gas by `basis`. [m3/s]
    kv_rated : float, default=None
        Flow coefficient of the open valve; without it there is no `predict`. [m3/h]
    characteristic : str or list of pairs, default="linear"
        Inherent characteristic, see `relative_capacity`.
    rangeability : float, default=None
        Inherent rangeability. [1]
    shutoff : float, default=0.0
        Opening below which the trim closes down to nothing. [1]
    leakage : float, default=0.0
        Part of the rated capacity that passes at the seat. [1]
    fl : float or list of pairs, default=None
        Pressure recovery factor, or a table of pairs opening, factor; a liquid chokes only with it. [1]
    fd : float or list of pairs, default=None
        Valve style modifier, likewise; with `fl`, `nominal_size` and a known viscosity the flow of a liquid
        need not be turbulent. [1]
    xt : float or list of pairs, default=None
        Pressure drop ratio factor, likewise; a gas needs it. [1]
    xfz : float or list of pairs, default=None
        Ratio x_F at which cavitation begins, likewise; None takes `incipient_xfz`. [1]
    nominal_size, inlet_pipe, outlet_pipe : float, default=None
        Bores of the valve's ends and of the pipes before and behind it; without pipes there are no reducers.
        [m]
    strict : bool, default=False
        Take the standard by the letter where a liquid is not turbulent, see `liquid_flow`.
    fluid : str or Fluid, default="water"
        Name of the liquid, see `fluid_from`, or ``"gas"`` with `molar_mass`, `gamma` and `xt`.
    density : float or callable, default=None
        Density, or a function of the temperature; None takes the fluid's. [kg/m3]
    kinematic_viscosity : float or callable, default=None
        Likewise. [m2/s]
    vapour_pressure, critical_pressure : float or callable, default=None
        Likewise; the second a number only. [Pa]
    brix : float, default=None
        Dissolved solids of ``fluid="sugar juice"``. [%]
    molar_mass : float, default=None
        Molar mass of a gas. [kg/mol]
    gamma : float, default=None
        Ratio of the heat capacities of a gas. [1]
    compressibility : float, default=1.0
        Compressibility factor of a gas before the valve. [1]
    dynamic_viscosity : float, default=None
        Dynamic viscosity of a gas; with `fl`, `fd` and `nominal_size` its flow need not be turbulent. [Pa s]
    basis : {"mass", "actual", "normal", "standard"}, default="mass"
        What the flow of a gas is counted in, see `gas_volume_flow`.
    features : list of str, default=None
        Names of the columns that `transform` gives; `available_features` lists them all. None takes, as far
        as roles and fluid allow, relative_capacity, dp, sqrt_dp_over_density, pressure_ratio, x, density and
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
    feature_names_in_ : ndarray of shape (`n_features_in_`,)
        Their names, where all are strings.

    See Also
    --------
    liquid_flow, liquid_outlet_pressure, gas_flow, gas_outlet_pressure : The equations themselves.

    Notes
    -----
    The more facts are given, the more physics: choking by `fl`, viscosity by `fd`, reducers by the pipes.

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

    _parameter_constraints: ClassVar[dict] = CONSTRAINTS

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
        leakage=0.0,
        fl=None,
        fd=None,
        xt=None,
        xfz=None,
        nominal_size=None,
        inlet_pipe=None,
        outlet_pipe=None,
        strict=False,
        fluid="water",
        density=None,
        kinematic_viscosity=None,
        vapour_pressure=None,
        critical_pressure=None,
        brix=None,
        molar_mass=None,
        gamma=None,
        compressibility=1.0,
        dynamic_viscosity=None,
        basis="mass",
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
        self.leakage = leakage
        self.fl = fl
        self.fd = fd
        self.xt = xt
        self.xfz = xfz
        self.nominal_size = nominal_size
        self.inlet_pipe = inlet_pipe
        self.outlet_pipe = outlet_pipe
        self.strict = strict
        self.fluid = fluid
        self.density = density
        self.kinematic_viscosity = kinematic_viscosity
        self.vapour_pressure = vapour_pressure
        self.critical_pressure = critical_pressure
        self.brix = brix
        self.molar_mass = molar_mass
        self.gamma = gamma
        self.compressibility = compressibility
        self.dynamic_viscosity = dynamic_viscosity
        self.basis = basis
        self.features = features
        self.output = output
        self.warn = warn

    @staticmethod
    def available_features():
        """Names of all features, each with what it is and its unit."""
        return dict(FEATURES)

    @_fit_context(prefer_skip_nested_validation=True)
    @whole_or_nothing
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
        check_names(self.features or ())
        names = getattr(self, "feature_names_in_", None)
        self.columns_ = {
            role: column_of(role, where, names, X.shape[1])
            for role in ROLES
            if (where := getattr(self, role)) is not None
        }
        self._settings_ = self.get_params(deep=False)
        # the first row tells at once what can be had from these roles and this fluid, and what is wrong
        rows = self._rows(X[:1], warn=False)
        rows.check()
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
        # those of the fit: a parameter that is set behind it counts from the next fit on, but for `warn`
        settings = SimpleNamespace(**self._settings_)
        settings.warn = self.warn if warn is None else warn
        signals = {role: X[:, at] for role, at in self.columns_.items()}
        foreign = OF_LIQUID if settings.fluid == "gas" else OF_GAS
        given = [name for name in foreign if getattr(settings, name) is not None]
        if given:
            raise ValueError(
                f"{given[0]} does not belong to fluid={settings.fluid!r}: leave it out, or set another fluid."
            )
        if settings.fluid == "gas":
            return GasRows(signals, settings, None)
        fluid = fluid_from(settings.fluid, **{name: getattr(settings, name) for name in OF_LIQUID})
        return LiquidRows(signals, settings, fluid)

    def __sklearn_tags__(self):
        tags = super().__sklearn_tags__()
        tags.input_tags.allow_nan = True
        return tags
