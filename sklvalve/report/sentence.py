# SPDX-License-Identifier: BSD-3-Clause
"""The first thing that a person reads: the diagnosis in one sentence."""

from sklvalve._telling import changed_before, lacking, no_sign, since_history
from sklvalve.report.kinds import begins, by_beginning, faults_first, is_what, what_is_it
from sklvalve.report.parameters import shown_parameters
from sklvalve.report.place import located, onset_words, regions_words, since_known
from sklvalve.report.proof import error_words, left_out
from sklvalve.report.words import (
    block_words,
    chance,
    class_words,
    either,
    in_recorded,
    lacks_sheet,
    likeliest_first,
    named_effects,
    number,
    p_words,
    role_words,
    spoken,
    sure,
    unsaid,
    with_unit,
)

# an error that falls by less does not fall
_NO_FALL = 0.98
# without a data sheet capacity and trim are learnt from the recording itself: no all-clear for them
NOTHING_TO_BE_TOLD = (
    "Nothing is missing, as far as a recording without a data sheet can show: with a trim estimated from it, "
    "simulation and recording agree within noise and tolerances"
)

# with a history its allowances stand in the place of the sheet's tolerances
NOT_BEYOND_ALLOWED = (
    "Nothing has changed since the history by more than is allowed: simulation and recording agree within "
    "noise, what the history lets expect and what may change without a fault"
)


def summary_sentence(d: dict) -> str:
    """Say the diagnosis in one plain sentence.

    What is missing, how large it is, where and since when it acts, how sure that is, and what including it
    does to the error: on untouched rows where there are such ("unseen"), else on blocks that were
    held out of the fit in turn ("cross-validated").

    Parameters
    ----------
    d : dict
        A diagnosis as ``Diagnosis.to_dict()`` gives it, or read back from diagnosis.json.

    Returns
    -------
    sentence : str

    Raises
    ------
    ValueError
        If the verdict is none of the four.

    Examples
    --------
    >>> from sklvalve.report import summary_sentence
    >>> mismatch = {"detected": False, "p_value": 0.43, "alpha": 0.01}
    >>> summary_sentence({"verdict": "no_mismatch", "mismatch": mismatch, "fit": {}})
    'Nothing is missing: simulation and recording agree within noise and data-sheet tolerances.'
    """
    sentences = {
        "no_mismatch": _agreement,
        "named": _named,
        "none_of_these": _unknown,
        "cannot_tell": _undecided,
    }
    if d["verdict"] not in sentences:
        raise ValueError(f"verdict must be one of {', '.join(sentences)}; got {d['verdict']!r}")
    return sentences[d["verdict"]](d)


def _agreement(d: dict) -> str:
    level, chance = d["mismatch"].get("alpha"), d["mismatch"].get("p_value")
    p_value = "" if no_sign(d) else f" ({p_words(chance)})"
    if d.get("subject") == "loop":
        reasons = d.get("reasons") or []
        return " ".join([f"Sticking of a relevant size is excluded{p_value}.", *reasons])
    if since_history(d):
        return f"{not_beyond_allowed(d)}{p_value}."
    if d["mismatch"].get("detected") or (None not in (level, chance) and chance <= level):
        return (
            f"Nothing relevant is missing: simulation and recording differ by more than noise{p_value}, but "
            "by less than the data-sheet tolerances."
        )
    if lacks_sheet(d):
        return f"{NOTHING_TO_BE_TOLD}{p_value}."
    return (
        f"Nothing is missing: simulation and recording agree within noise and data-sheet tolerances{p_value}."
    )


def not_beyond_allowed(d: dict) -> str:
    """That nothing has changed since a history, or nothing but what it had already."""
    if changed_before(d):
        rest = NOT_BEYOND_ALLOWED.removeprefix("Nothing")
        return f"What the history had already has changed. Nothing else{rest}"
    return NOT_BEYOND_ALLOWED


def _named(d: dict) -> str:
    effects = faults_first(named_effects(d))
    if len(effects) == 1:
        effect = effects[0]
        return (
            f"{new_since(d)}{begins(effect)} {what_is_it(effect)}{is_what(effect)} "
            f"({sure(effect)}): "
            f"{_size(effect, d)}acting {_place(d, effect['blocks'])}{_clause(d)}."
        )
    found = [f"{place}. {_one_of_several(effect, d)}" for place, effect in enumerate(effects, start=1)]
    groups = by_beginning(effects)
    told = ". ".join(f"{begin} {'; '.join(found[k - 1] for k, _ in group)}" for begin, group in groups)
    return f"{new_since(d)}{told}; they show {_place(d, [])}{_clause(d)}."


def new_since(d: dict) -> str:
    """How a finding begins that was held against a history; empty without one."""
    return "New since the history. " if since_history(d) else ""


def _one_of_several(effect: dict, d: dict) -> str:
    words = what_is_it(effect)
    where = block_words(unsaid(words, effect["blocks"]))
    return f"{words}{f', {where}' if where else ''}{is_what(effect)} ({_size(effect, d)}{sure(effect)})"


def _unknown(d: dict) -> str:
    besides = ""
    if d.get("effects"):
        besides = f"Besides {either([class_words(effect['members']) for effect in d['effects']], 'and')}, "
    lost = left_out(d)
    return (
        f"{besides}{'something' if besides else 'Something'} {lacking(d)} that no known effect explains: it "
        f"acts {_place(d, d['location']['blocks'])} and {beyond_noise(d)} "
        f"({p_words(d['mismatch'].get('p_value'))}){f', but {lost}' if lost else _clause(d)}.{closest(d)}"
    )


