# SPDX-License-Identifier: BSD-3-Clause
"""Does a loop oscillate, how fast, and how regularly?"""

from dataclasses import asdict, dataclass

import numpy as np
from scipy.fft import irfft, next_fast_len, rfft
from scipy.stats import f as f_distribution

FEWEST_CYCLES = 4.0  # fewer in a record are no oscillation that could be told from drift
SHORTEST = 3.0  # rows in a period; below it the samples no longer show the wave
_CROSSINGS = 11  # of the autocorrelation, as Thornhill et al. count them: five periods
_FEWEST_INTERVALS = 6  # half periods from which their scatter is known
_STEP = 1.03  # of the grid of frequencies
_LINE = 1.15  # half width, as a ratio, of the line whose power counts as the oscillation's
_PEAKS = 4  # strongest lines looked at in each signal
_HEIGHT = 0.25  # of the autocorrelation one to three periods on; see `_line`
_SHARE = 0.1  # of the variance; a weaker line is left to the noise
_FLANK = (1.4, 1.8)  # from a line's frequency to its flanks, clear of the second harmonic
_LEVEL = 1e-3  # of the test of a line against its flanks


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

    def to_dict(self):
        """Plain dict."""
        return asdict(self)


def filled(values):
    """Signal with rows that were not recorded interpolated; zeros where nothing was recorded."""
    values = np.asarray(values, dtype=float)
    known = np.isfinite(values)
    if known.all():
        return values
    if not known.any():
        return np.zeros(len(values))
    return np.interp(np.arange(len(values)), np.flatnonzero(known), values[known])


def find_oscillation(command, value, sample_time, setpoint=None):
    r"""Find the strongest regular oscillation of a loop in its command and its value.

    .. math:: r = \frac{1}{3} \frac{\bar T}{\sigma_T} > 1

    with the mean and the standard deviation of the intervals between zero crossings of the autocorrelation,
    band-passed around each of the strongest lines of the spectrum from half to one and a half times its
    frequency, so that of several oscillations each is judged alone. Noise through such a filter has nearly
    regular crossings too; the autocorrelation must therefore also stay high over one to three periods, and
    the line must hold a tenth of the variance and stand out from the spectrum either side of it (an F test at
    0.001, the noise of any colour).

    Valid for periods of three rows or more of which the record holds at least four, evenly sampled.

    Parameters
    ----------
    command, value : array-like of shape (n,)
        As recorded, any unit; rows that are not finite are interpolated.
    sample_time : float
        Between rows [s].
    setpoint : array-like of shape (n,), optional
        Of the value's unit; the error is looked at in place of the value where it is given.

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


def without_trend(signal):
    """Signal less its mean and its linear trend."""
    rows = np.arange(len(signal)) - 0.5 * (len(signal) - 1)
    centred = signal - signal.mean()
    return centred - rows * (rows @ centred) / max(rows @ rows, 1.0)


def _lines(name, signal, sample_time):
    """The strongest lines of one signal's spectrum, each with its regularity."""
    count = len(signal)
    centred = without_trend(signal)
    if count < FEWEST_CYCLES * SHORTEST or np.ptp(centred) <= 1e-9 * max(np.abs(signal).max(), 1e-300):
        return []
    long = next_fast_len(2 * count, real=True)
    power = np.abs(rfft(centred, long)) ** 2
    below = np.concatenate([[0.0], np.cumsum(power)])
    lowest, highest = FEWEST_CYCLES / count, 1.0 / SHORTEST
    grid = np.geomspace(lowest, highest, max(8, int(np.log(highest / lowest) / np.log(_STEP))))
    held = _between(below, grid / _LINE * long, grid * _LINE * long)
    inner = np.flatnonzero((held[1:-1] >= held[:-2]) & (held[1:-1] > held[2:])) + 1
    strongest = inner[np.argsort(-held[inner], kind="stable")[:_PEAKS]]
    found = [_line(name, power, below, grid[place], count, long, sample_time) for place in strongest]
    return [line for line in found if line is not None]


def _between(below, first, last):
    """Power between places of the spectrum, ends in parts of a bin."""
    places = np.arange(len(below))
    return np.interp(last + 0.5, places, below) - np.interp(first + 0.5, places, below)


def _stands_out(below, frequency, count, long):
    """Whether a line is stronger than the spectrum either side of it, as noise of any colour has it."""
    near, far = _FLANK
    edges = ((1.0 / _LINE, _LINE), (1.0 / far, 1.0 / near), (near, min(far, 0.5 / frequency)))
    widths = [max(high - low, 0.0) * frequency for low, high in edges]
    powers = [_between(below, low * frequency * long, high * frequency * long) for low, high in edges]
    line, *flanks = [power / max(width, 1e-12) for power, width in zip(powers, widths, strict=True)]
    if widths[2] < 0.1 * frequency:
        flanks[1] = flanks[0]
    ratio = line / max(np.sqrt(flanks[0] * flanks[1]), 1e-300)
    freedom = 2.0 * count * widths[0], 2.0 * count * (widths[1] + widths[2])
    return f_distribution.sf(ratio, *freedom) < _LEVEL


def _line(name, power, below, frequency, count, long, sample_time):
    """One line, from the autocorrelation of what lies around it."""
    bins = np.arange(len(power)) / long
    kept = np.where((bins > 0.5 * frequency) & (bins < 1.5 * frequency), power, 0.0)
    likeness = irfft(kept, long)[: int(0.85 * count)]
    likeness = likeness / likeness[0] / (1.0 - np.arange(len(likeness)) / count)
    signs = likeness > 0.0
    before = np.flatnonzero(signs[1:] != signs[:-1])[: _CROSSINGS + 1]
    if len(before) < _FEWEST_INTERVALS + 1:
        return None
    crossings = before + likeness[before] / (likeness[before] - likeness[before + 1])
    intervals = np.diff(crossings)
    rows = 2.0 * intervals.mean()
    regularity = float(min(intervals.mean() / (3.0 * max(intervals.std(ddof=1), 1e-12)), 99.0))
    share = float(_between(below, long / (rows * _LINE), long * _LINE / rows) / below[-1])
    # how alike the signal is to itself some periods on: narrow noise forgets, an oscillation does not
    cycles = np.arange(2, min(len(intervals), 6), 2)
    tops = np.interp(rows * cycles / 2.0, np.arange(len(likeness)), likeness)
    stands = _stands_out(below, 1.0 / rows, count, long)
    regular = regularity > 1.0 and float(tops.mean()) > _HEIGHT and share > _SHARE and stands
    return Oscillation(
        float(rows * sample_time), float(rows), regularity, bool(regular), share, name, float(count / rows)
    )
