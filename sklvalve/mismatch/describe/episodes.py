# SPDX-License-Identifier: BSD-3-Clause
"""When something acts: throughout, from an onset on, growing, or in spells, each time with its interval."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import chi2

from sklvalve.mismatch.constants import SHARE_WRONG_BY_ONE_NOISE
from sklvalve.mismatch.inference.hypothesis import SWITCH_PENALTY
from sklvalve.mismatch.inference.posterior import temperature
from sklvalve.simulation.robust import robust_cost, robust_weights

if TYPE_CHECKING:
    from sklvalve.simulation.fitting import PlainNoise
    from sklvalve.simulation.noise import NoiseModel
    from sklvalve.simulation.noise_of_pieces import NoiseOfPieces

    Noise = NoiseModel | NoiseOfPieces | PlainNoise
    Range = tuple[int, int] | None

_BLOCKS, _FEWEST_ROWS = 64, 10
_MOST_TURNS = 12
# of the largest excess of a random walk that falls to both sides of an instant of change (Siegmund,
# International Statistical Review 56 (1988) 31): (1 - exp(-x/2))^2 = 0.95
_WITHIN_95 = -2.0 * np.log(1.0 - np.sqrt(0.95))
_SMOOTH_95 = float(chi2.ppf(0.95, 1))
_GRID = 60
# how much smaller or larger than fitted a change may be where it acts in other rows, share of its size
_MOST_CORRECTION = 0.5


@dataclass(frozen=True, eq=False)
class TimeProfile:
    """When something acts.

    Attributes
    ----------
    kind : {"throughout", "from an onset on", "growing", "in spells"}
    episodes : list of (int, int)
        First row of each spell and the row behind its last.
    ranges : list of (pair or None, pair or None)
        For both ends of each spell the rows between which it lies with 95 %; None where the end is that of
        the recording.
    sizes : tuple of float
        Of what grows: how many times as fast as it was fitted it grows, at least and at most, where it began
        at any row of that range.
    """

    kind: str
    episodes: list[tuple[int, int]]
    ranges: list[tuple[Range, Range]]
    sizes: tuple[float, float] = (1.0, 1.0)

    def acts(self, n: int) -> np.ndarray:
        """Of n rows those in which it acts, as booleans."""
        rows = np.zeros(n, dtype=bool)
        for begin, end in self.episodes:
            rows[begin:end] = True
        return rows


@dataclass(frozen=True, eq=False)
class Evidence:
    """What a recording says of a change of the simulation, row by row.

    Parameters
    ----------
    noise : dict
        Channel -> `NoiseModel`.
    before, after : dict
        Channel -> residual without the change and with it throughout, ndarray of shape (n,), NaN in gaps.
    settled : dict
        Channel -> residual of the hypothesis as it was fitted, which tells what rows are outliers.
    slopes : ndarray of shape (n_channels * n + n_priors, n_parameters), default=None
        Derivatives of the whitened residuals, and of the distances from the priors, with regard to the
        calibration, which answers where the change acts in other rows.

    Attributes
    ----------
    change : dict
        Channel -> what the change takes off the residual.
    without : ndarray
        Residuals without the change, whitened, weighed, less what the calibration can answer.
    """

    noise: dict[str, Noise]
    before: dict[str, np.ndarray]
    after: dict[str, np.ndarray]
    settled: dict[str, np.ndarray]
    slopes: np.ndarray | None = None
    change: dict[str, np.ndarray] = field(init=False, repr=False)
    without: np.ndarray = field(init=False, repr=False)
    _weights: np.ndarray = field(init=False, repr=False)
    _basis: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        slopes = np.zeros((len(self.before) * self.n, 0)) if self.slopes is None else self.slopes
        weights = np.ones(len(slopes))
        settled = self.whitened(self.settled)
        weights[: len(settled)] = np.sqrt(robust_weights(settled))
        object.__setattr__(self, "_weights", weights)
        object.__setattr__(self, "_basis", np.linalg.qr(slopes * weights[:, None])[0])
        object.__setattr__(self, "change", {c: b - self.after[c] for c, b in self.before.items()})
        object.__setattr__(self, "without", self.free(self.whitened(self.before)))

    @property
    def n(self) -> int:
        """Number of rows."""
        return len(next(iter(self.before.values())))

    def whitened(self, left: dict[str, np.ndarray]) -> np.ndarray:
        """Whitened residuals, channel after channel."""
        return np.concatenate([self.noise[c].whiten(left[c]) for c in self.before])

    def free(self, whitened: np.ndarray) -> np.ndarray:
        """Whitened and weighed residuals, one or several columns, less what the calibration can answer."""
        moved = np.zeros((len(self._weights), *whitened.shape[1:]))
        moved[: len(whitened)] = whitened
        moved *= self._weights.reshape(-1, *(1,) * (whitened.ndim - 1))
        return moved - self._basis @ (self._basis.T @ moved)

    def cost(self, acts: np.ndarray) -> float:
        """Robust cost where the change acts in some rows only, the calibration and its size in answer."""
        # what acts in some rows is taken off all that is left: filter and projection are linear
        acting = self.free(
            self.whitened({c: np.where(acts, gap, 0.0 * gap) for c, gap in self.change.items()})
        )
        left = self.without - acting
        size = float(acting @ left) / max(float(acting @ acting), 1e-300)
        return robust_cost(
            (left - np.clip(size, -_MOST_CORRECTION, _MOST_CORRECTION) * acting) / self._weights
        )

    def quadratic(self, starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Curvature and pull of the cost in the strength that the change has in each block of rows."""
        columns, place = [], np.arange(self.n)
        for low, high in zip(starts, np.append(starts[1:], self.n), strict=True):
            inside = (place >= low) & (place < high)
            # a gap stays one
            columns.append(self.whitened({c: gap * inside for c, gap in self.change.items()}))
        moved = self.free(np.stack(columns, axis=1))
        return moved.T @ moved, moved.T @ self.without


