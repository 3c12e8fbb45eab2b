# SPDX-License-Identifier: BSD-3-Clause
"""How late the pressures are, by how they drive the flow and answer it, in units of evidence."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sklvalve.recording._screen_lags import Sums, Values, quick, rising_curve, slow, sums_of

_MEMORY = 8  # rows over which noise is made white
_METER = 10  # rows within which a meter shows most of a change
_EARLIEST, _LATEST = -1, 3  # rows; the own lags of transmitters lie between
_NEIGHBOURS = 8  # rows; evidence this near belongs to the same place
# in log likelihood, where the best of 80 places gains 5 by chance; a model that is a little wrong gains more
_OVER_NOUGHT, _OVER_OTHERS = 5.0, 15.0


@dataclass(frozen=True)
class Late:
    """Rows by which a pressure is late (negative: early; 0: not told), and by how much evidence."""

    rows: int
    evidence: float


def pressures_late(signals: dict[str, Values], usable: NDArray[np.bool_], longest: int) -> dict[str, Late]:
    r"""How late `p1` and `p2` are beside flow and opening.

    Two ways lead from a pressure to the flow. It drives it,
    :math:`\delta F / F = \delta (p_1 - p_2) / 2 (p_1 - p_2)`, through the same meter that shows the opening's
    moves; and the flow's square, as the opening gives it, moves both pressures by the resistance of the
    lines. Either gives a gain in log likelihood at each single lag, noise made white by its own course, and
    all lags of the other signals fitted beside; both are added.
    """
    moved, flow = signals.get("opening", signals.get("command")), signals.get("flow")
    if flow is None or moved is None or not {"p1", "p2"} <= set(signals):
        return {}
    # pressures that change places say nothing of time
    if (signals["p1"] < signals["p2"]).mean() > 0.05:
        return {}
    drop = np.maximum(signals["p1"] - signals["p2"], 1e-3 * np.ptp(signals["p1"]) + 1.0)
    root, share = slow(np.sqrt(drop)), slow(flow) / (2.0 * slow(drop))
    passes = rising_curve(moved, flow / np.sqrt(drop))
    by_stem, through = root * quick(passes), quick((passes * root) ** 2)
    meter = _course(quick(flow), by_stem, usable, longest)
    moves = {"p1": quick(signals["p1"]), "p2": -quick(signals["p2"])}
    late = {}
    for role, other in (("p1", "p2"), ("p2", "p1")):
        causes = [by_stem, share * moves[other], share * moves[role]]
        drives = _evidence(quick(flow), causes, usable, longest, meter)
        answers = _evidence(-moves[role], [through], usable, longest, np.ones(1))
        late[role] = _place(drives[::-1] + answers, longest)
    return late


def _place(gain: Values, longest: int) -> Late:
    """Where the evidence is best, if it is clearly better than about nought and than anywhere else."""
    place = int(np.argmax(gain))
    about = gain[longest + _EARLIEST : longest + _LATEST + 1]
    far = gain[np.abs(np.arange(len(gain)) - place) > _NEIGHBOURS]
    best = float(gain[place])
    over_nought, over_others = best - float(about.max()), best - float(far.max(initial=0.0))
    rows = place - longest
    told = over_nought > _OVER_NOUGHT and over_others > _OVER_OTHERS and abs(rows) >= _LATEST
    return Late(rows if told else 0, min(over_nought, over_others))


def _course(answer: Values, cause: Values, usable: NDArray[np.bool_], longest: int) -> Values:
    """Shares of an answer that come in each of the first rows after its cause."""
    sums = sums_of(answer, [cause], usable, longest)
    response = sums.solved() if sums is not None else None
    if response is None:
        return np.ones(1)
    first = np.maximum(response[longest : longest + _METER], 0.0)
    return first / first.sum() if first.sum() > 0.0 else np.ones(1)


def _evidence(
    answer: Values, causes: list[Values], usable: NDArray[np.bool_], longest: int, course: Values
) -> Values:
    """Gain in log likelihood by the last cause at each lag, all lags of the others fitted beside it."""
    # SciPy at first use: what drafts a valve.toml reads recordings without it
    from scipy.signal import lfilter

    width = 2 * longest + 1
    none = np.zeros(width)
    sums = sums_of(answer, causes, usable, longest)
    response = sums.solved() if sums is not None else None
    if response is None:
        return none
    white = _whitener(_left(answer, causes, response, longest), usable)
    answer, *causes = (lfilter(white, [1.0], each) for each in (answer, *causes))
    sums = sums_of(answer, causes, usable, longest)
    if sums is None:
        return none
    try:
        normal, right, power = _beside(sums, width)
    except np.linalg.LinAlgError:
        return none
    gain = none.copy()
    for place in range(width):
        weights = none.copy()
        weights[place : place + len(course)] = course[: width - place]
        size = float(weights @ normal @ weights)
        # it can but act in its own sense
        told = max(float(weights @ right), 0.0) ** 2 / (size * power) if size > 0.0 and power > 0.0 else 0.0
        gain[place] = -0.5 * usable.sum() * np.log(max(1.0 - told, 1e-9))
    return gain


def _beside(sums: Sums, width: int) -> tuple[Values, Values, float]:
    """Normal equations of the last cause, after all that the others explain."""
    from scipy.linalg import cho_factor, cho_solve

    others = len(sums.right) - width
    normal = sums.normal + 1e-3 * np.diag(np.diag(sums.normal))
    if not others:
        return normal, sums.right, sums.power
    shared = normal[:others, others:]
    factor = cho_factor(normal[:others, :others])
    rest = normal[others:, others:] - shared.T @ cho_solve(factor, shared)
    explained = cho_solve(factor, sums.right[:others])
    return rest, sums.right[others:] - shared.T @ explained, sums.power - sums.right[:others] @ explained


def _left(answer: Values, causes: list[Values], response: Values, longest: int) -> Values:
    """What the answers to all causes leave."""
    left = answer.copy()
    for cause, course in zip(causes, np.split(response, len(causes)), strict=True):
        left -= np.convolve(cause, course)[longest : longest + len(left)]
    return left


def _whitener(noise: Values, usable: NDArray[np.bool_]) -> Values:
    """Filter that makes such noise white, by its autoregression; outliers cut."""
    from scipy.linalg import solve_toeplitz

    noise = np.where(usable, noise, 0.0)
    noise = np.clip(noise, -6.0 * noise.std(), 6.0 * noise.std())
    rows = len(noise)
    alike = np.array([noise[: rows - late] @ noise[late:] for late in range(_MEMORY + 1)])
    if alike[0] <= 0.0:
        return np.ones(1)
    alike[0] *= 1.0 + 1e-6
    return np.concatenate([[1.0], -solve_toeplitz(alike[:-1], alike[1:])])
