# SPDX-License-Identifier: BSD-3-Clause
"""Bicoherence of the error, and an ellipse around the filtered command and value (Choudhury et al.)."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.fft import irfft, rfft
from scipy.linalg import eig
from scipy.signal.windows import hann

from sklvalve.mismatch.loop.constants import BICOHERENCE_LEVEL, NGI_LIMIT, NLI_LIMIT
from sklvalve.mismatch.loop.methods.filters import control_error, low_passed, without_drift
from sklvalve.mismatch.loop.methods.result import SOUND, STICTION, UNDECIDED, Method, MethodResult
from sklvalve.mismatch.loop.oscillation import Oscillation, without_trend

_METHOD = Method(
    "bicoherence and ellipse",
    "Choudhury, Shah, Thornhill and Shook 2006, doi 10.1016/j.conengprac.2005.10.003",
    NGI_LIMIT,
    6.0,
)
_SEGMENT = 32  # rows of a segment: three periods
# rows of a period after resampling: five harmonics below half the rate, and segments that begin at all phases
# of the wave (half a segment is 1.54 periods), else a pure sine's leakage looks coupled
_ROWS = 10.4
_FEWEST_SEGMENTS = 12  # fewer, and no squared bicoherence below 1 is significant
_BAND = (0.5, 3.4)  # of the oscillation's frequency, kept of command and value for the ellipse
_LEAST = 1e-3  # of its mean, of the spectra that a bicoherence is divided by


def ellipse(
    command: ArrayLike, value: ArrayLike, oscillation: Oscillation, *, setpoint: ArrayLike | None = None
) -> MethodResult:
    r"""Test the error for a nonlinearity, and measure how wide command against value is.

    .. math::
        bic^2(f_1, f_2) = \frac{|E[X(f_1) X(f_2) X^*(f_1 + f_2)]|^2}
        {E[|X(f_1) X(f_2)|^2]\; E[|X(f_1 + f_2)|^2]}

    The non-Gaussianity index NGI is the mean of the significant squared bicoherences less their limit for
    Gaussian noise (1 % for any of the plane), or the greatest less that limit if none is. The nonlinearity
    index NLI is the greatest less mean and two standard deviations of all but the largest tenth. A loop with
    NGI > 0.001 and NLI > 0.01 is nonlinear. An ellipse is then fitted to value against command, both filtered
    to the frequencies that take part; its width along the command through the centre is the apparent
    stiction, for half axes m and n and an inclination alpha:

    .. math:: 2 m n / \sqrt{m^2 \sin^2\alpha + n^2 \cos^2\alpha}

    Valid for a loop whose valve is its only nonlinearity. The bicoherence sees quadratic coupling only: an
    oscillation whose two halves are alike has none, and a short record has a high limit.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit.
    oscillation : Oscillation
    setpoint : array-like of shape (n,), optional
        Of the value's unit; where it is given, the error takes the place of the value.

    Returns
    -------
    result : MethodResult
        `statistic` is NGI where NLI is above its limit, else the smaller of NGI and 0; `band` the apparent
        stiction where the loop is nonlinear [command's unit].

    References
    ----------
    M. A. A. S. Choudhury, S. L. Shah, N. F. Thornhill, D. S. Shook, Automatic detection and quantification of
    stiction in control valves, Control Engineering Practice 14 (2006) 1395-1412.
    """
    obstacle, rows = _METHOD.obstacle(oscillation), oscillation.rows or 0.0
    if rows < _METHOD.fewest_rows:
        return _METHOD.not_applicable(obstacle)
    resampled = _resampled(control_error(value, setpoint), rows)
    if len(resampled) < _SEGMENT * (_FEWEST_SEGMENTS + 1) // 2:
        few = f"The record holds {oscillation.cycles:.0f} periods, too few for a bicoherence."
        return _METHOD.not_applicable(few)
    ngi, nli = nonlinearity_indices(resampled)
    statistic, figures = ngi if nli > NLI_LIMIT else min(ngi, 0.0), f"(NGI {ngi:.3f}, NLI {nli:.3f})"
    if ngi <= NGI_LIMIT or nli <= NLI_LIMIT:
        return _METHOD.result(statistic, SOUND, f"The error is that of a linear loop {figures}.", obstacle)
    width = width_of_ellipse(*(_band_passed(each, rows) for each in (command, value)))
    if width is None:
        detail = f"The loop is nonlinear {figures} and no ellipse fits."
        return _METHOD.result(statistic, UNDECIDED, detail, obstacle)
    size = f"{width:.3g} of the command's unit"
    detail = f"The loop is nonlinear {figures} and the apparent stiction is {size}."
    return _METHOD.result(statistic, STICTION, detail, obstacle, width)


def _resampled(error: NDArray, rows: float) -> NDArray:
    """The error without drift, with as many rows to a period as a bicoherence asks for."""
    step = rows / _ROWS
    centred = low_passed(without_drift(error, rows), 0.45 / step)
    return np.interp(np.arange(0.0, len(centred) - 1.0, step), np.arange(len(centred)), centred)


def nonlinearity_indices(signal: NDArray) -> tuple[float, float]:
    """Non-Gaussianity and nonlinearity index of a signal.

    Parameters
    ----------
    signal : ndarray of shape (n,)
        Ten rows a period or so.

    Returns
    -------
    ngi, nli : float
    """
    begin = np.arange(0, len(signal) - _SEGMENT + 1, _SEGMENT // 2)
    segments = signal[begin[:, None] + np.arange(_SEGMENT)]
    segments = (segments - segments.mean(axis=1, keepdims=True)) * hann(_SEGMENT, sym=False)
    spectra = rfft(segments, axis=1)
    half = _SEGMENT // 2
    low, high = np.meshgrid(np.arange(1, half + 1), np.arange(1, half + 1), indexing="ij")
    domain = (low >= high) & (low + high <= half)  # the principal domain, without aliases
    low, high = low[domain], high[domain]
    pairs, both = spectra[:, low] * spectra[:, high], spectra[:, low + high]
    left, right = np.mean(np.abs(pairs) ** 2, axis=0), np.mean(np.abs(both) ** 2, axis=0)
    # without a floor a quotient of two nothings, far from the oscillation, may take any value
    squared = np.abs(np.mean(pairs * both.conj(), axis=0)) ** 2 / (
        (left + _LEAST * left.mean()) * (right + _LEAST * right.mean())
    )
    limit = np.log(len(low) / BICOHERENCE_LEVEL) / len(
        segments
    )  # chi-square with two degrees of freedom, over 2 K
    significant = squared[squared > limit]
    ngi = float((significant.mean() if len(significant) else squared.max()) - limit)
    trimmed = squared[squared <= np.quantile(squared, 0.9)]
    return ngi, float(squared.max() - (trimmed.mean() + 2.0 * trimmed.std()))


def width_of_ellipse(command: NDArray, value: NDArray) -> float | None:
    """Width along the command, through its centre, of the ellipse that fits a cloud of points best.

    Parameters
    ----------
    command, value : ndarray of shape (n,)

    Returns
    -------
    width : float or None
        [command's unit]; None where no ellipse fits.
    """
    scales = command.std(), value.std()
    if min(scales) <= 0.0:
        return None
    x, y = (command - command.mean()) / scales[0], (value - value.mean()) / scales[1]
    design = np.column_stack([x * x, x * y, y * y, x, y, np.ones(len(x))])
    # the direct fit of Fitzgibbon, Pilu and Fisher, in the stable form of Halir and Flusser
    quadratic, linear = design[:, :3], design[:, 3:]
    scatter, mixed, linear_part = quadratic.T @ quadratic, quadratic.T @ linear, linear.T @ linear
    back = -np.linalg.solve(linear_part, mixed.T)
    reduced = scatter + mixed @ back
    reduced = np.array([reduced[2] / 2.0, -reduced[1], reduced[0] / 2.0])
    vectors = np.real(eig(reduced)[1])
    good = np.flatnonzero(4.0 * vectors[0] * vectors[2] - vectors[1] ** 2 > 0.0)
    if not len(good):
        return None
    a, b, c = vectors[:, good[0]]
    d, e, f = back @ vectors[:, good[0]]
    centre = np.linalg.solve([[2.0 * a, b], [b, 2.0 * c]], [-d, -e])
    size = a * centre[0] ** 2 + b * centre[0] * centre[1] + c * centre[1] ** 2 - f
    if not size / a > 0.0:
        return None
    return float(2.0 * np.sqrt(size / a) * scales[0])


def _band_passed(signal: ArrayLike, rows: float) -> NDArray:
    """Signal in the band of the oscillation and its first harmonics, mirrored at its ends."""
    centred = without_trend(np.asarray(signal, dtype=float))
    both = np.concatenate([centred, centred[::-1]])
    spectrum = rfft(both)
    frequencies = np.arange(len(spectrum)) / len(both) * rows
    spectrum[(frequencies < _BAND[0]) | (frequencies > _BAND[1])] = 0.0
    return irfft(spectrum, len(both))[: len(centred)]