def time_profile_of(evidence: Evidence, acts: np.ndarray, *, late: int = 0) -> TimeProfile:
    """When a change acts that the search has acting in some rows.

    Parameters
    ----------
    evidence : Evidence
    acts : ndarray of bool, shape (n,)
        Rows in which the hypothesis has it.
    late : int, default=0
        Rows by which an instant may show later than it was.

    Returns
    -------
    time_profile : TimeProfile

    Notes
    -----
    The rows are cut into blocks, at the search's own times too, and the strength in each, nought or all, is
    chosen by the quadratic of the cost, a change of it at a price; then each instant moves to where the exact
    cost is least. The quadratic may mistake a large change: where the cost itself does not bear these times
    out the search's own stay. An interval holds all instants within the distance that the largest of two
    random walks keeps with 95 %. A simulation is never true: the price and the distance are raised as
    distances between explanations are.
    """
    n = evidence.n
    searched = (np.flatnonzero(np.diff(acts)) + 1).tolist()
    even = np.linspace(0, n, min(_BLOCKS, n // _FEWEST_ROWS), endpoint=False).astype(int)
    starts = np.union1d(even, searched).astype(int)
    gain = max(evidence.cost(np.zeros(n, dtype=bool)) - evidence.cost(acts), 0.0)
    raised = temperature(gain, SHARE_WRONG_BY_ONE_NOISE)
    blocks = acts[starts]
    complexity_penalty = SWITCH_PENALTY * raised
    square, pull = evidence.quadratic(starts)
    path = _switched(square, pull, blocks, complexity_penalty)
    if np.any(path != blocks):
        moved = _settled(evidence, _edges(path, starts), bool(path[0]), raised, late, moved=True)
        instead = moved.acts(n)
        switches = int(np.sum(np.diff(instead)))
        if evidence.cost(acts) - evidence.cost(instead) > complexity_penalty * (switches - len(searched)):
            return moved
    return _settled(evidence, searched, bool(acts[0]), raised, late, moved=False)


def _switched(
    square: np.ndarray, pull: np.ndarray, blocks: np.ndarray, complexity_penalty: float
) -> np.ndarray:
    """Blocks in which a change acts: stretches are turned over as long as each earns its price."""
    many = len(blocks)
    low, high = np.triu_indices(many)
    place = np.arange(many)
    masks = ((place >= low[:, None]) & (place <= high[:, None])).astype(float)
    acts = blocks.astype(float)
    for _ in range(_MOST_TURNS):
        turned = masks * (1.0 - 2.0 * acts)
        change = 0.5 * np.einsum("ij,ij->i", turned @ square, turned) + turned @ (square @ acts - pull)
        after = np.abs(acts + turned)
        added = np.abs(np.diff(after, axis=1)).sum(axis=1) - np.abs(np.diff(acts)).sum()
        score = change + complexity_penalty * np.maximum(added, 1.0)
        best = int(np.argmin(np.where(after.any(axis=1), score, np.inf)))
        if score[best] >= 0.0:
            break
        acts = after[best]
    return acts > 0.5


def _edges(path: np.ndarray, starts: np.ndarray) -> list[int]:
    return [int(starts[k]) for k in np.flatnonzero(np.diff(path.astype(int))) + 1]


def _settled(
    evidence: Evidence, edges: list[int], begins: bool, raised: float, late: int, *, moved: bool
) -> TimeProfile:
    """Every instant where the cost is least, with its interval, and the spells between them."""
    n = evidence.n
    ranges: list[Range] = []
    for _ in range(2 if moved and len(edges) > 1 else 1):
        ranges = []
        for i in range(len(edges)):
            low = edges[i - 1] + 1 if i else 1
            high = edges[i + 1] if i + 1 < len(edges) else n
            best, within = _likeliest_row(evidence, edges, begins, i, (low, high), raised)
            # where the search itself fitted these times, they are those of the simulation
            edges[i] = best if moved else edges[i]
            ranges.append((max(min(within[0], edges[i]) - late, 0), max(within[1], edges[i])))
    return _profile(edges, ranges, begins, n)


def _profile(edges: list[int], ranges: list[Range], begins: bool, n: int) -> TimeProfile:
    """The spells between some switchings, the interval of each beside them."""
    marks = ([0] if begins else []) + edges
    known = ([None] if begins else []) + ranges
    if len(marks) % 2:
        marks, known = [*marks, n], [*known, None]
    episodes = list(zip(marks[::2], marks[1::2], strict=True))
    if len(episodes) == 1 and episodes[0][1] == n:
        kind = "throughout" if begins else "from an onset on"
    else:
        kind = "in spells"
    return TimeProfile(kind, episodes, list(zip(known[::2], known[1::2], strict=True)))


def _likeliest_row(
    evidence: Evidence, edges: list[int], begins: bool, i: int, between: tuple[int, int], raised: float
) -> tuple[int, tuple[int, int]]:
    """Likeliest row of one switching, and the rows within reach of it, the others held."""
    costs: dict[int, float] = {}

    low, high = between
    for _ in range(4):
        grid = np.unique(np.linspace(low, high - 1, min(_GRID, high - low)).astype(int)).tolist()
        for row in {*grid, edges[i]}:
            if row not in costs:
                costs[row] = evidence.cost(_acting(evidence.n, [*edges[:i], row, *edges[i + 1 :]], begins))
        least = min(costs.values())
        within = [row for row, cost in costs.items() if 2.0 * (cost - least) <= _WITHIN_95 * raised]
        step = max(int(np.ceil((high - low) / _GRID)), 1)
        low, high = max(between[0], min(within) - step), min(between[1], max(within) + step + 1)
        if step == 1:
            break
    return min(costs, key=costs.__getitem__), (min(within), max(within))


def _acting(n: int, edges: list[int], begins: bool) -> np.ndarray:
    marks = np.zeros(n + 1, dtype=int)
    for edge in edges:
        marks[edge] ^= 1
    return (np.cumsum(marks[:n]) + int(begins)) % 2 == 1


def growing_time_profile(
    evidence: Evidence, clock: np.ndarray, acts: np.ndarray, candidates: Iterable[float]
) -> TimeProfile:
    """When a change began that grows.

    Parameters
    ----------
    evidence : Evidence
        Its change is one that grew from the first row on.
    clock : ndarray of shape (n,)
        Time of each row [s], gaps between joined recordings among it.
    acts : ndarray of bool, shape (n,)
        Rows in which the hypothesis has it grow.
    candidates : sequence of float
        Rows to be compared, cut to whole numbers.

    Returns
    -------
    time_profile : TimeProfile
    """
    n, begin = evidence.n, int(np.argmax(acts))
    since = clock - clock[0]
    target = evidence.without
    gains: list[float] = []
    sizes: list[float] = []
    places = sorted({int(k) for k in candidates} | {begin})
    for k in places:
        share = np.maximum(since - since[k], 0.0) / np.where(since > 0.0, since, 1.0)
        grown = {c: share * gap for c, gap in evidence.change.items()}
        ramp = evidence.free(evidence.whitened(grown))
        sizes.append(float(ramp @ target) / max(float(ramp @ ramp), 1e-12))
        gains.append(0.5 * float(ramp @ target) * sizes[-1])
    raised = temperature(max(gains), SHARE_WRONG_BY_ONE_NOISE)
    reach = [2.0 * (max(gains) - g) <= _SMOOTH_95 * raised for g in gains]
    within = [k for k, near in zip(places, reach, strict=True) if near]
    likely = [size for size, near in zip(sizes, reach, strict=True) if near]
    ends = (min(*within, begin), max(*within, begin))
    return TimeProfile("growing", [(begin, n)], [(ends, None)], (min(likely), max(likely)))