def beyond_noise(d: dict) -> str:
    """What distinguishes it from noise: the signals from which it can be predicted, or its size alone."""
    unknown = d.get("unknown") or {}
    inputs, beyond, pulses = (unknown.get(key) for key in ("inputs", "beyond_noise", "pulses"))
    if pulses:
        return (
            f"follows from nothing recorded, but the flow is {pulses['side']} its simulation at "
            f"{pulses['moments']} moments while the valve is at rest, and on the other side "
            f"{_count(pulses['against'])}: noise does not do that"
        )
    if beyond and not inputs:
        signal = unknown.get("signal", "flow")
        size, allowed = (in_recorded(d, signal, beyond[key]) for key in ("size", "allowed"))
        if "rows" in beyond:
            return (
                f"follows from nothing recorded, but comes and goes within about {beyond['rows']} rows by "
                f"{size}, where the history's noise comes to {allowed}"
            )
        return f"follows from nothing recorded, but its slow part ({size}) is larger than slow noise can be"
    if unknown and not inputs:
        return "is smoother than noise, though it follows from nothing recorded"
    told = either([role_words(name) for name in inputs], "and") if inputs else "the recorded signals"
    return f"follows from {told}, so it is not noise"


def _count(many: int) -> str:
    return {0: "never", 1: "once"}.get(many, f"{many} times")


def closest(d: dict) -> str:
    """The known effects that fit best and leave too much; empty where there are none."""
    unknown = d.get("unknown") or {}
    if not unknown.get("closest"):
        return ""
    names = either([class_words(effect["members"]) for effect in unknown["closest"]], "and")
    left = unknown.get("closest_leaves")
    fit = "fit" if len(unknown["closest"]) > 1 else "fits"
    best = f" {names[:1].upper()}{names[1:]} {fit} best, but"
    if left is None:
        return f"{best} two slow drifts together can mimic almost any third."
    return f"{best} {in_recorded(d, unknown.get('signal', 'flow'), left)} beyond noise would remain."


def _undecided(d: dict) -> str:
    if not d["mismatch"].get("detected", True):
        what = "whether the valve sticks" if d.get("subject") == "loop" else f"whether anything {lacking(d)}"
        return " ".join([f"This recording cannot show {what}.", *(d.get("reasons") or [])])
    place = _place(d, d["location"]["blocks"])
    p_value = p_words(d["mismatch"].get("p_value"))
    sentence = f"Something {lacking(d)} ({p_value}); the recording does not identify what"
    sentence += f": it acts {place}" if place else ""
    likely = likeliest_first(m for effect in d.get("effects") or [] for m in effect["members"])
    if likely:
        listed = [_with_chance(member) for member in likely[:3]]
        sentence += f"; most likely {', then '.join(listed)}"
    if d.get("next_test"):
        sentence += "; the next test would decide"
    return sentence + "."


def _with_chance(member: dict) -> str:
    name, probability = spoken(member["name"]), member.get("probability")
    return name if probability is None else f"{name} ({chance(probability)})"


def size_words(effect: dict, d: dict, *, interval: bool = True) -> str:
    """The first parameter, which is the effect's own size, with its interval or without."""
    shown = shown_parameters(effect, d)
    if not shown:
        return ""
    return f"{shown[0].name} {shown[0].words if interval else shown[0].short}"


def _size(effect: dict, d: dict) -> str:
    words = size_words(effect, d)
    return f"{words}, " if words else ""


def _place(d: dict, blocks: list[str]) -> str:
    location = located(d)
    parts = [block_words(blocks), regions_words(location)]
    if since_known(d):
        parts.append(onset_words(location))
    return " ".join(part for part in parts if part)


def gain(d: dict) -> str:
    """What including the finding does to the error of the signal that it helps most; empty where not known.

    Where nothing was found nothing was included, and nothing is said.
    """
    role = helped(d)
    if role is None or not (d.get("effects") or d["verdict"] == "none_of_these"):
        return ""
    fit = d["fit"][role]
    before, after = fit["rmse"]["nominal"], fit["rmse"]["corrected"]
    them = {"none_of_these": "a fitted correction", "cannot_tell": "the best candidate"}.get(
        d["verdict"], "it"
    )
    if d["verdict"] == "named" and len(d["effects"]) > 1:
        them = "them"
    scale, unit = (100.0, "%") if fit["unit"] == "1" else (1.0, fit["unit"])
    if after > _NO_FALL * before:
        return f"including {them} does not lower the {error_words(d, role)}"
    return (
        f"including {them} lowers the {error_words(d, role)} from {number(scale * before)} "
        f"to {with_unit(scale * after, unit)}"
    )


def _clause(d: dict) -> str:
    """The gain as the end of a sentence."""
    words = gain(d)
    if not words:
        return ""
    return f"; {words}" if " lowers " in words else f", though {words}"


def helped(d: dict) -> str | None:
    """The signal to speak of: the unknown's own, else the one whose error falls by the largest share.

    Where none falls it is the one that what was found touches first.
    """
    shares = {}
    for role, fit in (d.get("fit") or {}).items():
        rmse = (fit or {}).get("rmse") or {}
        before, after = rmse.get("nominal"), rmse.get("corrected")
        if before and after is not None:
            shares[role] = after / before
    if not shares:
        return None
    own = (d.get("unknown") or {}).get("signal")
    if d["verdict"] == "none_of_these" and own in shares:
        return own
    best = min(shares, key=shares.__getitem__)
    if shares[best] > _NO_FALL:
        first = ("opening",) if d["location"]["blocks"] == ["actuator"] else ("flow", "process_value")
        best = next((role for role in first if role in shares), best)
    return best
