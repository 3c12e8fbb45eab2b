# SPDX-License-Identifier: BSD-3-Clause
"""The top of a report: the finding in one short sentence, how sure it is, what it brings, what to do next."""

from sklvalve._telling import changed_before, lacking, no_sign, since_history
from sklvalve.report.kinds import begins, by_beginning, faults_first, is_what, to_be_declared, what_is_it
from sklvalve.report.place import brief_place
from sklvalve.report.proof import left_out
from sklvalve.report.rows import moves
from sklvalve.report.sentence import (
    NOTHING_TO_BE_TOLD,
    beyond_noise,
    closest,
    gain,
    helped,
    new_since,
    not_beyond_allowed,
    size_words,
)
from sklvalve.report.words import (
    block_words,
    class_words,
    either,
    lacks_sheet,
    likeliest_first,
    named_effects,
    p_words,
    percent,
    right,
    role_words,
    unsaid,
    with_unit,
)

_BLIND = "In blind tests on simulated valves"
_COUNTS = {2: "two", 3: "three", 4: "four", 5: "five", 6: "six"}


def headline(d: dict) -> str:
    """Say what was found, where and how large, for a reader who knows the plant and no statistics.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.

    Returns
    -------
    sentence : str

    Examples
    --------
    >>> from sklvalve.report.headline import headline
    >>> mismatch = {"detected": False, "p_value": 0.43, "alpha": 0.01}
    >>> headline({"verdict": "no_mismatch", "mismatch": mismatch, "fit": {}})
    'Nothing is missing: simulation and recording agree within noise and data-sheet tolerances.'
    """
    return {
        "no_mismatch": _agreement,
        "named": _named,
        "none_of_these": _unknown,
        "cannot_tell": _undecided,
    }[d["verdict"]](d)


def glance(d: dict) -> list[tuple[str, str]]:
    """How sure the finding is, what to do next, what correcting it brings, what was assumed.

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.
    """
    asked = {
        "How sure": _sureness(d),
        "What to do next": _next(d),
        "What correcting it brings": _brings(d),
        "What was assumed": _assumed(d),
    }
    return [(question, words) for question, words in asked.items() if words]


def _agreement(d: dict) -> str:
    if d.get("subject") == "loop":
        return "Sticking of a relevant size is excluded."
    if since_history(d):
        return f"{not_beyond_allowed(d)}."
    if _differs(d):
        return (
            "Nothing relevant is missing: simulation and recording differ by less than the data-sheet "
            "tolerances."
        )
    if lacks_sheet(d):
        return f"{NOTHING_TO_BE_TOLD}."
    return "Nothing is missing: simulation and recording agree within noise and data-sheet tolerances."


def _named(d: dict) -> str:
    effects = faults_first(named_effects(d))
    if len(effects) == 1:
        effect = effects[0]
        words = what_is_it(effect)
        where = brief_place(d, unsaid(words, effect["blocks"]))
        size = _size(effect, d)
        found = f"{new_since(d)}{begins(effect)} {words}{is_what(effect)}{f', {where}' if where else ''}."
        return f"{found} {size[:1].upper()}{size[1:]}." if size else found
    told = [
        f"{begin} {'; '.join(f'{count}. {_one_of_several(effect, d)}' for count, effect in group)}"
        for begin, group in by_beginning(effects)
    ]
    where = brief_place(d, [])
    return f"{new_since(d)}{'. '.join(told)}{f'; they show {where}' if where else ''}."


def _one_of_several(effect: dict, d: dict) -> str:
    """One of several effects, where it sits, what it is and its sizes."""
    sizes = [size_words(effect, d, interval=False), moves(effect.get("size") or {}, d)]
    told = ", ".join(words for words in (is_what(effect).strip(" ()"), *sizes) if words)
    words = what_is_it(effect)
    where = block_words(unsaid(words, effect["blocks"]))
    words = f"{words}, {where}" if where else words
    return f"{words} ({told})" if told else words


def _unknown(d: dict) -> str:
    known = either([class_words(effect["members"]) for effect in d.get("effects") or []], "and")
    begin = f"Besides {known}, something" if known else "Something"
    where = brief_place(d, d["location"]["blocks"])
    unknown = d.get("unknown") or {}
    size = moves({unknown.get("signal"): unknown.get("size")}, d)
    joined = ", and " if "," in where else " and "
    acts = joined.join(words for words in (f"acts {where}" if where else "", size) if words)
    return f"{begin} {lacking(d)} that no known effect explains.{f' It {acts}.' if acts else ''}"


def _undecided(d: dict) -> str:
    if not d["mismatch"].get("detected", True):
        if d.get("subject") == "loop":
            return "This recording cannot show whether the valve sticks."
        return f"This recording cannot show whether anything {lacking(d)}."
    sentence = f"Something {lacking(d)}; the recording does not identify what."
    where = brief_place(d, d["location"]["blocks"])
    if where:
        sentence += f" It acts {where}."
    members = [member for effect in d.get("effects") or [] for member in effect["members"]]
    if members:
        sentence += f" Most likely: {class_words(likeliest_first(members), limit=4)}."
    return sentence


