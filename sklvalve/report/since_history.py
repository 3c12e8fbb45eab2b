# SPDX-License-Identifier: BSD-3-Clause
"""The section "Since the history": what it was held against, what changed, what a history cannot say."""

from typing import Any

from sklvalve._telling import changed_before
from sklvalve.report import calibration
from sklvalve.report.parameters import shown_parameters
from sklvalve.report.place import duration
from sklvalve.report.words import class_words, either, number, percent, role_words, with_unit

TITLE = "Since the history"
_SAME = {"command": "at the same command", "opening": "at the same opening"}
# what cannot be told for want of a signal
_UNSEEN = {
    "opening": "No opening was recorded: a change of the stem and one of the trim may look alike.",
    "p1": "No pressures were recorded: a change of the pressure drop and one of the capacity look alike.",
    "flow": "No flow was recorded: of trim and capacity it says nothing.",
}
# parameters of which nothing was learnt that are named
_NAMED = 4
_THEN = (
    "A history keeps what its recordings say of the calibration, not their rows: then is the simulation with "
    "the calibration expected from it, driven by the signals of this recording."
)

_CAUTION = (
    "Parameters that make up for each other may lie apart together and move no signal; the residuals tell "
    "whether it matters."
)


_NOT_BLIND = (
    "The blind tests of how often a name is right were made without a history; 195 simulated recordings with "
    "one, which were not blind, correct them."
)


def section(d: dict) -> dict[str, Any] | None:
    """What the section holds; None where the diagnosis was made without a history.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.

    Returns
    -------
    section : dict or None
        ``facts``, pairs of what and words; ``head`` and ``rows`` of the calibration, those worth showing,
        and ``all_rows``; ``allowances``, pairs; ``cannot_say``, sentences; ``then``, what "then" is.
    """
    since = d.get("since_history")
    if not since:
        return None
    rows = calibration.then_and_now(since)
    return {
        "title": TITLE,
        "facts": facts(d),
        "head": calibration.HEAD,
        "rows": [row.cells for row in calibration.worth_showing(rows)],
        "all_rows": [row.cells for row in rows],
        "allowances": allowances(since),
        "cannot_say": cannot_say(d),
        "then": _THEN,
        "caution": _CAUTION,
    }


def facts(d: dict) -> list[tuple[str, str]]:
    """What the recording was held against, what changed and by how much, what is left over then and now."""
    since = d["since_history"]
    return [("History", _history(since)), *_known(since), *_changes(d, since), *_left(since)]


def allowances(since: dict) -> list[tuple[str, str]]:
    """What may change without a fault: (what, standard deviation)."""
    return [(_capital(item["words"]), _share(item["value"])) for item in since.get("allowances") or []]


def allowances_words(since: dict) -> str:
    """The same as one sentence, with how to set them."""
    told = [f"{item['words']}: {_share(item['value'])}" for item in since.get("allowances") or []]
    return f"Standard deviations. {'; '.join(map(_capital, told))}. {settable()}" if told else ""


def settable() -> str:
    """How the allowances are set."""
    return "ValveHistory(allowance=Allowance(...)) sets them, and so does diagnose --allow NAME=VALUE."


def cannot_say(d: dict) -> list[str]:
    """What the history does not know of this recording, a sentence each."""
    limits, recorded = d["since_history"].get("cannot_say") or {}, d.get("units") or {}
    told = [words for role, words in _UNSEEN.items() if recorded and role not in recorded]
    told += [_outside(item) for item in limits.get("outside") or []]
    blind = [calibration.parameter_words(name) for name in limits.get("not_informed") or []]
    if blind:
        rest = len(blind) - _NAMED
        names = [*blind[:_NAMED], f"{rest} more"] if rest > 1 else blind
        told.append(f"It says no more than the data sheet of: {either(names, 'and')}.")
    if any(effect.get("probability") is not None for effect in d.get("effects") or []):
        told.append(_NOT_BLIND)
    return told


