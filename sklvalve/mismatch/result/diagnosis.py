# SPDX-License-Identifier: BSD-3-Clause
"""The result of a diagnosis: plain numbers and texts, and the traces that pictures are drawn from."""

from __future__ import annotations

import json
import os
from dataclasses import fields
from html import escape
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from sklvalve._telling import BEGINS, UNKNOWN, changed_before, lacking, no_sign, since_history, untested
from sklvalve.mismatch.decide.compare import Row
from sklvalve.mismatch.result.diagnosis_file import read_diagnosis, write_diagnosis

if TYPE_CHECKING:
    from pandas import DataFrame


class Diagnosis:
    """What was found in a recording; nothing changes it any more.

    Parameters
    ----------
    content : dict
        As diagnosis.json has it, schema ``sklvalve.diagnosis/1``; copied, and it must be plain data.
    traces : dict
        Arrays for pictures: ``time``, ``units``, ``recorded``, ``nominal``, ``corrected`` (by role, in the
        recording's own units), ``pressure_ratio``, ``flagged``, ``until``. Kept as they are, and no part of
        what was found.

    Examples
    --------
    >>> from sklvalve.mismatch import Diagnosis
    >>> Diagnosis({"verdict": "no_mismatch", "effects": []}).verdict
    'no_mismatch'
    """

    __slots__ = ("_text", "_traces")

    def __init__(self, content: dict[str, Any], traces: dict[str, Any] | None = None) -> None:
        self._text = json.dumps(content, default=_plain)
        self._traces = {} if traces is None else traces

    @property
    def content(self) -> dict[str, Any]:
        """Plain dict, as diagnosis.json has it; a copy, so changing it leaves the diagnosis as it is."""
        return json.loads(self._text)

    @property
    def traces(self) -> dict[str, Any]:
        """Arrays for pictures."""
        return self._traces

    @property
    def verdict(self) -> str:
        """``no_mismatch``, ``named``, ``none_of_these`` or ``cannot_tell``."""
        return self.content["verdict"]

    @property
    def effects(self) -> tuple[tuple[str, ...], ...]:
        """Names that are given, under ``cannot_tell`` candidates: a tuple a class, the likeliest first."""
        return tuple(tuple(m["name"] for m in e["members"]) for e in self.content["effects"])

    @property
    def finding(self) -> str:
        """What was found, in a sentence."""
        return _finding(self.content)

    def to_dict(self) -> dict[str, Any]:
        """Plain dict, as diagnosis.json has it; changing it leaves the diagnosis as it is."""
        return self.content

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file, with its traces; the file appears whole or not at all.

        Parameters
        ----------
        path : path-like
            Replaced where there is such a file. It is a zip archive of ``diagnosis.json``, ``traces.json``
            and arrays in the format of NumPy.

        Raises
        ------
        InputError
            If the file cannot be written, or the traces hold more than plain data and arrays.

        Examples
        --------
        >>> import pathlib, tempfile
        >>> from sklvalve.mismatch import Diagnosis
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     file = pathlib.Path(folder) / "valve.diagnosis"
        ...     Diagnosis({"verdict": "no_mismatch", "effects": []}).save(file)
        ...     Diagnosis.load(file).verdict
        'no_mismatch'
        """
        write_diagnosis(self._text, self._traces, path)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Diagnosis of a file that `save` has written; nothing in the file is executed.

        Parameters
        ----------
        path : path-like

        Returns
        -------
        diagnosis : Diagnosis

        Raises
        ------
        InputError
            If there is no such file, or it is no saved diagnosis.
        """
        return cls(*read_diagnosis(path))

    def to_frame(self) -> DataFrame:
        """Data frame, a row for each possible explanation.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        return _data_frame(self._rows(), ["finding", "effect", "probability", "parameters"])

    def comparison(self) -> DataFrame:
        """Data frame of all hypotheses that were compared, a row each, the likeliest of each place first.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        columns = [field.name for field in fields(Row)]
        return _data_frame(self.content.get("comparison") or [], columns)

    def _rows(self) -> list[tuple[int, str, float | None, str]]:
        return [
            (i + 1, each["name"], each["probability"], _spoken(entry["parameters"]) if k == 0 else "")
            for i, entry in enumerate(self.content["effects"])
            for k, each in enumerate(entry["members"])
        ]

    def __repr__(self) -> str:
        content = self.content
        p_value = (content.get("mismatch") or {}).get("p_value")
        parts = [
            content["verdict"],
            *(" or ".join(names) for names in self.effects),
            *([_p_words(p_value)] if p_value is not None else []),
        ]
        return f"<Diagnosis: {'; '.join(parts)}>"

    def _repr_html_(self) -> str:
        content = self.content
        lines = [f"<strong>{escape(_finding(content))}</strong>"]
        for label, words in (("How sure", _sureness(content)), ("What to do next", content.get("next_test"))):
            if words:
                lines.append(f"{label}: {escape(words)}")
        page = "".join(f"<p>{line}</p>" for line in lines)
        return f"<div>{page}{self._table() if content['effects'] else ''}</div>"

    def _table(self) -> str:
        head = "".join(f"<th>{h}</th>" for h in ("finding", "effect", "probability", "parameters"))
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(str(c))}</td>" for c in row) + "</tr>" for row in self._rows()
        )
        return f"<table><tr>{head}</tr>{body}</table>"


