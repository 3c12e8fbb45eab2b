# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a diagnosis as rows of words, shared by text, Markdown and HTML."""

from typing import NamedTuple

from sklvalve.report.kinds import faults_first
from sklvalve.report.noise import noise_told
from sklvalve.report.parameters import parameters
from sklvalve.report.place import (
    change_words,
    intervals_words,
    moment,
    region_words,
    share_words,
    since_known,
    since_words,
)
from sklvalve.report.proof import further, left_out, note
from sklvalve.report.words import (
    block_words,
    chance,
    class_in_block,
    class_words,
    either,
    number,
    percent,
    role_words,
    spoken,
    sure,
)

MODELS = {"nominal": "nominal", "black_box": "black box", "corrected": "corrected"}
_TOLD_FROM = 0.001
_MEASURES = {"rmse": "RMSE", "mape": "mean error, % of flow", "err_max": "largest error, %"}


class Explanation(NamedTuple):
    """One thing that was found."""

    name: str
    probability: float | None
    sure: str
    chance: str
    blocks: str
    placed: str
    members: list[tuple[str, float | None, str]]
    parameters: list[tuple[str, str]]
    sentence: str
    separated_by: str
    grade: str


def explanations(d: dict) -> list[Explanation]:
    """Everything found, faults first, with parameters and intervals in words."""
    return [
        Explanation(
            name=class_words(effect["members"], limit=5),
            probability=effect.get("probability"),
            sure=sure(effect),
            chance=chance(effect.get("probability")),
            blocks=block_words(effect["blocks"]),
            placed=class_in_block(effect, limit=5),
            members=[
                (spoken(member["name"]), member.get("probability"), chance(member.get("probability")))
                for member in effect["members"]
            ],
            parameters=parameters(effect, d),
            sentence=" ".join(
                words for words in (effect.get("sentence"), _moves(effect), _begins(effect, d)) if words
            ),
            separated_by=effect.get("separated_by") or "",
            grade=_grade(effect),
        )
        for effect in faults_first(d.get("effects") or [])
    ]


def _grade(effect: dict) -> str:
    """Reason of a finding's grade, and the grade where it is not said for want of a probability already."""
    grade = effect.get("grade")
    if not grade:
        return ""
    level = "" if effect.get("probability") is None else f"{grade['level'].capitalize()} evidence. "
    return f"{level}{grade['reason']}"


def moves(sizes: dict) -> str:
    """How far something moves the signals: ``moves the flow by 3 % of span``.

    Parameters
    ----------
    sizes : dict of float
        By role, shares of travel or span where it acts; what is beyond counting is not told.
    """
    told = [
        f"the {role_words(role)} by {percent(size)} of {'travel' if role == 'opening' else 'span'}"
        for role, size in sizes.items()
        if size is not None and size >= _TOLD_FROM
    ]
    return f"moves {either(told, 'and')}" if told else ""


def _moves(effect: dict) -> str:
    told = moves(effect.get("size") or {})
    return f"Where it acts, it {told}." if told else ""


def _begins(effect: dict, d: dict) -> str:
    """Since when one of several acts; of a single one the location says it, with its interval."""
    if len(d["effects"]) < 2 or "onset" not in effect:
        return ""
    onset = effect["onset"]
    return "It is there from the start." if onset is None else f"It begins at {moment(onset, d['location'])}."


def places(d: dict) -> list[tuple[str, str]]:
    """Where and when: (what, words)."""
    location = d.get("location") or {}
    rows = []
    if location.get("blocks"):
        rows.append(("Part", block_words(location["blocks"], "and")))
    for region in location.get("regions") or []:
        share = share_words(region)
        rows.append(("Region", region_words(region) + (f", {share}" if share else "")))
    changed = change_words(location)
    if changed:
        rows.append(("Changed", changed))
    if not rows and not location.get("intervals"):
        return rows
    if not since_known(d):
        if changed:
            return rows
        learnt = ": it was learnt from all rows alike" if d["verdict"] == "none_of_these" else ""
        return [*rows, ("Since", f"not known{learnt}")]
    begins = (d.get("provenance") or {}).get("begins")
    rows.append(("Since", since_words(location, begins)))
    if location.get("intervals"):
        rows.append(("Present", intervals_words(location, begins)))
    if any(each.get("assumed") for each in location.get("recordings") or []):
        rows.append(("Clock", "the times of the recordings begin anew: they stand in the order given"))
    return rows


