# SPDX-License-Identifier: BSD-3-Clause
"""What holds wherever a diagnosis is put into words: in notebooks, which need no report, and in reports."""

# a difference that comes by chance in as many recordings of a healthy valve is no sign of a fault
_COMMON = 0.05
#: How a sentence on an effect of each kind begins.
BEGINS = {
    "fault": "Likely fault:",
    "either": "A fault, or a property that the simulation lacks:",
    "property": "The simulation lacks",
}
#: The same of diagnoses made before the kind was known.
UNKNOWN = "Not in the simulation:"


def no_sign(content: dict) -> bool:
    """Whether nothing is missing, and a difference as large is common by chance.

    A diagnosis that leaves the matter open reassures nobody.

    Parameters
    ----------
    content : dict
        A diagnosis as diagnosis.json has it.

    Examples
    --------
    >>> no_sign({"verdict": "no_mismatch", "mismatch": {"p_value": 0.43, "alpha": 0.01}})
    True
    """
    p_value, level = content["mismatch"].get("p_value"), content["mismatch"].get("alpha") or 0.0
    return (
        content["verdict"] == "no_mismatch"
        and not changed_before(content)
        and p_value is not None
        and p_value >= _COMMON
        and p_value > level
    )


def changed_before(content: dict) -> list[dict]:
    """What a history had already and has changed since, or is gone: entries of ``held``.

    Examples
    --------
    >>> changed_before({"since_history": {"held": [{"name": "seat_leakage", "change": "gone"}]}})
    [{'name': 'seat_leakage', 'change': 'gone'}]
    """
    held = (content.get("since_history") or {}).get("held") or []
    return [each for each in held if each["change"] in ("changed", "gone")]


def since_history(content: dict) -> bool:
    """Whether a recording was held against the valve's history: what is told has changed since then.

    Parameters
    ----------
    content : dict
        A diagnosis as diagnosis.json has it.

    Examples
    --------
    >>> since_history({"verdict": "named"}), since_history({"since_history": {"rows": 3600}})
    (False, True)
    """
    return bool(content.get("since_history"))


def lacking(content: dict) -> str:
    """What is said of physics that a simulation lacks: beside a history, that it has changed since.

    Examples
    --------
    >>> lacking({}), lacking({"since_history": {"rows": 3600}})
    ('is missing', 'has changed since the history')
    """
    if not since_history(content):
        return "is missing"
    return "differs from the history" if _may_be_old(content) else "has changed since the history"


def _may_be_old(content: dict) -> bool:
    """Whether names were taken back because the history may have had as much: no rule gave them a number."""
    refused = [r for r in content.get("rules") or [] if r["name"] == "probability" and not r["passed"]]
    return bool(refused) and refused[-1]["value"] is None and not content.get("effects")


def untested(content: dict) -> list[dict]:
    """Entries of ``not_testable`` that another recording could test: not those that this valve cannot have.

    Examples
    --------
    >>> gas = {"name": "gas_expansion", "needs": "a gas", "applies": False}
    >>> untested({"not_testable": [gas, {"name": "viscous_flow", "needs": "p1 and p2"}]})
    [{'name': 'viscous_flow', 'needs': 'p1 and p2'}]
    """
    return [item for item in content.get("not_testable") or [] if item.get("applies", True)]
