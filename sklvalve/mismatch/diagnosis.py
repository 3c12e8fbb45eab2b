# SPDX-License-Identifier: BSD-3-Clause
"""The result of a diagnosis: plain numbers and texts, and the traces that pictures are drawn from."""

import json
from html import escape


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

    def __init__(self, content, traces=None):
        self._text = json.dumps(content)
        self._traces = {} if traces is None else traces

    @property
    def content(self):
        """Plain dict, as diagnosis.json has it; a copy, so changing it leaves the diagnosis as it is."""
        return json.loads(self._text)

    @property
    def traces(self):
        """Arrays for pictures."""
        return self._traces

    @property
    def verdict(self):
        """``no_mismatch``, ``named``, ``none_of_these`` or ``cannot_tell``."""
        return self.content["verdict"]

    @property
    def effects(self):
        """Names of the effects found, each class as a tuple, the most probable member first."""
        return tuple(tuple(m["name"] for m in e["members"]) for e in self.content["effects"])

    def to_dict(self):
        """Plain dict, as diagnosis.json has it; changing it leaves the diagnosis as it is."""
        return self.content

    def to_frame(self):
        """Data frame, a row for each possible explanation.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        try:
            from pandas import DataFrame
        except ImportError:
            raise ImportError('a data frame needs pandas: pip install "sklvalve[io]"') from None
        return DataFrame(self._rows(), columns=["finding", "effect", "probability", "parameters"])

    def _rows(self):
        return [
            (i + 1, member["name"], member["probability"], _spoken(entry["parameters"]) if k == 0 else "")
            for i, entry in enumerate(self.content["effects"])
            for k, member in enumerate(entry["members"])
        ]

    def _repr_html_(self):
        head = "".join(f"<th>{h}</th>" for h in ("finding", "effect", "probability", "parameters"))
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(str(c))}</td>" for c in row) + "</tr>" for row in self._rows()
        )
        verdict = escape(self.verdict.replace("_", " "))
        return f"<table><caption>{verdict}</caption><tr>{head}</tr>{body}</table>"


def _spoken(parameters):
    return ", ".join(f"{name} {p['value']:.3g} {p['unit']}".strip() for name, p in parameters.items())
