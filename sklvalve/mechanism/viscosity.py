# SPDX-License-Identifier: BSD-3-Clause
"""Flow that is not turbulent: valve Reynolds number, Reynolds factor F_R and the flow in closed form."""

import numpy as np

from sklvalve.mechanism._constants import (
    FLOW_CONSTANT,
    HOUR,
    LAMINAR_REYNOLDS,
    N2,
    N4,
    TURBULENT_REYNOLDS,
    capacity_over_bore,
)
from sklvalve.mechanism._liquid_inputs import positive
from sklvalve.mechanism.trim import full_size_kv as full_size_kv
from sklvalve.mechanism.trim import trim_of as trim_of
from sklvalve.mechanism.trim import trim_parameter as trim_parameter
from sklvalve.mechanism.validity import quiet, warn_rows


def valve_reynolds_number(flow, kv, viscosity, *, fl, fd, inlet_pipe):
    r"""Reynolds number of the jet in a valve, Re_v.

    Parameters
    ----------
    flow : float or array-like
        Actual volume flow; its sign does not matter. [m3/s]
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    viscosity : float or array-like
        Kinematic viscosity. [m2/s]
    fl : float or array-like
        Pressure recovery factor of the valve alone. [1]
    fd : float or array-like
        Valve style modifier. [1]
    inlet_pipe : float or array-like
        Bore of the pipe before the valve; the valve's own where there is no reducer. [m]

    Returns
    -------
    reynolds : float or ndarray
        Valve Reynolds number; NaN where `kv` is zero or any of viscosity, `fl`, `fd` and `inlet_pipe` is not
        positive. [1]

    Notes
    -----
    .. math:: Re_v = \frac{N_4 F_d Q}{\nu \sqrt{K_v F_L}}
              \left(\frac{(F_L K_v)^2}{N_2 D^4} + 1\right)^{1/4}

    with N4 = 0.0707 and N2 = 0.0016 for m3/h, mm and m2/s. For a gas `flow` is the actual flow at the inlet,
    not the normal one.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations.

    Examples
    --------
    Worked example 1 of the standard:

    >>> re = valve_reynolds_number(360 / 3600, 165.0, 3.26e-7, fl=0.9, fd=0.46, inlet_pipe=0.15)
    >>> round(float(re), -3)
    2967000.0
    """
    flow, kv = np.asarray(flow, dtype=float), np.asarray(kv, dtype=float)
    viscosity, fl, fd, inlet_pipe = (positive(value) for value in (viscosity, fl, fd, inlet_pipe))
    with quiet():
        pipe = capacity_over_bore(fl * kv, inlet_pipe)
        jet = np.where(kv != 0.0, viscosity * np.sqrt(np.abs(kv) * fl), np.nan)
        return (N4 * HOUR * fd * np.abs(flow) / jet * (pipe * pipe / N2 + 1.0) ** 0.25)[()]


def reynolds_factor(reynolds, trim, fl, *, strict=False):
    r"""Reynolds factor F_R: what viscosity leaves of the turbulent flow.

    Parameters
    ----------
    reynolds : float or array-like
        Valve Reynolds number, see `valve_reynolds_number`. [1]
    trim : float or array-like
        Trim parameter n, see `trim_parameter`. [1]
    fl : float or array-like
        Pressure recovery factor of the valve alone. [1]
    strict : bool, default=False
        The letter of the standard, with its jumps.

    Returns
    -------
    fr : float or ndarray
        Factor between 0 and 1; NaN where `reynolds` is negative or `trim` or `fl` not positive. [1]

    Notes
    -----
    With a laminar and a transitional law

    .. math:: \lambda = \frac{0.026}{F_L} \sqrt{n\,Re_v}, \qquad
              \tau = 1 + 0.33 \frac{\sqrt{F_L}}{n^{1/4}} \log_{10} \frac{Re_v}{10^4}

    the standard takes :math:`\min(\lambda, 1)` below 10, :math:`\min(\lambda, \tau, 1)` from 10 and 1 from
    10 000 on. Where :math:`\tau(10) < \lambda(10)` it jumps down at 10, and some pressure drops have no flow
    or two. The default is continuous and gives each pressure drop one flow:

    .. math:: F_R = \min\bigl(\lambda,\; \max(\tau, \varphi),\; 1\bigr), \qquad
              \varphi = \max\bigl(\lambda(10),\, \tfrac{0.33}{\ln 10} \sqrt{F_L}\, n^{-1/4}\bigr)

    The second floor is where the transitional law grows faster than the flow itself and stops to be a law.
    From 10 000 on (for n above 0.15, which every valve has) and wherever the standard does not jump, both are
    the same.

    References
    ----------
    .. [1] IEC 60534-2-1, Industrial-process control valves: flow capacity, sizing equations, annex A.

    Examples
    --------
    Worked example 4 of the standard:

    >>> round(float(reynolds_factor(1202.0, 1.235, 0.98)), 3)
    0.715
    """
    reynolds, trim, fl = np.asarray(reynolds, dtype=float), positive(trim), positive(fl)
    reynolds = np.where(reynolds >= 0.0, reynolds, np.nan)
    with quiet():
        laminar = _laminar_law(reynolds, trim, fl)
        slope = _slope(trim, fl)
        transitional = 1.0 + slope * np.log(reynolds / TURBULENT_REYNOLDS)
    if not strict:
        floor = np.maximum(_laminar_law(LAMINAR_REYNOLDS, trim, fl), slope)
        return np.minimum(np.minimum(laminar, np.maximum(transitional, floor)), 1.0)[()]
    factor = np.where(reynolds < LAMINAR_REYNOLDS, laminar, np.minimum(laminar, transitional))
    ruled = np.where(np.isnan(factor), np.nan, 1.0)
    return np.where(reynolds < TURBULENT_REYNOLDS, np.minimum(factor, 1.0), ruled)[()]