def _history(since: dict) -> str:
    many = since["recordings"]
    words = (
        f"{many} recording{'s' if many != 1 else ''}, {since['rows']} rows, "
        f"{duration(86_400.0 * since['days'])} recorded"
    )
    first, last = since.get("first"), since.get("last")
    # seconds of several recordings have no common zero
    dated = isinstance(first, str) and isinstance(last, str)
    return f"{words}, from {first} to {last}" if dated else words


def _known(since: dict) -> list[tuple[str, str]]:
    """What the history lacked by itself, and what it had already, then and now."""
    found = since.get("by_itself")
    by_itself = "Its recordings were not diagnosed by themselves"
    if found:
        by_itself = " ".join(found[key] for key in ("finding", "reason") if found[key])
    told = [("The history by itself", by_itself)] if "by_itself" in since else []
    return told + [("There already", item["sentence"]) for item in since.get("held") or []]


def _changes(d: dict, since: dict) -> list[tuple[str, str]]:
    """Size of every change, in the unit of its parameter and in flow."""
    effects, changes = d.get("effects") or [], since.get("changes") or []
    if not effects:
        return [("Changed", _nameless(d))]
    what = "May have changed" if d["verdict"] == "cannot_tell" else "Changed"
    told = []
    for place, effect in enumerate(effects):
        change = changes[place] if place < len(changes) else {}
        parts = [_own_size(effect, d), _in_flow(change.get("flow"))]
        words = "; ".join(part for part in parts if part)
        name = _capital(class_words(effect["members"]))
        told.append((what, f"{name}: {words}" if words else name))
    return told


def _nameless(d: dict) -> str:
    """What is said of a change where no effect is a candidate."""
    if d["verdict"] == "no_mismatch":
        return f"Nothing{' else' if changed_before(d) else ''} by more than is allowed"
    if d["verdict"] == "none_of_these":
        return "Something that no known effect explains"
    if not d["mismatch"].get("detected", True):
        return "This recording cannot show it"
    return "Something; the recording does not identify what"


def _own_size(effect: dict, d: dict) -> str:
    shown = shown_parameters(effect, d)
    return f"{shown[0].name} {shown[0].words}" if shown else ""


def _in_flow(flow: dict | None) -> str:
    if not flow:
        return ""
    words = f"flow {with_unit(flow['value'], flow['unit'])}"
    if flow.get("ci95"):
        low, high = flow["ci95"]
        words += f" [{number(low)} to {number(high)}]"
    same = _SAME.get(flow.get("at_the_same") or "", "")
    return f"{words} {same}, rms where it acts".replace("  ", " ")


def _left(since: dict) -> list[tuple[str, str]]:
    """Rms of the residual by channel: in the history, now by the simulation of then, and by that of now."""
    rows = []
    for role, item in (since.get("residuals") or {}).items():
        scale, unit = (100.0, "% of travel") if item["unit"] == "1" else (1.0, item["unit"])
        unit = "% of travel" if role == "opening" and unit == "%" else unit
        left = [_scaled(item[key], scale) for key in ("history", "by_then", "by_now")]
        words = (
            f"{left[0]} {unit} in the history; in this recording {left[1]} with the calibration expected, "
            f"{left[2]} with that of now"
        )
        rows.append((f"Residual of {role_words(role)}, rms", words))
    return rows


def _scaled(value: float | None, scale: float) -> str:
    return number(None if value is None else scale * value)


def _outside(item: dict) -> str:
    name = {"drop": "pressure drop"}.get(item["signal"]) or role_words(item["signal"])
    then, here = (
        f"from {number(each['low'])} to {with_unit(each['high'], each['unit'])}"
        for each in (item["history"], item["here"])
    )
    return (
        f"In {percent(item['share'])} of the rows the {name} is where the history has hardly been: {then} in "
        f"the history, {here} here."
    )


def _share(value: float) -> str:
    return f"{number(100.0 * value, 2)} %"


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]
