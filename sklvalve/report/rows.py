# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a diagnosis as rows of words, shared by text, Markdown and HTML."""

from typing import NamedTuple

from sklvalve._telling import since_history, untested
from sklvalve.report.kinds import faults_first
from sklvalve.report.noise import noise_told
from sklvalve.report.parameters import parameters
from sklvalve.report.place import (
    change_words,
    intervals_words,
    located,
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
    in_recorded,
    number,
    p_words,
    percent,
    role_words,
    spoken,
    sure,
)

MODELS = {"nominal": "nominal", "black_box": "black box", "corrected": "corrected"}
_SHOWN_FROM = 0.001
# effects of one need that are all named
_MANY = 8
_MEASURES = {"rmse": "RMSE", "mape": "mean error, % of flow", "err_max": "largest error, %"}
# roles that a recording may lack, as needs name them
_ROLES = {"command", "opening", "flow", "p1", "p2", "temperature", "setpoint", "process_value"}


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
                words for words in (effect.get("sentence"), _moves(effect, d), _begins(effect, d)) if words
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


def moves(sizes: dict, d: dict) -> str:
    """How far something moves the signals: ``moves the flow by 2.4 m3/h``.

    Parameters
    ----------
    sizes : dict of float
        By role, shares of travel or span where it acts; what is too small to count is left out.
    d : dict
        The diagnosis, for recorded units and spans.
    """
    told = [
        f"the {role_words(role)} by {in_recorded(d, role, size)}"
        for role, size in sizes.items()
        if size is not None and size >= _SHOWN_FROM
    ]
    return f"moves {either(told, 'and')}" if told else ""


def _moves(effect: dict, d: dict) -> str:
    told = moves(effect.get("size") or {}, d)
    return f"Where it acts, it {told}." if told else ""


def _begins(effect: dict, d: dict) -> str:
    """Since when one of several acts; of a single one the location says it, with its interval."""
    if len(d["effects"]) < 2 or "onset" not in effect:
        return ""
    onset = effect["onset"]
    return "It is there from the start." if onset is None else f"It begins at {moment(onset, located(d))}."


def places(d: dict) -> list[tuple[str, str]]:
    """Where and when: (what, words)."""
    location = located(d)
    rows = []
    if location.get("blocks"):
        # of several parts nobody knows which
        last = "and" if d["verdict"] == "named" and len(d.get("effects") or []) > 1 else "or"
        rows.append(("Part", block_words(location["blocks"], last)))
    for region in location.get("regions") or []:
        share = share_words(region)
        words = region_words(region, units=location["units"])
        rows.append(("Region", words + (f", {share}" if share else "")))
    changed = change_words(location)
    if changed:
        rows.append(("Changed", changed))
    if not rows and not location.get("intervals"):
        return rows
    if not since_known(d):
        if changed:
            return rows
        fitted = ": it was fitted to all rows alike" if d["verdict"] == "none_of_these" else ""
        return [*rows, ("Since", f"not known{fitted}")]
    rows.append(("Since", _since(d, location)))
    if location.get("intervals"):
        rows.append(("Present", intervals_words(location)))
    if any(each.get("assumed") for each in location.get("recordings") or []):
        rows.append(
            ("Clock", "each recording's time starts at its first row; they are joined in the order given")
        )
    return rows


def _since(d: dict, location: dict) -> str:
    """Since when; what was there from the start of a recording came between it and the history."""
    words = since_words(location)
    between = since_history(d) and location.get("onset") is None
    return f"{words}: it came between the history and this recording" if between else words


def models(d: dict) -> dict[str, str]:
    """Models whose errors are shown: key in ``rmse``, and name; none corrected where nothing was."""
    fits = [(fit or {}).get("rmse") or {} for fit in (d.get("fit") or {}).values()]
    idle = all(rmse.get("corrected") in (None, rmse.get("nominal")) for rmse in fits)
    hidden = not d.get("effects") and d["verdict"] != "none_of_these" and idle
    return {key: name for key, name in MODELS.items() if not (hidden and key == "corrected")}


def errors(d: dict) -> list[tuple[str, list[str]]]:
    """Errors on held-out rows: (signal and measure, one cell for each of `models`)."""
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
            cells = [values.get(model) for model in models(d)]
            rows.append(
                (
                    f"{role_words(role)} {words}",
                    ["-" if cell is None else number(scale * cell) for cell in cells],
                )
            )
    return rows


