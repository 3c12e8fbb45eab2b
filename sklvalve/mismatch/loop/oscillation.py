# SPDX-License-Identifier: BSD-3-Clause
"""Does a loop oscillate, how fast, and how regularly?"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.fft import irfft, next_fast_len, rfft
from scipy.stats import f as f_distribution

import sklvalve.mismatch.loop.constants as constants
from sklvalve.recording.gaps import filled

_CROSSINGS = 12  # of the autocorrelation: five periods, as Thornhill et al. count them
_FEWEST_CROSSINGS = 7  # from which the scatter of half periods is known
_GRID_RATIO = 1.03  # of the grid of frequencies
_LINE = 1.15  # half width, as a ratio, of the line whose power counts as the oscillation's
_PEAKS = 4  # strongest lines examined in each signal
_FLANK = (1.4, 1.8)  # from a line's frequency to its flanks, clear of the second harmonic


@dataclass(frozen=True)
class Oscillation:
    """The strongest regular oscillation of a loop, or the strongest line if none is regular.

    Parameters
    ----------
    period : float or None
        [s]; None where the record shows no line at all.
    rows : float or None
        Rows in a period.
    regularity : float
        r of Thornhill, Huang and Zhang; above 1 the half periods scatter by less than a third of their mean.
    regular : bool
        Whether it is an oscillation: r above 1, and a band-passed autocorrelation that stays high.
    share : float
        Share of the signal's variance, without a linear trend, in a band of 15 % either side of the line.
    signal : {"command", "value", "error"}
        Where it was found.
    cycles : float
        Periods in the record.
    """

    period: float | None
    rows: float | None
    regularity: float
    regular: bool
    share: float
    signal: str
    cycles: float


def find_oscillation(
    command: ArrayLike, value: ArrayLike, sample_time: float, setpoint: ArrayLike | None = None
) -> Oscillation:
    r"""Find the strongest regular oscillation of a loop in its command and its value.

    .. math:: r = \frac{1}{3} \frac{\bar T}{\sigma_T} > 1

    with the mean and the standard deviation of the intervals between zero crossings of the autocorrelation.
    The autocorrelation is band-passed around each of the strongest lines of the spectrum, from half to one
    and a half times its frequency, so that each of several oscillations is judged alone. Noise through such a
    filter has nearly regular crossings too. The autocorrelation must therefore also stay high over one to
    three periods. The line must hold a tenth of the variance and stand out from the spectrum either side of
    it (an F test at 0.001, the noise of any colour).

    Valid for periods of three rows or more of which the record holds at least four, evenly sampled.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit; rows that are not finite are interpolated.
    sample_time : float
        Between rows [s].
    setpoint : array-like of shape (n,), optional
        Of the value's unit; where it is given, the error takes the place of the value.

    Returns
    -------
    oscillation : Oscillation

    References
    ----------
    N. F. Thornhill, B. Huang, H. Zhang, Detection of multiple oscillations in control loops, Journal of
    Process Control 13 (2003) 91-100, doi 10.1016/S0959-1524(02)00007-0.

    Examples
    --------
    >>> import numpy as np
    >>> from sklvalve.mismatch.loop.oscillation import find_oscillation
    >>> time = 2.0 * np.arange(600)
    >>> found = find_oscillation(np.sin(time / 10.0), np.cos(time / 10.0), 2.0)
    >>> found.regular, round(found.period)
    (True, 63)
    """
    signals = {"command": filled(command)}
    if setpoint is None:
        signals["value"] = filled(value)
    else:
        signals["error"] = filled(setpoint) - filled(value)
    lines = [line for name, signal in signals.items() for line in _lines(name, signal, sample_time)]
    if not lines:
        return Oscillation(None, None, 0.0, False, 0.0, "value" if setpoint is None else "error", 0.0)
    return max(lines, key=lambda line: (line.regular, line.share))


def without_trend(signal: NDArray) -> NDArray:
    """Signal less its mean and its linear trend."""
    rows = np.arange(len(signal)) - 0.5 * (len(signal) - 1)
    centred = signal - signal.mean()
    return centred - rows * (rows @ centred) / max(rows @ rows, 1.0)


def swing_spectrum(signal: NDArray) -> NDArray:
    """Power of a signal less its quadratic trend, under a Hann window, by cycles in the record."""
    n = len(signal)
    time = np.arange(n) / n
    swings = signal - np.polyval(np.polyfit(time, signal, 2), time)
    return np.abs(np.fft.rfft(swings * np.hanning(n))) ** 2


def zero_crossings(signal: NDArray) -> NDArray:
    """Places [rows] where a signal changes its sign, on a straight line between two rows."""
    positive = signal > 0.0
    before = np.flatnonzero(positive[1:] != positive[:-1])
    return before + signal[before] / (signal[before] - signal[before + 1])


@dataclass(frozen=True, eq=False)
class _Spectrum:
    """Power of a signal of `count` rows, padded with zeros to `padded` rows, and its sum up to each bin."""

    power: NDArray
    cumulative: NDArray
    count: int
    padded: int

    def between(self, first: ArrayLike, last: ArrayLike) -> Any:
        """Power between places of the spectrum [bins], ends in parts of a bin."""
        places = np.arange(len(self.cumulative))
        low, high = (np.interp(np.asarray(place) + 0.5, places, self.cumulative) for place in (first, last))
        return high - low


def _spectrum_of(signal: NDArray) -> _Spectrum:
    """Spectrum of a signal, fine enough for its autocorrelation."""
    padded = next_fast_len(2 * len(signal), real=True)
    power = np.abs(rfft(signal, padded)) ** 2
    return _Spectrum(power, np.concatenate([[0.0], np.cumsum(power)]), len(signal), padded)


def _lines(name: str, signal: NDArray, sample_time: float) -> list[Oscillation]:
    """The strongest lines of one signal's spectrum, each with its regularity."""
    count = len(signal)
    centred = without_trend(signal)
    too_short = count < constants.FEWEST_CYCLES * constants.SHORTEST_PERIOD
    if too_short or np.ptp(centred) <= 1e-9 * max(np.abs(signal).max(), 1e-300):
        return []
    spectrum = _spectrum_of(centred)
    lowest, highest = constants.FEWEST_CYCLES / count, 1.0 / constants.SHORTEST_PERIOD
    grid = np.geomspace(lowest, highest, max(8, int(np.log(highest / lowest) / np.log(_GRID_RATIO))))
    held = spectrum.between(grid / _LINE * spectrum.padded, grid * _LINE * spectrum.padded)
    inner = np.flatnonzero((held[1:-1] >= held[:-2]) & (held[1:-1] > held[2:])) + 1
    strongest = inner[np.argsort(-held[inner], kind="stable")[:_PEAKS]]
    lines = [_line(name, spectrum, grid[place], sample_time) for place in strongest]
    return [line for line in lines if line is not None]


