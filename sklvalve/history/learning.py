# SPDX-License-Identifier: BSD-3-Clause
"""The simulation of a valve calibrated on its history, and what each window of it says of that."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from sklvalve.history.moving import moved_by
from sklvalve.history.posterior import Information
from sklvalve.recording import Recording, join_recordings
from sklvalve.simulation.calibration import calibration_parameters, channels_of, sound_play, spans_of
from sklvalve.simulation.chain import Chain
from sklvalve.simulation.first_values import first_values
from sklvalve.simulation.fitting import Misfit, first_noise, fit_chain, residual_of, simulate_channels
from sklvalve.simulation.noise import TIMING, NoiseParts, sizes_of_noise
from sklvalve.simulation.noise_of_pieces import noise_of
from sklvalve.simulation.parameters import Parameter
from sklvalve.simulation.robust import normal_equations, robust_weights
from sklvalve.simulation.tolerance import Tolerance

#: A window of a history has about so many rows, and a calibration is made on at most so many.
WINDOW, CALIBRATED_ON = 1_800, 14_400
# rows whose derivatives are held at a time
_AT_ONCE = 86_400


@dataclass(frozen=True, eq=False)
class Window:
    """What some rows of a history say.

    Parameters
    ----------
    begins : float or str
        Time of the first row as it was recorded.
    rows : int
    seconds : float
    information : tuple of Information
        Of each group of channels that share parameters.
    left : dict of str to float
        Channel -> rms of what the calibrated simulation leaves over [SI].
    noise : dict of str to NoiseParts
        Channel -> noise of the recording that the window is of.
    """

    begins: Any
    rows: int
    seconds: float
    information: tuple[Information, ...]
    left: dict[str, float]
    noise: dict[str, NoiseParts]


@dataclass(frozen=True, eq=False)
class Group:
    """Channels that share parameters, and these.

    Parameters
    ----------
    channels : tuple of str
    parameters : tuple of Parameter
    """

    channels: tuple[str, ...]
    parameters: tuple[Parameter, ...]


def groups_of(chain: Chain, tolerance: Tolerance) -> tuple[Group, ...]:
    """Channels of a recording in groups that share no parameter.

    Parameters
    ----------
    chain : Chain
        With the effects that the valve is known to have.
    tolerance : Tolerance
    """
    channels = channels_of(chain.recording)
    brought = [q.parameter_of(e.key) for e in chain.effects for q in e.quantities(chain)]
    joined = "opening" not in chain.recording or bool(brought)
    each = [channels] if joined else [(c,) for c in sorted(channels)]
    return tuple(
        Group(
            c,
            (
                *calibration_parameters(chain, tolerance, c),
                *sound_play(chain.recording, tolerance, c),
                *brought,
            ),
        )
        for c in each
    )


def sampled(recordings: Sequence[Recording]) -> Recording:
    """Recordings in one, of many rows windows spread evenly over them."""
    many = sum(len(r) for r in recordings)
    if many <= CALIBRATED_ON:
        return join_recordings(recordings)
    keep = CALIBRATED_ON // WINDOW
    spans = [(r, low, low + WINDOW) for r in recordings for low in range(0, len(r) - WINDOW + 1, WINDOW)]
    spans = spans or [(r, 0, len(r)) for r in recordings]
    chosen = np.unique(np.linspace(0, len(spans) - 1, keep).round().astype(int))
    return join_recordings([spans[i][0].slice(spans[i][1], spans[i][2]) for i in chosen])


def calibrated_on(
    chain: Chain, groups: Sequence[Group], tolerance: Tolerance, start: dict[str, float] | None = None
) -> dict[str, float]:
    """Values of a simulation that has nothing missing.

    Parameters
    ----------
    chain : Chain
    groups : sequence of Group
    tolerance : Tolerance
    start : dict, default=None
        Values to begin with; searched for unless given.

    Returns
    -------
    values : dict
    """
    channels = [c for g in groups for c in g.channels]
    if start is None:
        stem = next((g.parameters for g in groups if g.channels == ("opening",)), ())
        start, _ = first_values(chain, stem, flow="flow" in channels)
    values = dict(start)
    noise: dict[str, Any] = first_noise(spans_of(chain.recording, channels))
    for k in range(3):
        if k:
            left = simulate_channels(chain, values, channels)
            noise = noise_left(chain, left, tolerance, cautious=True)
        for group in groups:
            values |= fit_chain(chain, group.parameters, group.channels, noise, start=values).values
    return values


def noise_left(
    chain: Chain, predictions: dict[str, np.ndarray], tolerance: Tolerance, *, cautious: bool = False
) -> dict[str, Any]:
    """Noise that a simulation leaves over of a recording, channel by channel.

    Of a calibration that is not over yet it is asked cautiously: a wander takes up whatever that misses, and
    what is calibrated by it misses more. What is left in the end is the healthy valve's, however large.
    """
    spans, made = spans_of(chain.recording, predictions), {}
    for c, simulated in predictions.items():
        sizes = sizes_of_noise(tolerance.counts(c) * spans[c]) | {"timing": TIMING}
        sizes |= {} if cautious else {"largest": np.inf}
        left = residual_of(chain, predictions, c, None)
        made[c] = noise_of(chain.recording, left, simulated, chain.step, c, cautious=cautious, **sizes)
    return made


def windows_of(
    chain: Chain, groups: Sequence[Group], values: dict[str, float], tolerance: Tolerance
) -> Iterator[Window]:
    """What every window of one recording says of a calibration.

    Parameters
    ----------
    chain : Chain
        Bound to the recording.
    groups : sequence of Group
    values : dict
        The calibration about which is asked.
    tolerance : Tolerance

    Yields
    ------
    window : Window
    """
    n = len(chain.time)
    predictions = simulate_channels(chain, values, [c for g in groups for c in g.channels])
    noise = noise_left(chain, predictions, tolerance)
    linearised = [_linearised(chain, g, values, noise) for g in groups]
    many = max(1, round(n / WINDOW))
    edges = np.linspace(0, n, many + 1).astype(int)
    left = {c: residual_of(chain, predictions, c, None) for c in predictions}
    for low, high in pairwise(edges):
        rows = slice(low, high)
        yield Window(
            begins=chain.recording.stamps[low],
            rows=int(high - low),
            seconds=float(chain.time[high - 1] - chain.time[low]),
            information=tuple(_information(*each, rows) for each in linearised),
            left={c: _rms(left[c][rows]) for c in left},
            noise={c: parts_of(noise[c]) for c in predictions},
        )


def pieces_of(recording: Recording) -> Iterator[Recording]:
    """A recording in parts of which one at a time is held in memory with all its derivatives."""
    many = max(1, int(np.ceil(len(recording) / _AT_ONCE)))
    edges = np.linspace(0, len(recording), many + 1).astype(int)
    for low, high in pairwise(edges):
        yield recording.slice(int(low), int(high))


def parts_of(noise: Any) -> NoiseParts:
    """What the noise of a recording is made of; of several the longest one's."""
    model = noise.longest[1] if hasattr(noise, "longest") else noise
    return model.parts