def skills(d: dict) -> list[str]:
    """How much of what could be explained is explained, a sentence for each signal that was corrected."""
    lines = []
    for role, fit in (d.get("fit") or {}).items():
        skill, rmse = (fit or {}).get("skill"), (fit or {}).get("rmse") or {}
        if skill is None or rmse.get("nominal") == rmse.get("corrected"):
            continue
        low, high = fit.get("skill_ci95") or (None, None)
        words = f"Skill of {role_words(role)}: {number(skill)}"
        if low is not None and high is not None:
            words += f" [{number(low)} to {number(high)}]"
        lines.append(f"{words} (1 explains all but noise, 0 no more than nominal).")
    return lines


def proof_notes(d: dict) -> list[str]:
    """What belongs below the table of errors: how they were taken, and what was left out."""
    lost = left_out(d)
    besides = f"Of what no effect explains: {lost}." if lost else ""
    return [words for words in (note(d), besides) if words]


def details(d: dict) -> list[str]:
    """What a specialist asks for: the test's p-value, likelihoods and distances, further errors, noise."""
    return [
        words
        for words in (
            _test(d),
            *(_evidence(effect) for effect in faults_first(d.get("effects") or [])),
            *(d.get("details") or []),
            *skills(d),
            *further(d),
            *noise_told(d),
        )
        if words
    ]


def _test(d: dict) -> str:
    p_value, level = d["mismatch"].get("p_value"), d["mismatch"].get("alpha")
    if p_value is None:
        return ""
    at = "" if level is None else f", level {number(level)}"
    return f"Test for any mismatch: {p_words(p_value)}{at}."


def _evidence(effect: dict) -> str:
    """Log likelihood that a finding adds, and how far the next explanation lies; empty where not known."""
    evidence = effect.get("evidence") or {}
    if evidence.get("gain") is None:
        return ""
    name = class_words(effect["members"], limit=1 + len(effect["members"]))
    words = f"{name[:1].upper()}{name[1:]}: log-likelihood gain {number(evidence['gain'])} nats"
    if evidence.get("runner_up") is not None:
        words += f"; distance D to the nearest other explanation {number(evidence['runner_up'])}"
    return f"{words}."


def untestable(d: dict) -> list[tuple[str, str]]:
    """Effects that another recording of this valve could test: (effect, what it needs)."""
    return [(spoken(item["name"]), _needs(item.get("needs"))) for item in untested(d)]


def untestable_by_need(d: dict) -> list[tuple[str, list[str]]]:
    """What would be needed, and which effects could be tested with it; of many the first few."""
    found: dict[str, list[str]] = {}
    for name, needs in untestable(d):
        found.setdefault(needs, []).append(name)
    return [
        (needs, [*names[:3], f"{len(names) - 3} others"] if len(names) > _MANY else names)
        for needs, names in found.items()
    ]


def _needs(needs: object) -> str:
    """What an effect needs, as it follows "without": signals are said to be recorded ones."""
    asked = (
        [str(need) for need in needs] if isinstance(needs, list | tuple) else str(needs or "").split(" and ")
    )
    roles = [role for each in asked for role in each.split(" and ")]
    if roles and set(roles) <= _ROLES:
        return f"{either([_article(role) for role in roles], 'and')} recorded"
    return " and ".join(asked) or "another recording"


def _article(role: str) -> str:
    words = role_words(role)
    return f"{'an' if words[0] in 'aeiou' else 'a'} {words}"


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
        rows.append(("Size where it acts", in_recorded(d, role, unknown["size"])))
    if unknown.get("share") is not None:
        holds = f"{percent(unknown['share'])} of its variance"
        formula = unknown.get("formula")
        words = (
            f"{formula} (explains {holds})" if formula else f"no short formula (the best explains {holds})"
        )
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
    history = (told.pop("history", None) or {}) if since_history(d) else {}
    if several:
        told.pop("recording_sha256", None)
    rows = [
        (names.get(key, key.replace("_", " ")), "unknown" if value is None else str(value))
        for key, value in told.items()
    ]
    for each in several:
        checksum = f", SHA-256 {each['sha256']}" if each["sha256"] else ""
        rows.append((f"recording {each['source']}", f"{each['rows']} rows{checksum}"))
    for each in history.get("recordings") or []:
        rows.append((f"history {each['name']}", f"SHA-256 {each['sha256'] or 'unknown'}"))
    return rows
