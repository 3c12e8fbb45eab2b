# SPDX-License-Identifier: BSD-3-Clause
"""Three methods that look at the shape of half periods: triangles, sines, a relay's answer, or areas."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

import sklvalve.mismatch.loop.constants as constants
from sklvalve.mismatch.loop.methods.filters import control_error, low_passed, without_drift
from sklvalve.mismatch.loop.methods.result import Method, MethodResult, by_limits
from sklvalve.mismatch.loop.oscillation import Oscillation, zero_crossings

POINTS = 33  # of each half period, ends included
_HARMONICS = 8.0  # kept of the wave; what is faster is noise to a shape of two straight lines
_NEAR = 1.0 / 6.0  # of a period, in which the wave's own zero lies from that of its first harmonic
_LENGTHS = (0.25, 0.8)  # of a period, of half periods that count
_LAGS = np.geomspace(0.02, 3.0, 24)  # of a half period: from a square wave to nearly straight flanks

_AREA = Method(
    "peak area",
    "Singhal and Salsbury 2005, Journal of Process Control 15, 371-382",
    constants.PEAK_AREA_LIMIT,
)
_CURVE = Method(
    "curve fitting", "He, Wang, Pottmann and Qin 2007, doi 10.1021/ie061219a", constants.CURVE_LIMITS[1]
)
_RELAY = Method(
    "relay fitting", "Rossi and Scali 2005, Journal of Process Control 15, 505-514", constants.RELAY_LIMITS[1]
)


def area(
    value: ArrayLike,
    oscillation: Oscillation,
    *,
    setpoint: ArrayLike | None = None,
    is_flow: bool | None = None,
) -> MethodResult:
    r"""Compare the areas of the error before and after its peak.

    .. math:: R = A_1 / A_2

    A value behind a valve that jumps and stays rises to its peak for longer than it falls from it, so that
    the area before the peak is the larger; a controller that is too aggressive gives sines, R = 1. R is the
    geometric mean over the half periods.

    Valid for self-regulating processes that oscillate regularly, ten rows or more in a period.

    Parameters
    ----------
    value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        Of the value's unit; where it is given, the error takes the place of the value.
    is_flow : bool or None
        False: the process may integrate, and the method does not apply.

    Returns
    -------
    result : MethodResult

    References
    ----------
    A. Singhal, T. I. Salsbury, A simple method for detecting valve stiction in oscillating control loops,
    Journal of Process Control 15 (2005) 371-382.
    """
    integrates = "The process may integrate, and the method is for self-regulating ones."
    error = control_error(value, setpoint)
    return _apply(_AREA, oscillation, error, _peak_areas, integrates if is_flow is False else None)


def curve_shape(
    command: ArrayLike, value: ArrayLike, oscillation: Oscillation, *, is_flow: bool | None = None
) -> MethodResult:
    r"""Compare triangles and sines on the half periods of the first integrated signal behind the valve.

    .. math:: SI = \frac{MSE_\text{sin}}{MSE_\text{sin} + MSE_\text{tri}}

    A valve that jumps sends steps into the process. The first integrator behind it makes triangles of them:
    the controller (its command counts) for a self-regulating process, the process itself (its value counts)
    for an integrating one. Each half period is fitted from zero to zero by two straight lines with a free
    peak and by half a sine.

    Valid for a regular oscillation of ten rows or more in a period. A process with a long lag rounds the
    triangle off; an outside triangle or square wave is called stiction too.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    is_flow : bool or None
        False takes the value (a process that integrates), else the command is taken.

    Returns
    -------
    result : MethodResult

    References
    ----------
    Q. P. He, J. Wang, M. Pottmann, S. J. Qin, A curve fitting method for detecting valve stiction in
    oscillating control loops, Industrial and Engineering Chemistry Research 46 (2007) 4549-4560.
    """
    if is_flow is False:
        return _apply(_CURVE, oscillation, value, _triangles_or_sines)
    return _apply(_CURVE, oscillation, command, _triangles_or_sines, name="command")


def relay(value: ArrayLike, oscillation: Oscillation, *, setpoint: ArrayLike | None = None) -> MethodResult:
    r"""Compare a relay's answer and triangles with sines on the half periods of the value.

    .. math:: S = \frac{E_\text{sin} - E_\text{rt}}{E_\text{sin} + E_\text{rt}}

    with the mean squared errors of the best sine and of the better of the two other families: triangles with
    a free peak, and the answer of a first-order lag with dead time to a relay (exponential flanks, any lag).

    Valid for a regular oscillation of ten rows or more in a period. A square wave from outside is called
    stiction too.

    Parameters
    ----------
    value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        Of the value's unit; where it is given, the error takes the place of the value.

    Returns
    -------
    result : MethodResult

    References
    ----------
    M. Rossi, C. Scali, A comparison of techniques for automatic detection of stiction: simulation and
    application to industrial data, Journal of Process Control 15 (2005) 505-514.
    """
    return _apply(_RELAY, oscillation, control_error(value, setpoint), _relay_or_sines)


def _apply(
    method: Method,
    oscillation: Oscillation,
    signal: ArrayLike,
    judge: Callable[[NDArray, str], tuple[float, str, str]],
    obstacle: str | None = None,
    name: str = "value",
) -> MethodResult:
    """The result of a method on the half periods of a signal, if it has enough of them."""
    obstacle, rows = method.obstacle(oscillation) or obstacle, oscillation.rows or 0.0
    if rows < method.fewest_rows:
        return method.not_applicable(obstacle)
    shapes = half_periods(signal, rows)
    if len(shapes) < constants.FEWEST_HALF_PERIODS:
        needed = f"and {constants.FEWEST_HALF_PERIODS} are needed"
        return method.not_applicable(f"The {name} has {len(shapes)} whole half periods, {needed}.")
    return method.result(*judge(shapes, name), obstacle)


def _peak_areas(shapes: NDArray, name: str) -> tuple[float, str, str]:
    """Ratio of areas, what it says, and in words."""
    ratios = np.log(_ratios(shapes))
    mean, error = float(ratios.mean()), float(ratios.std(ddof=1) / np.sqrt(len(ratios)))
    says = by_limits(mean, -constants.PEAK_AREA_SURE * error, constants.PEAK_AREA_SURE * error)
    times = f"{np.exp(mean):.2f} times that after it, in the mean of {len(shapes)} half periods"
    return float(np.exp(mean)), says, f"The area before the peak is {times}."


def _ratios(shapes: NDArray) -> NDArray:
    """Area before over area after the peak of each shape, the peak's own point shared."""
    up = np.maximum(shapes, 0.0)
    peaks = np.clip(up.argmax(axis=1), 1, POINTS - 2)
    at = np.arange(POINTS)
    weights = np.where(at < peaks[:, None], 1.0, np.where(at == peaks[:, None], 0.5, 0.0))
    before, after = (up * weights).sum(axis=1), (up * (1.0 - weights)).sum(axis=1)
    return np.maximum(before, 1e-300) / np.maximum(after, 1e-300)