def errors(d: dict) -> list[tuple[str, list[str]]]:
    """Errors on held-out rows: (signal and measure, one cell for each of `MODELS`)."""
    rows = []
    for role, fit in (d.get("fit") or {}).items():
        for key, words in _MEASURES.items():
            values = (fit or {}).get(key)
            if not values:
                continue
            scale, unit = (100.0, "% of travel") if fit["unit"] == "1" else (1.0, fit["unit"])
            if key == "rmse":
                words = f"{words} [{unit}]"
            else:
                scale = 1.0
                words = words if role == "flow" else words.replace("of flow", f"of {role_words(role)}")
            cells = [values.get(model) for model in MODELS]
            rows.append(
                (
                    f"{role_words(role)} {words}",
                    ["-" if cell is None else number(scale * cell) for cell in cells],
                )
            )
    return rows


def skills(d: dict) -> list[str]:
    """How much of what could be explained is explained, a sentence for each signal."""
    lines = []
    for role, fit in (d.get("fit") or {}).items():
        skill = (fit or {}).get("skill")
        if skill is None:
            continue
        low, high = fit.get("skill_ci95") or (None, None)
        words = f"Skill of {role_words(role)}: {number(skill)}"
        if low is not None and high is not None:
            words += f" [{number(low)} to {number(high)}]"
        lines.append(f"{words} (1 explains all but noise, 0 no more than nominal)")
    return lines


def proof_notes(d: dict) -> list[str]:
    """What belongs below the table of errors: how they were taken, what they prove, what was left out."""
    lost = left_out(d)
    besides = f"Of what no effect explains: {lost}." if lost else ""
    return [words for words in (note(d), *skills(d), *noise_told(d), *further(d), besides) if words]


def untestable(d: dict) -> list[tuple[str, str]]:
    """Effects that this recording could not be asked about: (effect, what it needs)."""
    return [(spoken(item["name"]), _needs(item.get("needs"))) for item in d.get("not_testable") or []]


def untestable_by_need(d: dict) -> list[tuple[str, list[str]]]:
    """What this recording lacks, and which effects it could not be asked about for it."""
    found: dict[str, list[str]] = {}
    for name, needs in untestable(d):
        found.setdefault(needs, []).append(name)
    return list(found.items())


def _needs(needs: object) -> str:
    if isinstance(needs, list | tuple):
        return ", ".join(role_words(str(need)) for need in needs)
    return role_words(str(needs)) if needs else "another recording"


def data_findings(d: dict) -> list[tuple[str, str, str]]:
    """What is wrong with the data themselves: (signal, finding, detail)."""
    return [
        (role_words(item.get("role")), item["finding"].replace("_", " "), item.get("detail") or "")
        for item in d.get("data") or []
    ]


def unexplained(d: dict) -> list[tuple[str, str]]:
    """What no effect explains: (what, words); empty where there is no such thing."""
    unknown = d.get("unknown")
    if not unknown:
        return []
    role = unknown["signal"]
    rows = [("Signal", role_words(role))]
    if unknown.get("inputs"):
        rows.append(("Follows from", either([role_words(name) for name in unknown["inputs"]], "and")))
    if unknown.get("size") is not None:
        whole = "travel" if role == "opening" else "span"
        rows.append(("Size where it acts", f"{percent(unknown['size'])} of {whole}"))
    if unknown.get("share") is not None:
        holds = f"{percent(unknown['share'])} of what was learnt"
        formula = unknown.get("formula")
        words = f"{formula} (holds {holds})" if formula else f"no short formula (the best holds {holds})"
        rows.append(("Looks like", words))
    return rows


def provenance(d: dict) -> list[tuple[str, str]]:
    """What the diagnosis was made from and with."""
    names = {
        "sklvalve": "sklvalve version",
        "recording_sha256": "SHA-256 of the recording",
        "begins": "first sample",
    }
    told = dict(d.get("provenance") or {})
    several = told.pop("recordings", [])
    if several:
        told.pop("recording_sha256", None)
    rows = [
        (names.get(key, key.replace("_", " ")), "unknown" if value is None else str(value))
        for key, value in told.items()
    ]
    for each in several:
        checksum = f", SHA-256 {each['sha256']}" if each["sha256"] else ""
        rows.append((f"recording {each['source']}", f"{each['rows']} rows{checksum}"))
    return rows
