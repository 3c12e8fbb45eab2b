# SPDX-License-Identifier: BSD-3-Clause
"""Verdict of a loop, its grade, and the sentences it rests on."""

from collections.abc import Sequence
from typing import Any

import sklvalve.mismatch.loop.constants as constants
from sklvalve.mismatch.effects.base import Quantity, Shown
from sklvalve.mismatch.loop.classify import StickingClass
from sklvalve.mismatch.loop.forecasts import Forecasts
from sklvalve.mismatch.loop.signals import LoopSignals
from sklvalve.mismatch.loop.stretch import StretchResult

#: Parameters of a stem that sticks in a loop, shares of the command's range.
STICK_AND_SLIP = (
    Quantity("stick", "1", 0.0, 1.0, (), shown=Shown("dead band plus stick band", "% of travel", 100.0)),
    Quantity("slip", "1", 0.0, 1.0, (), shown=Shown("slip jump", "% of travel", 100.0)),
)


def judge_undetected(results: Sequence[StretchResult], result: StretchResult) -> tuple[str, str]:
    """Verdict on a loop whose p-value is not within the level, and the sentence it rests on.

    Parameters
    ----------
    results : sequence of StretchResult
        Of every stretch.
    result : StretchResult
        The one that speaks most for sticking.
    """
    if max(each.response_gain for each in results) <= constants.VISIBLE_RESPONSE:
        return "cannot_tell", (
            "The value does not visibly follow the command: the loop moves too little for its noise."
        )
    if all(map(_excludes, results)):
        return "no_mismatch", (
            f"{_relevant_bands()} explain the value clearly worse than the command itself."
        )
    return "cannot_tell", _why_undecided(result)


def _why_undecided(result: StretchResult) -> str:
    """Why sticking is neither called nor excluded."""
    if result.turns < constants.FEWEST_TURNS:
        return (
            "The command goes one way only, so a dead band looks the same as a supply or a gain that drifts."
        )
    if result.largest_gain < -constants.EXCLUDED_BY:
        return (
            f"{_relevant_bands()} explain the value clearly worse than the command itself, but "
            f"{_doubt(result)}, so they are not excluded."
        )
    if result.evidence > 0.0:
        return (
            f"{_band(result.band_share, result.loop.span)} explains the value somewhat better than the "
            "command itself, as in healthy loops too."
        )
    if result.largest_gain > 0.0:
        return (
            "A dead band explains the value better than the command itself with one noise model, and worse "
            "with another."
        )
    outside = result.comparison.command.regression.oscillation is not None
    beside = " beside an outside oscillation" if outside else ""
    return (
        f"{_relevant_bands()} explain the value only somewhat worse than the command itself{beside}, so they "
        "are not excluded."
    )


def _relevant_bands() -> str:
    """The bands that are called sticking."""
    return f"Dead bands of {_percent(constants.RELEVANT_BAND)} or more of the command's movement"


def format_named(band_share: float, span: float) -> str:
    """The sentence of a loop that sticks, by its band [share of the command's movement] and that movement."""
    return f"{_band(band_share, span)} explains the value better than the command itself."


def _band(band_share: float, span: float) -> str:
    """A dead band in percent of the command's range and of its movement."""
    share, movement = _percent(band_share * span), _percent(band_share)
    return f"A dead band of {share} of the command's range ({movement} of its movement)"


def format_details(results: Sequence[StretchResult], result: StretchResult) -> tuple[str, ...]:
    """What the verdict rests on in figures, for a specialist; parameters as in `judge_undetected`."""
    largest = max(each.largest_gain for each in results)
    return (
        f"Log likelihood of the best sticking stem minus that of the command itself: {result.evidence:.0f} "
        f"nats, over {_turns(result)} of the command.",
        f"The most that any noise says for a dead band of {_percent(constants.RELEVANT_BAND)} or more of the "
        f"command's movement: {largest:.0f} nats.",
    )


def _doubt(result: StretchResult) -> str:
    """Why a stretch does not exclude bands that explain the value clearly worse."""
    if len(result.loop.gain_signs) > 1:
        return "it is uncertain whether a larger command raises or lowers the value"
    if _rows_per_swing(result) < constants.FEWEST_ROWS_PER_SWING:
        return f"one swing of the command has only {_rows_per_swing(result):.0f} rows"
    if result.small_band_gain >= constants.SMALL_BAND_FITS:
        return "a smaller dead band explains it better"
    return "not in every part of the recording"


def _turns(result: StretchResult) -> str:
    """Number of turns of the command, in words."""
    return f"{result.turns} turn{'' if result.turns == 1 else 's'}"


def _percent(share: float) -> str:
    """A share in percent, two digits of it."""
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"


def _excludes(result: StretchResult) -> bool:
    """Whether a stretch excludes sticking of a relevant size; each condition is measured in `constants`."""
    return (
        result.largest_gain < -constants.EXCLUDED_BY
        and result.small_band_gain < constants.SMALL_BAND_FITS
        and len(result.loop.gain_signs) == 1
        and _rows_per_swing(result) >= constants.FEWEST_ROWS_PER_SWING
    )


def _rows_per_swing(result: StretchResult) -> float:
    """Rows from one turn of the command to the next of its kind."""
    return 2.0 * len(result.loop.time) / max(result.turns, 1)


