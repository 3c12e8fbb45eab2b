# SPDX-License-Identifier: BSD-3-Clause
"""Why this explanation and not that: the hypotheses compared, and the rules that decided, in words."""

from itertools import groupby
from typing import NamedTuple

from sklvalve.report.words import number, percent, role_words, spoken

#: Heads of the table of hypotheses.
HEAD = ("explanation", "changes", "times what counts", "gain [nats]", "gain on unseen rows", "weight")
#: Heads of the table of rules.
RULES_HEAD = ("check", "passed", "outcome")
# rows shown of each difference; nothing is always among them
_SHOWN = 6
# forms of one effect are one explanation to a reader
_NOTHING = "nothing"
_RULES = {
    "data": "not made by the data",
    "rarity": "rare among healthy valves",
    "relevance": "larger than what counts",
    "held_out": "predicts rows left out of the fit, in more than one event",
    "history_noise": "explained down to the noise of the history",
    "residual": "little is left unexplained",
    "noise": "explained down to the noise",
    "forecast": "makes no forecast worse by more than chance",
    "black_box": "forecasts as well as a black box",
    "probability": "likely enough by blind tests",
}


class Compared(NamedTuple):
    """The hypotheses of one difference."""

    title: str
    rows: list[tuple[str, ...]]


def comparisons(d: dict) -> list[Compared]:
    """Tables of the hypotheses, one for each difference between simulation and recording.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.

    Returns
    -------
    tables : list of Compared
        Their rows as `HEAD` has them; empty where nothing was compared.
    """
    places = [list(rows) for _, rows in groupby(d.get("comparison") or [], key=lambda row: row["place"])]
    return [Compared(_title(rows, len(places) > 1), _rows(rows)) for rows in places]


def _title(rows: list[dict], several: bool) -> str:
    """What a place is about, where that is not plain."""
    if not rows[0].get("stands", True):
        return "Tried, and not named"
    if not several:
        return ""
    likeliest = next((row for row in rows if row["hypothesis"] != _NOTHING), None)
    return f"In the place of {spoken(likeliest['hypothesis'])}" if likeliest else ""


def _rows(rows: list[dict]) -> list[tuple[str, ...]]:
    likeliest: dict[str, dict] = {}
    for row in rows:
        likeliest.setdefault(row["hypothesis"], row)
    weights = dict.fromkeys(likeliest, 0.0)
    for row in rows:
        weights[row["hypothesis"]] += row["posterior"]
    order = sorted(likeliest, key=lambda name: -weights[name])
    shown = {_NOTHING, *[name for name in order if name != _NOTHING][: _SHOWN - 1]}
    return [_cells(likeliest[name], weights[name]) for name in order if name in shown]


def _cells(row: dict, weight: float) -> tuple[str, ...]:
    if row["hypothesis"] == _NOTHING:
        return "nothing is missing here", "", "", "0", "", _weight(weight)
    gain = "" if row["log_likelihood"] is None else number(float(f"{row['log_likelihood']:.3g}"))
    return (
        f"{spoken(row['hypothesis'])}{_when(row)}",
        role_words(row["channel"]) if row["channel"] else "",
        _multiple(row),
        gain,
        _held_out(row),
        _weight(weight),
    )


def _when(row: dict) -> str:
    return f", {row['time_profile']}" if row["time_profile"] not in ("", "throughout", "growing") else ""


def _multiple(row: dict) -> str:
    size, share, ends = row["size_over_relevance"], row["size"], row["size_ci95"]
    if not ends or not share:
        return number(size, 2)
    low, high = (size * end / share for end in ends)
    return f"{number(size, 2)} [{number(low, 2)} to {number(high, 2)}]"


def _held_out(row: dict) -> str:
    gain, error = row["held_out_gain"], row["held_out_se"]
    if gain is None:
        return ""
    return f"{number(float(f'{gain:.3g}'))} \N{PLUS-MINUS SIGN} {number(error, 2)}"


def _weight(weight: float) -> str:
    return "<0.1 %" if weight < 0.001 else ">99.9 %" if weight > 0.999 else percent(weight)


def rules(d: dict) -> list[tuple[str, str, str]]:
    """The rules that were asked, with their outcome, as `RULES_HEAD` has them."""
    return [
        (
            _RULES.get(rule["name"], rule["name"].replace("_", " ")),
            "yes" if rule["passed"] else "no",
            rule["sentence"],
        )
        for rule in d.get("rules") or []
    ]
