# SPDX-License-Identifier: BSD-3-Clause
"""What was learnt of a valve, as plain data in recorded units and as a few lines."""

from textwrap import fill
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sklvalve.history import ValveHistory
    from sklvalve.recording import Recording

_INDENT = 14
# parameters that a person asks for: words, and the role in whose unit they are told
_ASKED = {
    "capacity": ("rated capacity", None),
    "flow_zero": ("zero of the flow meter", "flow"),
    "position_zero": ("zero of the position sensor", "opening"),
    "meter_lag": ("lag of the flow meter", None),
}


def content_of(history: "ValveHistory", recording: "Recording", diagnosis: dict) -> dict[str, Any]:
    """Plain data of a history, fit for JSON.

    Parameters
    ----------
    history : ValveHistory
    recording : Recording
        One of those that it was learnt from, for the units.
    diagnosis : dict
        What those hold by themselves.
    """
    from sklvalve.history.operating_range import limits_in_recorded_units
    from sklvalve.report.headline import headline

    effects = [each["members"][0]["name"] for each in diagnosis.get("effects") or [] if each.get("members")]
    held = [{"name": each.name, "onset": (history.onsets or {}).get(each.key)} for each in history.effects]
    return {
        "rows": history.rows,
        "days": history.days,
        "windows": len(history.windows_),
        "recordings": [
            {key: getattr(each, key) for key in ("name", "sha256", "rows", "first", "last")}
            for each in history.recordings_
        ],
        "visited": limits_in_recorded_units(history.range_, recording),
        "noise": {
            channel: {"value": _difference(recording, channel, history.noise_parts(channel).size)}
            | {"unit": recording.unit(channel)}
            for channel in history.channels
        },
        "calibration": _calibration(history),
        "clean": diagnosis["verdict"] == "no_mismatch",
        "held": held,
        "diagnosis": {"verdict": diagnosis["verdict"], "effects": effects, "finding": headline(diagnosis)}
        | {"reasons": list(diagnosis.get("reasons") or [])},
    }


def lines_of(content: dict[str, Any], asked: list[dict[str, Any]], width: int) -> list[str]:
    """Lines of what was learnt.

    Parameters
    ----------
    content : dict
        Of `content_of`.
    asked : list of dict
        Of `asked_of`.
    width : int
        Characters in a line.
    """
    from sklvalve.report.words import role_words, with_unit

    sources = content["recordings"]
    begun, ended = sources[0]["first"], sources[-1]["last"]
    windows = f"{content['windows']} window{'s' if content['windows'] > 1 else ''}"
    told = {
        "Learnt from": f"{', '.join(each['name'] for each in sources)}: {content['rows']} rows, "
        f"{content['days']:.3g} days, in {windows}, from {begun} to {ended}.",
        "Visited": "; ".join(
            f"{role_words(name)} {with_unit(each['low'], None)} to {with_unit(each['high'], each['unit'])}"
            for name, each in content["visited"].items()
        )
        + ".",
        "Noise": "; ".join(
            f"{role_words(name)} {with_unit(each['value'], each['unit'])}"
            for name, each in content["noise"].items()
        )
        + " (standard deviation, from row to row).",
        "Calibration": "; ".join(
            f"{each['words']} {with_unit(each['value'], each['unit'])} (+-{with_unit(each['sd'], None)})"
            for each in asked
        )
        + ".",
        "By itself": _by_itself(content),
    }
    return [
        fill(words, width, initial_indent=f"{what:<{_INDENT}}", subsequent_indent=" " * _INDENT)
        for what, words in told.items()
        if words != "."
    ]


def _by_itself(content: dict[str, Any]) -> str:
    """One sentence on whether the history is clean, and what follows where it is not."""
    from sklvalve.report.words import either, spoken

    if content["clean"]:
        return (
            "The recordings are clean: their diagnosis finds nothing missing in the simulation, within what "
            "the data sheet allows."
        )
    found = f"The recordings are not clean. {content['diagnosis']['finding']}"
    names = either([spoken(each["name"]) for each in content["held"]], "and")
    if names and len(content["held"]) == len(content["diagnosis"]["effects"]):
        return f"{found} The history holds {names}: a later diagnosis tells what has changed since."
    beside = f"The history holds {names} and nothing else of it" if names else "The history cannot hold that"
    return (
        f"{found} {beside}, so that a later diagnosis may take what was there already for a change, or "
        "overlook one. Learn from sound recordings if there are any."
    )


def _calibration(history: "ValveHistory") -> dict[str, dict[str, Any]]:
    """Parameter -> what is expected of it in the next recording, in SI (capacity in m3/h)."""
    from sklvalve.history.then import expected_of

    return {
        each.name: {
            "value": each.value,
            "sd": each.spread * each.value if each.log else each.spread,
            "unit": each.unit,
        }
        for each in expected_of(history)
    }


def asked_of(history: "ValveHistory", recording: "Recording") -> list[dict[str, Any]]:
    """The parameters that a person asks for, in recorded units.

    Parameters
    ----------
    history : ValveHistory
    recording : Recording
        One of those that it was learnt from, for the units.
    """
    told = []
    for name, each in _calibration(history).items():
        if name not in _ASKED:
            continue
        words, role = _ASKED[name]
        value, sd, unit = each["value"], each["sd"], each["unit"]
        if role is not None:
            value, sd = (_difference(recording, role, number) for number in (value, sd))
            sd, unit = abs(sd), recording.unit(role)
        told.append({"name": name, "words": words, "value": value, "sd": sd, "unit": unit})
    return told


def _difference(recording: "Recording", role: str, value: float) -> float:
    """A difference of a signal in SI, in the unit in which it was recorded, whichever sense that has."""
    return float(value * abs(recording.per_si(role)))
