# SPDX-License-Identifier: BSD-3-Clause
"""The noise that a recording tells of its signals by itself, in sentences."""

from sklvalve.report.place import change_words
from sklvalve.report.words import number, role_words, with_unit


def noise_told(d: dict) -> list[str]:
    """Noise told without a model, a line a signal; none for a signal of which the recording tells nothing."""
    change = (d.get("location") or {}).get("change") or {}
    dated = {change["signal"]: change_words(d["location"])} if change else {}
    return [
        words
        for role, fit in (d.get("fit") or {}).items()
        if (words := _of_channel(role, fit or {}, dated.get(role, ""))) != ""
    ]


def _of_channel(role: str, fit: dict, changed: str) -> str:
    told = fit.get("model_free") or {}
    scale, unit = (100.0, "%") if told.get("unit") == "1" else (1.0, told.get("unit"))
    steady, repeats = told.get("steady") or {}, told.get("repeats") or {}
    parts = []
    if steady.get("value") is not None:
        value = with_unit(scale * steady["value"], unit)
        parts.append(f"{value} quick, where nothing moves ({steady['rows']} rows)")
    if repeats.get("value") is not None:
        value = with_unit(scale * repeats["value"], unit)
        parts.append(f"{value} with wander, play and friction, where all comes back ({repeats['rows']} rows)")
    if not parts:
        return ""
    words = [f"Noise of {role_words(role)}, told without a model: {'; '.join(parts)}."]
    if told.get("noise_model_above_steady"):
        words.append(
            "The noise model is clearly above what rests show: it may have taken up physics that is missing."
        )
    if told.get("repeats_above_steady"):
        why = f"it changed {changed}" if changed else "it remembers, or has changed in time"
        words.append(f"What comes back differs by more than noise: {why}.")
    error = (fit.get("rmse") or {}).get("corrected")
    if told.get("at_repeats") and error is not None:
        words.append(f"The error of {number(scale * error)} is no more: nothing is left to explain.")
    return " ".join(words)