def _triangles_or_sines(shapes: NDArray, name: str) -> tuple[float, str, str]:
    """Stiction index of triangles against sines, what it says, and in words."""
    sine, triangle = (residual_squares(shapes, each).sum() for each in (sines(), triangles()))
    index = float(sine / max(sine + triangle, 1e-300))
    detail = (
        f"Triangles fit the {name}'s {len(shapes)} half periods with {triangle / max(sine, 1e-300):.2g} "
        "times the squared error of sines."
    )
    return index, by_limits(index, *constants.CURVE_LIMITS), detail


def _relay_or_sines(shapes: NDArray, name: str) -> tuple[float, str, str]:
    """Stiction index of a relay's answer or triangles against sines, what it says, and in words."""
    families = sines(), _RELAYS, triangles()
    sine, answer, triangle = (residual_squares(shapes, each).mean() for each in families)
    other = min(answer, triangle)
    index = float((sine - other) / max(sine + other, 1e-300))
    best = "answers of a relay" if answer <= triangle else "triangles"
    detail = (
        f"Of the {name}'s {len(shapes)} half periods, {best} leave {other / max(sine, 1e-300):.2g} times the "
        "squared error of sines."
    )
    return index, by_limits(index, *constants.RELAY_LIMITS), detail


def half_periods(signal: ArrayLike, rows: float) -> NDArray:
    """Half periods of an oscillation from zero to zero, all turned upwards.

    Parameters
    ----------
    signal : array-like of shape (n,)
        As recorded.
    rows : float
        Rows in a period.

    Returns
    -------
    shapes : ndarray of shape (h, POINTS)
        Signal less its drift, at even steps from one zero to the next [signal's unit]; none if there are no
        two zeros.
    """
    centred = without_drift(signal, rows)
    smooth = low_passed(centred, _HARMONICS / rows)
    all_zeros, first = zero_crossings(smooth), zero_crossings(low_passed(centred, 1.6 / rows))
    if len(all_zeros) < 2 or len(first) < 2:
        return np.empty((0, POINTS))
    nearest = _nearest(all_zeros, first)
    zeros = np.where(np.abs(nearest - first) < _NEAR * rows, nearest, first)
    lengths = np.diff(zeros)
    counted = (lengths > _LENGTHS[0] * rows) & (lengths < _LENGTHS[1] * rows)
    begin, lengths = zeros[:-1][counted], lengths[counted]
    at = begin[:, None] + lengths[:, None] * np.linspace(0.0, 1.0, POINTS)
    shapes = np.interp(at, np.arange(len(smooth)), smooth)
    return shapes * np.sign(shapes.sum(axis=1))[:, None]


