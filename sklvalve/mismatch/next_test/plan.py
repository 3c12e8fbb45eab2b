# SPDX-License-Identifier: BSD-3-Clause
"""A planned test: what to move, what it is expected to tell apart, and the words for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.stats import norm

from sklvalve.mismatch.constants import DISTINGUISHABLE

#: From this expected distance on a test is said to tell two explanations apart: what a record of it shows
#: then scatters about D with a deviation of 2 sqrt(D), and lies beyond 14, where a class ends, in 9 of 10.
SURE = 28.0
# a test is worth its trouble if one of two is taken for the other half as often, or less
_HALF = 0.5


@dataclass(frozen=True)
class Pair:
    """Two explanations of one recording, and how far a test is expected to set them apart.

    Attributes
    ----------
    names : (str, str)
    now : float
        Distance D by the present recording.
    if_true : (float, float)
        Distance by this and the test together, should the first of them be true, and the second.
    """

    names: tuple[str, str]
    now: float
    if_true: tuple[float, float]

    @property
    def expected(self) -> float:
        """The smaller of both distances."""
        return min(self.if_true)

    @property
    def confusion(self) -> float:
        """Chance that after the test one is taken for the other, Phi(-sqrt(D)/2) [1]."""
        return confusion(self.expected)

    @property
    def separates(self) -> bool:
        """Whether the test is expected to tell them apart, with what chance leaves of it in hand."""
        return self.expected >= SURE


@dataclass(frozen=True, eq=False)
class TestPlan:
    """The program of the command that tells most of what a recording leaves open.

    Attributes
    ----------
    name : str
        Kind of program.
    sentence : str
        What to do, and what comes of it.
    time : ndarray of shape (n,)
        [s], from the beginning of the test.
    command : ndarray of shape (n,)
        Opening to ask for [1].
    moved : dict
        Pressure role -> how far to move it [Pa].
    sensor : str or None
        A signal to be recorded besides.
    pairs : tuple of Pair
        Expected distances of the explanations; empty where only one is left and its size is to be learnt.
    considered : dict
        Kind of program -> least expected distance of the pairs that some program tells apart; of all pairs
        where none does.
    details : str
        The distances in a sentence for a specialist; empty where only one explanation is left.
    """

    # no test of a test suite, whatever its name looks like
    __test__ = False

    name: str
    sentence: str
    time: np.ndarray
    command: np.ndarray
    moved: dict[str, np.ndarray] = field(default_factory=dict)
    sensor: str | None = None
    pairs: tuple[Pair, ...] = ()
    considered: dict[str, float] = field(default_factory=dict)
    details: str = ""

    @property
    def decides(self) -> bool:
        """Whether the test is expected to tell all explanations apart."""
        return all(p.separates for p in self.pairs)


def confusion(d: float) -> float:
    """Chance that of two explanations at distance D one is taken for the other [1]."""
    return float(norm.cdf(-0.5 * np.sqrt(max(d, 0.0))))


def apart(names: Sequence[str], distances: np.ndarray) -> list[list[int]]:
    """Explanations in groups: those of different groups a test is expected to tell apart.

    Parameters
    ----------
    names : sequence of str
    distances : ndarray of shape (k, k)
        The same both ways.

    Returns
    -------
    groups : list of list of int
    """
    left, groups = list(range(len(names))), []
    while left:
        group = [left.pop(0)]
        for i in group:
            near = [j for j in left if distances[i, j] < SURE]
            group += near
            left = [j for j in left if j not in near]
        groups.append(sorted(group))
    return groups


def appreciable(now: float, after: float) -> bool:
    """Whether a test takes a pair appreciably further apart.

    It sets apart what is not apart now, or halves the chance that one is taken for the other.

    Parameters
    ----------
    now, after : float
        Distances D.
    """
    if now >= DISTINGUISHABLE:
        return False
    return after >= DISTINGUISHABLE or confusion(after) <= _HALF * confusion(now)


def sentence_of(
    text: str,
    names: Sequence[str],
    now: np.ndarray,
    after: np.ndarray,
    advice: Sequence[str],
    *,
    alone: bool = False,
) -> str:
    """What to do and what comes of it, in words.

    Parameters
    ----------
    text : str
        The program's own, without a stop.
    names : sequence of str
    now, after : ndarray of shape (k, k)
        Distances, the same both ways; of one pair at least `after` is appreciably larger.
    advice : list of str
        For each of them what separates it by the catalogue, for where the program does not.
    alone : bool, default=False
        Say that no program of the command alone does as much.
    """
    k = len(names)
    # what is apart already stays so
    sure = np.where(now >= DISTINGUISHABLE, np.inf, after)
    left = [(j, i) for i in range(k) for j in range(i) if sure[i, j] < SURE]
    new = [(j, i) for i in range(k) for j in range(i) if now[i, j] < DISTINGUISHABLE and after[i, j] >= SURE]
    if not new:
        return _sentence_of_the_best_pair(text, names, now, after, left, advice[0])
    groups = apart(names, sure)
    spoken, shown, not_parted = _what_is_parted(names, groups, new, left, after)
    sentence = (
        f"{text}: this should tell {spoken}{', which moving the command alone does not' if alone else ''} "
        f"(one would be taken for the other in {_percent(after[shown])} of cases, now in "
        f"{_percent(now[shown])}).{not_parted} Diagnose the new recording together with the present one."
    )
    others = dict.fromkeys(advice[group[0]] for group in groups if len(group) > 1)
    return f"{sentence} For the others: {' '.join(others)}" if others else sentence


def _sentence_of_the_best_pair(
    text: str,
    names: Sequence[str],
    now: np.ndarray,
    after: np.ndarray,
    left: list[tuple[int, int]],
    advice: str,
) -> str:
    """Words for a program that tells no pair apart for sure."""
    best = min(left, key=lambda pair: confusion(float(after[pair])) / confusion(float(now[pair])))
    others = _pairs_listed(names, [pair for pair in left if pair != best])
    return (
        f"{text}: within the limits this distinguishes {_listed([names[i] for i in best], 'and')} best, "
        f"but one would still be taken for the other in {_percent(after[best])} of cases "
        f"({_percent(now[best])} now){f', and it does not tell {others}' if others else ''}. {advice}"
    )


def _what_is_parted(
    names: Sequence[str],
    groups: list[list[int]],
    new: list[tuple[int, int]],
    left: list[tuple[int, int]],
    after: np.ndarray,
) -> tuple[str, tuple[int, int], str]:
    """Explanations told apart, the pair whose chances are named, and words for what is not told."""
    where = {i: g for g, group in enumerate(groups) for i in group}
    across = [pair for pair in new if where[pair[0]] != where[pair[1]]]
    if across:
        spoken = " from ".join(_listed([names[i] for i in group], "or") for group in groups)
        return spoken, min(across, key=lambda pair: after[pair]), ""
    # a third explanation stands between those that are told apart
    shown = max(new, key=lambda pair: after[pair])
    return _pairs_listed(names, new, " and "), shown, f" It does not tell {_pairs_listed(names, left)}."


def distances_in_words(names: Sequence[str], now: np.ndarray, after: np.ndarray) -> str:
    """Distances D of a plan for a specialist; that of `sentence_of` has the chances that follow from them.

    Parameters
    ----------
    names : sequence of str
    now, after : ndarray of shape (k, k)
        The same both ways.

    Returns
    -------
    sentence : str
    """
    pairs = [(j, i) for i in range(len(names)) for j in range(i)]
    each = [f"{_pairs_listed(names, [pair])} {_short(now[pair])} and {_short(after[pair])}" for pair in pairs]
    return (
        f"Distance D of explanations now and with the next test: {'; '.join(each)}. Two can be "
        f"distinguished from {DISTINGUISHABLE:.0f} on; a test should promise {SURE:.0f}."
    )


def _pairs_listed(names: Sequence[str], pairs: Sequence[tuple[int, int]], joined: str = ", nor ") -> str:
    return joined.join(" from ".join(names[i].replace("_", " ") for i in pair) for pair in pairs)


def _listed(names: Sequence[str], joined: str) -> str:
    names = [name.replace("_", " ") for name in names]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} {joined} {names[-1]}"


def _short(d: float) -> str:
    if d < 0.05:
        return "0"
    return f"{d:.0f}" if d >= 9.5 else f"{d:.2g}"


def _percent(d: float) -> str:
    share = 100.0 * confusion(d)
    return "less than 0.1 %" if share < 0.1 else f"{share:.2g} %"