def _stands_out(spectrum: _Spectrum, frequency: float) -> bool:
    """Whether a line is stronger than the spectrum either side of it, as noise of any colour has it."""
    near, far = _FLANK
    edges = ((1.0 / _LINE, _LINE), (1.0 / far, 1.0 / near), (near, min(far, 0.5 / frequency)))
    widths = [max(high - low, 0.0) * frequency for low, high in edges]
    powers = [
        spectrum.between(low * frequency * spectrum.padded, high * frequency * spectrum.padded)
        for low, high in edges
    ]
    line, *flanks = [power / max(width, 1e-12) for power, width in zip(powers, widths, strict=True)]
    if widths[2] < 0.1 * frequency:
        flanks[1] = flanks[0]
    ratio = line / max(np.sqrt(flanks[0] * flanks[1]), 1e-300)
    freedom = 2.0 * spectrum.count * widths[0], 2.0 * spectrum.count * (widths[1] + widths[2])
    return bool(f_distribution.sf(ratio, *freedom) < constants.LINE_TEST_LEVEL)


def _autocorrelation_near(spectrum: _Spectrum, frequency: float) -> NDArray:
    """Autocorrelation of what lies around a frequency, by lag [rows]."""
    bins = np.arange(len(spectrum.power)) / spectrum.padded
    kept = np.where((bins > 0.5 * frequency) & (bins < 1.5 * frequency), spectrum.power, 0.0)
    correlation = irfft(kept, spectrum.padded)[: int(0.85 * spectrum.count)]
    return correlation / correlation[0] / (1.0 - np.arange(len(correlation)) / spectrum.count)


def _line(name: str, spectrum: _Spectrum, frequency: float, sample_time: float) -> Oscillation | None:
    """One line, from the autocorrelation of what lies around it; None with too few crossings."""
    correlation = _autocorrelation_near(spectrum, frequency)
    crossings = zero_crossings(correlation)[:_CROSSINGS]
    if len(crossings) < _FEWEST_CROSSINGS:
        return None
    intervals = np.diff(crossings)
    rows = float(2.0 * intervals.mean())
    regularity = float(min(intervals.mean() / (3.0 * max(intervals.std(ddof=1), 1e-12)), 99.0))
    in_line = spectrum.between(spectrum.padded / (rows * _LINE), spectrum.padded * _LINE / rows)
    share = float(in_line / spectrum.cumulative[-1])
    # how alike the signal is to itself some periods on: narrow noise forgets, an oscillation does not
    cycles = np.arange(2, min(len(intervals), 6), 2)
    tops = np.interp(rows * cycles / 2.0, np.arange(len(correlation)), correlation)
    regular = (
        regularity > constants.REGULARITY_LIMIT
        and float(tops.mean()) > constants.LEAST_AUTOCORRELATION
        and share > constants.LEAST_VARIANCE_SHARE
        and _stands_out(spectrum, 1.0 / rows)
    )
    period = float(rows * sample_time)
    return Oscillation(period, rows, regularity, regular, share, name, float(spectrum.count / rows))