def _nearest(places: NDArray, wanted: NDArray) -> NDArray:
    """The nearest of some sorted places to each place that is wanted."""
    after = np.clip(np.searchsorted(places, wanted), 1, len(places) - 1)
    below, above = places[after - 1], places[after]
    return np.where(wanted - below < above - wanted, below, above)


def residual_squares(shapes: NDArray, dictionary: NDArray) -> NDArray:
    """Residual sum of squares of each half period by the best shape of a dictionary, its size free.

    Parameters
    ----------
    shapes : ndarray of shape (h, POINTS)
        [signal's unit]
    dictionary : ndarray of shape (m, POINTS)

    Returns
    -------
    squares : ndarray of shape (h,)
        [signal's unit squared]
    """
    unit = dictionary / np.linalg.norm(dictionary, axis=1, keepdims=True)
    size = np.maximum(shapes @ unit.T, 0.0).max(axis=1)
    return np.maximum((shapes**2).sum(axis=1) - size**2, 0.0)


def sines() -> NDArray:
    """Half a sine, shape (1, POINTS)."""
    return np.sin(np.pi * np.linspace(0.0, 1.0, POINTS))[None]


def triangles() -> NDArray:
    """Triangles with their peak at every place between a tenth and nine tenths, shape (m, POINTS)."""
    at = np.linspace(0.0, 1.0, POINTS)
    peaks = np.linspace(0.1, 0.9, 33)[:, None]
    return np.minimum(at / peaks, (1.0 - at) / (1.0 - peaks))


def relays(lags: NDArray) -> NDArray:
    """Half periods of a first-order lag behind a relay with dead time, from zero to zero.

    The value rises as ``1 - exp(-t / lag)`` to the switch, then falls to zero as
    ``(1 + peak) exp(-t / lag) - 1``; the switch lies where both take the whole half period.

    Parameters
    ----------
    lags : ndarray of shape (m,)
        Lag [half periods].

    Returns
    -------
    shapes : ndarray of shape (m, POINTS)
    """
    at = np.linspace(0.0, 1.0, POINTS)
    out = np.empty((len(lags), POINTS))
    for place, lag in enumerate(lags):
        switch = brentq(lambda s, lag=lag: s + lag * np.log(2.0 - np.exp(-s / lag)) - 1.0, 0.0, 1.0)
        peak = 1.0 - np.exp(-switch / lag)
        falling = (1.0 + peak) * np.exp(-np.maximum(at - switch, 0.0) / lag) - 1.0
        out[place] = np.where(at <= switch, 1.0 - np.exp(-at / lag), falling)
    return out


_RELAYS = relays(_LAGS)