def _data_frame(rows: list, columns: list[str]) -> DataFrame:
    try:
        from pandas import DataFrame
    except ImportError:
        raise ImportError('a data frame needs pandas: pip install "sklvalve[io]"') from None
    return DataFrame(rows, columns=columns)


def _finding(content: dict[str, Any]) -> str:
    """What was found in one sentence; a layer below the report, whose words are fuller."""
    verdict = content["verdict"]
    if verdict == "named":
        new = "New since the history. " if since_history(content) else ""
        return new + _named([entry for entry in content["effects"] if _may_be_named(entry)])
    names = [_name(entry) for entry in content["effects"]]
    if verdict == "none_of_these":
        besides = f"Besides {'; '.join(names)}, something" if names else "Something"
        return f"{besides} {lacking(content)} that no known effect explains."
    return _undecided(content, names) if verdict == "cannot_tell" else _nothing_missing(content)


def _undecided(content: dict[str, Any], names: list[str]) -> str:
    if not (content.get("mismatch") or {}).get("detected", True):
        return f"This recording cannot show whether anything {lacking(content)}."
    likely = f" Most likely: {'; '.join(names)}." if names else ""
    return f"Something {lacking(content)}; the recording does not identify what.{likely}"


def _nothing_missing(content: dict[str, Any]) -> str:
    left = len(untested(content))
    besides = f"; {_counted(left)} could not be tested, see not_testable" if left else ""
    beyond_allowance = " by more than is allowed" if since_history(content) else ""
    begin = "What the history had already has changed. Nothing else" if changed_before(content) else "Nothing"
    sentence = f"{begin} relevant {lacking(content)}{beyond_allowance}{besides}."
    return " ".join([sentence, *(content.get("reasons") or [])])


def _counted(effects: int) -> str:
    return "1 effect" if effects == 1 else f"{effects} effects"


def _named(entries: list[dict[str, Any]]) -> str:
    """Faults, what the simulation lacks, and what may be either: never one for the other."""
    by_begin = {begin: [_name(e) for e in entries if e.get("kind") == kind] for kind, begin in BEGINS.items()}
    by_begin[UNKNOWN] = [_name(e) for e in entries if e.get("kind") not in BEGINS]
    return " ".join(f"{begin} {'; '.join(names)}." for begin, names in by_begin.items() if names)


def _sureness(content: dict[str, Any]) -> str:
    """How often such a name was right, how large a chance the difference has, and what holds it back."""
    parts = _sure_of_each(content["effects"]) if content["verdict"] == "named" else []
    p_value = (content.get("mismatch") or {}).get("p_value")
    if p_value is not None:
        by_chance = f"a difference as large comes by chance with {_p_words(p_value)}"
        parts.append("no sign of a fault" if no_sign(content) else by_chance)
    facts = f"{'; '.join(parts)}." if parts else ""
    reasons = [] if content["verdict"] == "no_mismatch" else content.get("reasons") or []
    # what must be mended first is both the reason and what to do
    words = " ".join([facts, *(r for r in reasons if r != content.get("next_test"))]).strip()
    return words[:1].upper() + words[1:]


def _sure_of_each(entries: list[dict[str, Any]]) -> list[str]:
    """How often a name was right, for each that may be named; which one it is where there are several."""
    named = [each for each in entries if "probability" in each and _may_be_named(each)]
    return [f"{_sure(each)}{f' of {_name(each)}' if len(named) > 1 else ''}" for each in named]


def _sure(entry: dict[str, Any]) -> str:
    if entry["probability"] is None:
        return f"{(entry.get('grade') or {}).get('level') or 'unknown'} evidence"
    return f"right in {_percent(entry['probability'])} of blind tests"


def _may_be_named(entry: dict[str, Any]) -> bool:
    return (entry.get("grade") or {}).get("level") != "weak"


def _name(entry: dict[str, Any]) -> str:
    return " or ".join(each["name"].replace("_", " ") for each in entry["members"])


def _p_words(p_value: float) -> str:
    return "p < 0.001" if p_value < 0.001 else f"p = {p_value:.3g}"


def _percent(probability: float) -> str:
    return "more than 99 %" if probability > 0.99 else f"{100.0 * probability:.0f} %"


def _spoken(parameters: dict[str, dict[str, Any]]) -> str:
    # a pure number has the unit 1, which nobody writes
    units = {name: "" if p["unit"] == "1" else p["unit"] for name, p in parameters.items()}
    return ", ".join(f"{name} {p['value']:.3g} {units[name]}".strip() for name, p in parameters.items())


def _plain(value: Any) -> Any:
    """The plain number of a NumPy scalar, which the json module does not know."""
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"a diagnosis holds plain data; got a {type(value).__name__}")
