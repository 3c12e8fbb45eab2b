# SPDX-License-Identifier: BSD-3-Clause
"""Lines of scores, made by hand."""

import pytest


@pytest.fixture(scope="session")
def a_line():
    """Maker of lines: true names joined by "+", the verdict, and classes as strings like "a/b"."""

    def make(true="", verdict="no_mismatch", /, *classes, told=None, location=None, p=None, **truth):
        """`told`: what each class has beside its members; `location`, `p`: found; the rest is truth."""
        effects = true.split("+") if true else []
        entries = [{"members": [{"name": name} for name in names.split("/")]} for names in classes]
        for entry, more in zip(entries, told or [], strict=False):
            chances = more.pop("members", None)
            for member, chance in zip(entry["members"], chances or [], strict=False):
                member["probability"] = chance
            entry.update(more)
        found = {"verdict": verdict, "effects": entries}
        if location is not None:
            found["location"] = location
        if p is not None:
            found["mismatch"] = {"detected": verdict != "no_mismatch", "p_value": p, "alpha": 0.01}
        known = {"effects": effects, "verdict": "named" if effects else "no_mismatch", "concealed": effects}
        return {"record": "r", "found": found, "truth": known | truth}

    return make


@pytest.fixture(scope="session")
def a_failure():
    """Maker of lines of diagnoses that broke."""

    def make(true="", **truth):
        effects = true.split("+") if true else []
        known = {"effects": effects, "verdict": "named" if effects else "no_mismatch"}
        return {"record": "r", "failed": "ValueError: broke", "truth": known | truth}

    return make