def _linearised(
    chain: Chain, group: Group, values: dict[str, float], noise: dict[str, Any]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whitened errors of a group's channels (c, n), and what scaled parameters make of them (m, c, n).

    The derivatives of the errors, and the changes of the signals as `moved_by` has them. Distances from what
    the sheet expects are no part of what the rows say.
    """
    misfit = Misfit(chain, group.parameters, group.channels, noise, fixed=values)
    z = misfit.vector.pack(values)
    here = misfit.predictions(z)
    errors = misfit.whitened(here)
    slopes = [
        scale / reach * (misfit.whitened(misfit.predictions(beside)) - errors)
        for beside, reach, scale in zip(*misfit.neighbours(z), misfit.vector.scale, strict=True)
    ]
    shape = len(group.channels), len(chain.time)
    return errors.reshape(shape), np.reshape(slopes, (-1, *shape)), moved_by(misfit, z, here)


def _information(errors: np.ndarray, slopes: np.ndarray, moves: np.ndarray, rows: slice) -> Information:
    """Normal equations of the rows of one window, and how the signals moved in it."""
    left, m = errors[:, rows].ravel(), len(slopes)
    part = np.ascontiguousarray(slopes[..., rows].reshape(m, -1))
    gradient, hessian = normal_equations(part, robust_weights(left), left)
    moved = moves[..., rows].reshape(m, -1)
    return Information(hessian, -gradient, moved @ moved.T / (rows.stop - rows.start))


def _rms(left: np.ndarray) -> float:
    seen = left[np.isfinite(left)]
    return float(np.sqrt(np.mean(seen**2))) if len(seen) else 0.0
