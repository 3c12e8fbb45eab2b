# SPDX-License-Identifier: BSD-3-Clause
"""What the noise of a recording, measured without a model, says of its fit, in sentences."""

from sklvalve.report.place import change_words, located
from sklvalve.report.words import role_words


def noise_told(d: dict) -> list[str]:
    """What measured noise says of each signal; nothing where it says nothing.

    The one noise figure of a report is the floor beside the errors: what these sentences compare with is in
    ``fit.<signal>.model_free`` of diagnosis.json.
    """
    location = located(d)
    change = location.get("change") or {}
    dated = {change["signal"]: change_words(location)} if change else {}
    return [
        words
        for role, fit in (d.get("fit") or {}).items()
        if (words := _of_channel(role, fit or {}, dated.get(role, ""))) != ""
    ]


def _of_channel(role: str, fit: dict, changed: str) -> str:
    told, name = fit.get("model_free") or {}, role_words(role)
    words = []
    if told.get("noise_model_above_steady"):
        words.append(
            f"The fitted noise of {name} exceeds the noise measured while the valve is at rest: it may have "
            "absorbed missing physics."
        )
    if told.get("repeats_above_steady"):
        why = f"it changed {changed}" if changed else "hysteresis or drift"
        words.append(f"Repeated operating points of {name} differ by more than noise: {why}.")
    if told.get("at_repeats"):
        words.append(
            f"The {name} error is no larger than the scatter at repeated operating points: nothing is left "
            "to explain."
        )
    return " ".join(words)
