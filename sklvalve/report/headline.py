# SPDX-License-Identifier: BSD-3-Clause
"""The top of a report: the finding in one short sentence, how sure it is, what it brings, what to do next."""

from sklvalve.report.kinds import begins, by_beginning, faults_first, is_what, to_be_declared
from sklvalve.report.place import brief_place
from sklvalve.report.proof import left_out
from sklvalve.report.rows import moves
from sklvalve.report.sentence import NOTHING_TO_BE_TOLD, closest, gain, helped, no_noise, size_words
from sklvalve.report.words import (
    class_in_block,
    class_words,
    either,
    lacks_sheet,
    likeliest_first,
    named_effects,
    number,
    p_words,
    percent,
    role_words,
    sure,
    unsaid,
)

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
    """How sure the finding is, what to do next, what it brings and what was assumed: (question, answer).

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it.
    """
    asked = {
        "How sure": _sureness(d),
        "What to do next": _next(d),
        "What it brings": _brings(d),
        "What was assumed": _assumed(d),
    }
    return [(question, words) for question, words in asked.items() if words]


def _agreement(d: dict) -> str:
    if d.get("subject") == "loop":
        return "Sticking of a size that matters is excluded."
    if _differs(d):
        return (
            "Nothing that matters is missing: simulation and recording differ by less than the data-sheet "
            "tolerances and the size that counts."
        )
    if lacks_sheet(d):
        return f"{NOTHING_TO_BE_TOLD}."
    return "Nothing is missing: simulation and recording agree within noise and data-sheet tolerances."


def _named(d: dict) -> str:
    effects = faults_first(named_effects(d))
    if len(effects) == 1:
        effect = effects[0]
        words = class_words(effect["members"])
        found = f"{words} {brief_place(d, unsaid(words, effect['blocks']))}".rstrip()
        size = _size(effect, d)
        return f"{begins(effect)} {found}{is_what(effect)}{f': {size}' if size else ''}."
    told = [
        f"{begin} {'; '.join(f'{count}. {_one_of_several(effect, d)}' for count, effect in group)}"
        for begin, group in by_beginning(effects)
    ]
    where = brief_place(d, [])
    return f"{'. '.join(told)}{f'; they show {where}' if where else ''}."


def _one_of_several(effect: dict, d: dict) -> str:
    """One of several effects, where it sits, what it is and its sizes."""
    sizes = [size_words(effect, d, interval=False), moves(effect.get("size") or {})]
    told = ", ".join(words for words in (is_what(effect).strip(" ()"), *sizes) if words)
    words = class_in_block(effect)
    return f"{words} ({told})" if told else words


def _unknown(d: dict) -> str:
    known = either([class_words(effect["members"]) for effect in d.get("effects") or []], "and")
    begin = f"Besides {known}, something" if known else "Something"
    where = brief_place(d, d["location"]["blocks"])
    size = moves({(d.get("unknown") or {}).get("signal"): (d.get("unknown") or {}).get("size")})
    acts = f": it acts {where}" if where else ""
    return f"{begin} is missing that no known effect explains{acts}{f', and {size}' if size else ''}."


def _undecided(d: dict) -> str:
    if not d["mismatch"].get("detected", True):
        return "This recording cannot tell whether anything is missing."
    where = brief_place(d, d["location"]["blocks"])
    sentence = "Something is missing, but this recording cannot tell what"
    if where:
        sentence += f": it acts {where}"
    members = [member for effect in d.get("effects") or [] for member in effect["members"]]
    if members:
        sentence += f"; likeliest is {class_words(likeliest_first(members), limit=4)}"
    return sentence + "."


def _size(effect: dict, d: dict) -> str:
    """How far an effect moves the signals, and its own size."""
    told, own = moves(effect.get("size") or {}), size_words(effect, d, interval=False)
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
    if d["verdict"] == "cannot_tell" and d["mismatch"].get("detected", True):
        parts.append("That something is missing is sure, what it is is not.")
    if p_value is not None:
        parts.append(f"A difference as large comes by chance in {_times(p_value)} ({p_words(p_value)}).")
    if d["verdict"] == "none_of_these":
        parts += [f"It {no_noise(d)}.", closest(d).strip()]
    # what must be mended first is both the reason and what to do
    parts += [reason for reason in d.get("reasons") or [] if reason != next_test]
    return " ".join(part for part in parts if part)


def _named_sureness(effects: list[dict]) -> str:
    if len(effects) > 1:
        every = [f"{sure(e)} of {class_words(e['members'], limit=1 + len(e['members']))}" for e in effects]
        return _begun(f"{'; '.join(every)}.")
    effect, count = effects[0], len(effects[0]["members"])
    words = sure(effect)
    if effect.get("probability") is None:
        return f"{_begun(words)}. {(effect.get('grade') or {}).get('reason', '')}".strip()
    what = "of the name" if count == 1 else f"that it is one of these {_COUNTS.get(count, count)}"
    share = "in blind tests on simulated valves this share of such identifications was correct"
    return f"{_begun(words)} {what}: {share}."


def _begun(words: str) -> str:
    return f"{words[:1].upper()}{words[1:]}"


def _times(p_value: float) -> str:
    if p_value < 0.001:
        return "fewer than 1 of 1000 recordings of a healthy valve"
    return f"{percent(p_value)} of recordings of a healthy valve"


def _next(d: dict) -> str:
    test = d.get("next_test") or ""
    if d["verdict"] == "no_mismatch":
        first = (
            "Give the data sheet's capacity and characteristic: without them a leak, a worn trim or a wrong "
            "capacity cannot be told."
            if lacks_sheet(d)
            else "Nothing needs to be done."
        )
        return " ".join([first, *([f"To learn more: {test}"] if test else [])])
    if d["verdict"] == "named" and to_be_declared(d["effects"]):
        return " ".join(words for words in (to_be_declared(d["effects"]), test) if words)
    if test:
        return test
    if d["verdict"] == "named":
        return "No further test is needed to tell what it is: look for it at the valve."
    return ""


def _assumed(d: dict) -> str:
    """Where nobody said what is known of the valve, on what the finding rests."""
    found: dict[str, list[str]] = {"assumed": [], "guessed": []}
    for each in d.get("data") or []:
        if each["finding"] in found:
            found[each["finding"]].append(role_words(each["role"]))
    if not (found["assumed"] or found["guessed"]):
        return ""
    told = "No data sheet was given, and the columns were read by their names and values."
    if found["guessed"]:
        told += f" Partly a guess: {either(found['guessed'], 'and')}."
    return f"{told} All of it stands below, under the data themselves."


def _brings(d: dict) -> str:
    lost = left_out(d)
    words = f"nothing yet: {lost}" if lost and d["verdict"] == "none_of_these" else gain(d)
    if not words or d["verdict"] == "no_mismatch":
        return ""
    return f"{words[:1].upper()}{words[1:]}.{_beside(d)}"


def _beside(d: dict) -> str:
    """What else reaches which error: a black box, and noise alone."""
    role = helped(d)
    if role is None:
        return ""
    fit = d["fit"][role]
    scale = 100.0 if fit["unit"] == "1" else 1.0
    told = [
        f"{what} {number(scale * value)}"
        for what, value in (
            ("a black box learnt from the same rows makes", fit["rmse"].get("black_box")),
            ("noise alone", fit.get("noise_floor")),
        )
        if value is not None
    ]
    words = ", ".join(told)
    return f" For comparison: {words}." if words else ""