def check_by_forecasts(verdict: str, forecasts: Forecasts) -> tuple[str, tuple[str, ...]]:
    """Verdict held against forecasts of rows ahead in time, and what they add in sentences.

    It is ``cannot_tell`` in place of ``no_mismatch`` where a black box is clearly better.
    """
    if verdict == "named" and not forecasts.helps:
        return verdict, (
            "A simulated sticking stem does not lower the error on forecast rows: no correction is applied.",
        )
    if verdict == "no_mismatch" and forecasts.clearly_better:
        return "cannot_tell", (
            f"But a black box forecasts the value {forecasts.ratio:.1f} times better, so something may be "
            "missing.",
        )
    return verdict, ()


def grade_of(result: StretchResult, helps: bool) -> dict[str, str]:
    """How strong the evidence of a class is (strong, moderate or weak), and the reason.

    No frequency was checked, so there is no probability. Sticking that does not help, that is lower the error
    on rows ahead in time, is no more than moderate.
    """
    reached = (
        name
        for name, evidence, turns in constants.GRADES
        if result.evidence >= evidence and result.turns >= turns
    )
    level = next(reached, "weak")
    level = "moderate" if level == "strong" and not helps else level
    return {"level": level, "reason": _why_this_grade(result, level, helps)}


def _why_this_grade(result: StretchResult, level: str, helps: bool) -> str:
    """What holds a grade back; of a strong one, what speaks for it."""
    _, evidence, turns = constants.GRADES[1] if level == "weak" else constants.GRADES[0]
    if result.turns < turns:
        return f"The command makes only {_turns(result)}."
    if result.evidence < evidence:
        return "A sticking stem explains the value only somewhat better than the command itself."
    if not helps:
        return "A sticking stem does not lower the error on forecast rows."
    return (
        "A sticking stem explains the value far better than the command itself, over "
        f"{_turns(result)} of the command."
    )


def effect_of(sticking: StickingClass, loop: LoopSignals, grade: dict[str, str]) -> dict[str, Any]:
    """The class of sticking and play as an effect of diagnosis.json.

    It has the sizes of the likeliest stem [fraction of the command's range] and how far they are known; its
    probabilities are None.
    """
    names = sorted(sticking.shares, key=lambda name: -sticking.shares[name])
    upper = ["upper"] if sticking.stick_interval[1] >= 1.0 else []
    lower = ["lower"] if sticking.stick_interval[0] <= constants.RELEVANT_BAND * loop.span else []
    return {
        "members": [{"name": name, "probability": None} for name in names],
        "probability": None,
        "grade": grade,
        "blocks": ["actuator"],
        "parameters": {
            "stick": _size(sticking.stick, sticking.stick_interval, lower + upper),
            "slip": _size(sticking.slip, sticking.slip_interval, upper),
        },
        "sentence": _stays(sticking, loop, lower + upper),
        "separated_by": (
            "Ramp the command slowly through a reversal with the stem's position recorded: a jump is "
            "stiction, a smooth start is play."
        ),
    }


def _size(value: float, interval: tuple[float, float], unknown_ends: list[str]) -> dict[str, Any]:
    """A size as diagnosis.json has it."""
    return {"value": value, "unit": "1", "ci95": list(interval), "unknown_ends": unknown_ends}


def _stays(sticking: StickingClass, loop: LoopSignals, unknown_ends: list[str]) -> str:
    """How far the command turns before the stem follows."""
    low, high = map(_percent, sticking.stick_interval)
    at_least = " or more" if sticking.stick >= constants.WHOLE_MOVEMENT * loop.span else ""
    within = f"{low} to {high}"
    if "upper" in unknown_ends:
        within = f"{low} or more"
    elif "lower" in unknown_ends:
        within = f"{high} or less"
    jump = f"jumps by {_percent(sticking.slip)}"
    if "backlash" in sticking.shares:
        jump = "follows; whether it jumps is not known"
    return (
        f"The stem stays until the command has turned by {_percent(sticking.stick)} of its range{at_least} "
        f"(95 %: {within}), and then {jump}."
    )


def sampling_of(
    loop: LoopSignals, results: Sequence[StretchResult], result: StretchResult
) -> tuple[dict[str, Any], tuple[str, ...]]:
    """How the rows of the whole loop were used, as plain data [s] and in sentences.

    The sentences are none where every row counts as it was recorded. `results` and `result` are as in
    `judge_undetected`.
    """
    spans = [[float(each.loop.time[0]), float(each.loop.time[-1])] for each in results]
    begin, end = spans[results.index(result)]
    sampling = {
        "recorded": loop.recorded_sample_time,
        "used": loop.sample_time,
        "averaged_rows": loop.decimation,
        "stretches": spans,
        "stretch": [begin, end],
    }
    sentences = []
    if loop.decimation > 1:
        sentences.append(
            f"Each row used is the mean of {loop.decimation} recorded rows ({loop.sample_time:.3g} s); a "
            f"swing of {loop.period:.3g} s has {loop.period / loop.sample_time:.0f} of them."
        )
    if len(results) > 1:
        sentences.append(
            f"The recording is long: {len(results)} stretches of {len(result.loop.time)} rows were examined, "
            f"and the figures are those of {begin:.6g} s to {end:.6g} s."
        )
    return sampling, tuple(sentences)