def nonturbulent_flow_ratio(reynolds_turbulent, trim, fl, *, strict=False):
    r"""Ratio of the flow to what would flow if it were turbulent: the Reynolds factor without iteration.

    Parameters
    ----------
    reynolds_turbulent : float or array-like
        Valve Reynolds number of the turbulent flow. [1]
    trim, fl, strict
        As in `reynolds_factor`.

    Returns
    -------
    ratio : float or ndarray
        The r that solves r = F_R(r Re_t); never falls as Re_t grows, nor does r Re_t. NaN as in
        `reynolds_factor`; with `strict`, also where the standard has no answer. [1]

    Notes
    -----
    The laminar law gives :math:`r = (0.026/F_L)^2\, n\, Re_t`; the transitional one, with
    :math:`\beta = 0.33 \sqrt{F_L}\, n^{-1/4} / \ln 10` and :math:`c = 1 + \beta \ln(Re_t / 10^4)`, gives

    .. math:: r = -\beta\, W_{-1}\!\left(-\frac{e^{-c/\beta}}{\beta}\right)

    and the smallest of the two and 1 is the ratio. The branch of Lambert's function is evaluated through its
    logarithm, which neither over- nor underflows.

    Examples
    --------
    >>> ratio = nonturbulent_flow_ratio(1000.0, 1.235, 0.98)
    >>> round(float(ratio), 6), round(float(reynolds_factor(1000.0 * ratio, 1.235, 0.98)), 6)
    (0.62736, 0.62736)
    """
    reynolds, trim, fl = np.asarray(reynolds_turbulent, dtype=float), positive(trim), positive(fl)
    with quiet():
        laminar = (0.026 / fl) ** 2 * trim * np.where(reynolds >= 0.0, reynolds, np.nan)
        slope = _slope(trim, fl)
        shift = 1.0 / slope + np.log(reynolds / TURBULENT_REYNOLDS) + np.log(slope)
    transitional = slope * _minus_lambert(shift)
    if not strict:
        floor = np.maximum(_laminar_law(LAMINAR_REYNOLDS, trim, fl), slope)
        return np.minimum(np.minimum(laminar, np.fmax(transitional, floor)), 1.0)[()]
    with quiet():
        low = np.minimum(laminar, 1.0)
        ratio = np.where(reynolds * low < LAMINAR_REYNOLDS, low, np.minimum(low, transitional))
        ratio = np.where(reynolds >= TURBULENT_REYNOLDS, 1.0 + 0.0 * low, ratio)
        kept = np.abs(reynolds_factor(reynolds * ratio, trim, fl, strict=True) - ratio) <= 1e-9 * ratio
    return np.where(kept, ratio, np.nan)[()]


def nonturbulent_kv(flow, p1, p2, density, fr, *, warn=True):
    r"""Flow coefficient of a valve in flow that is not turbulent, F_R being known: the paper's equation 7.

    Parameters
    ----------
    flow : float or array-like
        Volume flow. [m3/s]
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    density : float or array-like
        Density at the inlet. [kg/m3]
    fr : float or array-like
        Reynolds factor, see `reynolds_factor`. [1]
    warn : bool, default=True
        Emit a `ValidityWarning` with the number of rows without an answer.

    Returns
    -------
    kv : float or ndarray
        Flow coefficient; NaN where there is no pressure drop along the flow, or `fr` is not positive. [m3/h]

    See Also
    --------
    liquid_kv : Finds `fr` along with the flow coefficient.

    Notes
    -----
    .. math:: K_v = \frac{Q}{N_1 F_R} \sqrt{\frac{\rho_1 / \rho_0}{\Delta p}}

    The paper prints the *product* of the densities under the root, 31.6 times too much for the root of the
    reference density, leaves F_R undefined, and sets the limit at a Reynolds number of 1000 where the
    standard has 10 000: at 1000 the factor is still between 0.7 and 0.8.

    Examples
    --------
    >>> round(float(nonturbulent_kv(25 / 3600, 6e5, 4e5, 999.1026, 0.5)), 3)
    35.355
    """
    flow, p1, p2, density, fr = (np.asarray(value, dtype=float) for value in (flow, p1, p2, density, fr))
    with quiet():
        drop = np.copysign(p1 - p2, (p1 - p2) * flow)
        possible = (drop > 0.0) & (fr > 0.0) & (density > 0.0)
        kv = np.abs(flow) / (FLOW_CONSTANT * fr) * np.sqrt(density / np.where(possible, drop, np.nan))
    if warn:
        known = ~np.isnan(flow + p1 + p2 + density + fr)
        what = "have no pressure drop along the flow, no density or no Reynolds factor: NaN."
        warn_rows(np.isnan(kv) & known, "nonturbulent_kv", what)
    return kv[()]


def _laminar_law(reynolds, trim, fl):
    return 0.026 / fl * np.sqrt(trim * reynolds)


def _slope(trim, fl):
    """Derivative of the transitional law by the natural logarithm of the Reynolds number."""
    return 0.33 / np.log(10.0) * np.sqrt(fl / np.sqrt(trim))


def _minus_lambert(shift):
    """The y >= 1 with y - ln y = shift, that is -W_-1(-exp(-shift)); NaN below 1, where there is none."""
    # an infinite Reynolds number needs no more than a large one
    excess = np.where(shift > 1.0, np.minimum(shift, 1e100) - 1.0, np.nan)
    y = 1.0 + excess + np.log1p(excess + np.sqrt(2.0 * excess))
    # Newton from a start within some per cent: the fourth step changes nothing any more
    for _ in range(4):
        y = y * (excess + np.log(y)) / (y - 1.0)
    return y