def _size(effect: dict, d: dict) -> str:
    """How far an effect moves the signals, and its own size."""
    told, own = moves(effect.get("size") or {}, d), size_words(effect, d, interval=False)
    if not told:
        return own
    return f"it {told} where it acts{f' ({own})' if own else ''}"


def _differs(d: dict) -> bool:
    level, chance = d["mismatch"].get("alpha"), d["mismatch"].get("p_value")
    return bool(d["mismatch"].get("detected") or (None not in (level, chance) and chance <= level))


def _sureness(d: dict) -> str:
    p_value, next_test = d["mismatch"].get("p_value"), d.get("next_test")
    parts = []
    if d["verdict"] == "named":
        parts.append(_named_sureness(faults_first(named_effects(d))))
    if no_sign(d):
        parts.append("No sign of a fault.")
        parts += ["What might have gone unnoticed is listed below."] if d.get("detection_limits") else []
    elif p_value is not None:
        parts.append(f"A difference as large comes by chance in {_times(p_value)} ({p_words(p_value)}).")
    if d["verdict"] == "none_of_these":
        parts += [f"It {beyond_noise(d)}.", closest(d).strip()]
    # what must be mended first is both the reason and what to do; a grade's reason is said already
    said = {next_test, *parts}
    parts += [reason for reason in d.get("reasons") or [] if reason not in said]
    return " ".join(part for part in parts if part)


def _named_sureness(effects: list[dict]) -> str:
    """How often such a diagnosis was right where that was checked, else the grade and its reason."""
    checked = [effect for effect in effects if effect.get("probability") is not None]
    parts = []
    if len(effects) == 1 and checked:
        count = len(checked[0]["members"])
        what = "" if count == 1 else f": one of the {_COUNTS.get(count, count)} causes was the true one"
        parts.append(
            f"{_BLIND} such a diagnosis was right in {right(checked[0]['probability'])} of cases{what}."
        )
    elif checked:
        each = [f"{right(e['probability'])} of cases for {_of(e)}" for e in checked]
        parts.append(f"{_BLIND} such diagnoses were right in {either(each, 'and')}.")
    for effect in effects:
        grade = effect.get("grade") or {}
        if effect.get("probability") is None:
            of = f" of {_of(effect)}" if len(effects) > 1 else ""
            level = f"{str(grade.get('level') or 'unknown').capitalize()} evidence{of}."
            parts.append(f"{level} {grade.get('reason', '')}".strip())
    return " ".join(parts)


def _of(effect: dict) -> str:
    return class_words(effect["members"], limit=1 + len(effect["members"]))


def _times(p_value: float) -> str:
    if p_value < 0.001:
        return "fewer than 1 of 1000 recordings of a healthy valve"
    return f"{percent(p_value)} of recordings of a healthy valve"


def _next(d: dict) -> str:
    test = d.get("next_test") or ""
    if d["verdict"] == "no_mismatch" and changed_before(d):
        return " ".join(
            ["Look at the valve for what has changed.", *([f"To learn more: {test}"] if test else [])]
        )
    if d["verdict"] == "no_mismatch":
        first = (
            "Give the data sheet's capacity and characteristic. Without the data sheet, wear or a leak "
            "cannot be told from the trim's shape."
            if lacks_sheet(d)
            else "Nothing needs to be done."
        )
        return " ".join([first, *([f"To learn more: {test}"] if test else [])])
    if d["verdict"] == "named" and to_be_declared(d["effects"]):
        return " ".join(words for words in (to_be_declared(d["effects"]), test) if words)
    if test:
        return test
    if d["verdict"] == "named":
        return "No further test is needed: look for it at the valve."
    return ""


def _assumed(d: dict) -> str:
    """Where nobody said what is known of the valve, on what the finding rests."""
    found: dict[str, list[str]] = {"assumed": [], "guessed": []}
    for each in d.get("data") or []:
        if each["finding"] in found:
            found[each["finding"]].append(role_words(each["role"]))
    if not (found["assumed"] or found["guessed"]):
        return ""
    told = "No data sheet was given; the columns were read by their names and values."
    if found["guessed"]:
        told += f" Partly a guess: {either(found['guessed'], 'and')}."
    return f"{told} The full list is below, under Data."


def _brings(d: dict) -> str:
    lost = left_out(d)
    if d["verdict"] == "no_mismatch":
        return ""
    words = f"nothing yet: {lost}" if lost and d["verdict"] == "none_of_these" else gain(d)
    return f"{words[:1].upper()}{words[1:]}.{_beside(d)}" if words else ""


def _beside(d: dict) -> str:
    """What else reaches which error: a black box, and noise alone."""
    role = helped(d)
    if role is None:
        return ""
    fit = d["fit"][role]
    scale, unit = (100.0, "%") if fit["unit"] == "1" else (1.0, fit["unit"])
    told = [
        f"{what} {with_unit(scale * value, unit)}"
        for what, value in (
            ("a black box trained on the same rows has", fit["rmse"].get("black_box")),
            ("noise alone gives", fit.get("noise_floor")),
        )
        if value is not None
    ]
    words = ", ".join(told)
    return f" For comparison: {words}." if words else ""
