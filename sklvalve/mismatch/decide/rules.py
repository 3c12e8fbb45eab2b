# SPDX-License-Identifier: BSD-3-Clause
"""The rules that decide, in their order: each a question, its value, its limit, and the answer in words.

A name stands where all of them are passed. The first that is not says why there is none. A rule that was
never asked, because an earlier one had decided, is not in the list.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from sklvalve.mismatch import constants

#: Names of the rules, in their order.
ORDER = (
    "data", "rarity", "relevance", "held_out", "history_noise", "residual", "noise", "forecast", "black_box",
    "probability",
)  # fmt: skip


@dataclass(frozen=True)
class Rule:
    """One rule and its outcome.

    Attributes
    ----------
    name : str
        Of `ORDER`.
    value : float or None
        What was measured; None where the rule asks no number.
    limit : float or None
        What it was held against.
    passed : bool
        Whether a name may stand as far as this rule goes.
    sentence : str
        The outcome, for people.
    """

    name: str
    value: float | None
    limit: float | None
    passed: bool
    sentence: str


def data(fault: str | None) -> Rule:
    """No column may be exchanged or of the wrong unit, and no historian may have made what was found.

    Parameters
    ----------
    fault : str or None
        What is wrong with the data and what to do, for people; None where nothing is.
    """
    return Rule("data", None, None, fault is None, fault or "The data cannot have made the difference.")


def rarity(p_value: float, alpha: float) -> Rule:
    """Few healthy recordings may look as far from their simulation."""
    return Rule(
        "rarity",
        p_value,
        alpha,
        p_value <= alpha,
        f"A difference this large occurs in {percent(p_value)} of healthy simulated recordings; at most "
        f"{percent(alpha)} may, for something to be missing.",
    )


def relevance(p_value: float, alpha: float) -> Rule:
    """What was found must be larger than what counts in practice, by more than chance."""
    return Rule(
        "relevance",
        p_value,
        alpha,
        p_value <= alpha,
        f"The probability that chance lifts a difference too small to count this high is {percent(p_value)}; "
        f"at most {percent(alpha)} is allowed.",
    )


def held_out(errors: float) -> Rule:
    """It must gain on rows left out of its fit, and in more than one event: what happened once is no name."""
    limit = constants.HELD_OUT_ERRORS
    return Rule(
        "held_out",
        errors,
        limit,
        errors >= limit,
        f"Its gain on rows left out of the fit is {errors:.2g} times its scatter from block to block; "
        f"{limit:g} is the least.",
    )


def history_noise(p_value: float) -> Rule:
    """What is named must explain a recording down to the noise of the valve's history."""
    limit = constants.NO_IMITATION
    return Rule(
        "history_noise",
        p_value,
        limit,
        p_value > limit,
        f"With the finding, {percent(p_value)} of healthy simulated valves leave as much over beyond the "
        f"noise of their history; more than {percent(limit)} must, for a name.",
    )


def nameless(sentence: str) -> Rule:
    """A pattern that no effect makes, told by the rows themselves, must not be there."""
    return Rule("residual", None, None, False, sentence)


def residual(unknown: float, explained: float) -> Rule:
    """What no effect explains must be small beside what the effects explain."""
    limit = constants.RESIDUAL_SHARE
    share = unknown / explained if explained > 0.0 else (float("inf") if unknown > 0.0 else 0.0)
    words = (
        f"The unexplained part is {percent(share)} of the explained part"
        if explained > 0.0
        else "No effect explains any part of the difference"
    )
    return Rule("residual", share, limit, share <= limit, f"{words}; at most {percent(limit)} is allowed.")


def pattern(posterior: float, over: str) -> Rule:
    """A smooth pattern without an equation, since a history, must not be likely beside a name."""
    limit = constants.PATTERN_POSTERIOR
    return Rule(
        "residual",
        posterior,
        limit,
        posterior <= limit,
        f"Of the posterior, {percent(posterior)} is on the side of a smooth pattern over {over} beside the "
        f"finding, since the history; at most {percent(limit)} may be.",
    )


def noise(times: float | None, passed: bool) -> Rule:
    """The flow must be explained down to the noise of a valve at rest, by no two slow effects that add up.

    Parameters
    ----------
    times : float or None
        Slow residual of the flow over what noise and tolerances allow; None where too few rows are at rest.
    passed : bool
        A wander of the meter may explain more where no effect on the flow is named, and two effects that both
        follow time or temperature are no names however little they leave.
    """
    limit = constants.TIMES_ALLOWED
    words = (
        "Too few rows are at rest to say what noise allows"
        if times is None
        else f"Where the flow is steady the error is {times:.2g} times what noise and tolerances allow; "
        f"{limit:g} times is the limit"
    )
    below = times is None or times <= limit
    if passed and not below:
        words += ", but a wander of the meter may explain as much"
    if below and not passed:
        words += ", but two slow effects together can mimic almost any third"
    return Rule("noise", times, limit, passed, f"{words}.")


def forecast(rise: float, corrected: float, nominal: float) -> Rule:
    """The correction must not make forecasts of later rows worse by more than chance.

    Parameters
    ----------
    rise : float
        What it adds to the squared error, in standard errors.
    corrected, nominal : float
        The squared errors.
    """
    limit = constants.FORECAST_ERRORS
    if nominal > 0.0:
        words = f"On forecast rows the corrected simulation has {corrected / nominal:.2g} times the squared "
        words += "error of the nominal one"
    else:
        words = "On forecast rows the nominal simulation has no error"
        words += ", and the corrected one has" if rise > 0.0 else ""
    if 0.0 < rise < float("inf"):
        words += f"; it rises by {rise:.2g} times its standard error, and {limit:g} is the limit"
    return Rule(
        "forecast",
        rise,
        limit,
        rise <= limit,
        f"{words}.",
    )


def black_box(ratio: float, limit: float, passed: bool, beside: bool = False) -> Rule:
    """No black box may forecast clearly better than the simulation that a diagnosis ends with.

    `beside` of a name that stands: it shows that something else is missing too.
    """
    return Rule(
        "black_box",
        ratio,
        limit,
        passed,
        f"On forecast rows the simulation has {ratio:.2g} times the error of a black box on the same "
        f"signals; {limit:g} times, in nearly every stretch, is the limit"
        + (": something else is missing beside what is named." if beside else "."),
    )


def probability(value: float | None, passed: bool, reason: str = "") -> Rule:
    """The likeliest class must be likely enough by what was borne out before.

    `reason` is that of its grade, where the grade and not the probability stops it.
    """
    limit = constants.NAMED_FROM
    if value is not None and value >= limit and not passed:
        return Rule("probability", value, limit, False, reason or "The evidence is weak.")
    sentence = (
        "How often such a diagnosis is right was not checked on recordings like this one; the grade decides."
        if value is None
        else f"In blind tests {percent(value)} of such classes held the true name; {percent(limit)} is "
        "needed for a name."
    )
    return Rule("probability", value, limit, passed, sentence)


def known_before(sentence: str) -> Rule:
    """The history must tell what is new, or nothing says how probable a change is."""
    return Rule("probability", None, constants.NAMED_FROM, False, sentence)


def in_order(rules: Iterable[Rule]) -> list[Rule]:
    """The last outcome of every rule that was asked, in the order of the list."""
    last = {rule.name: rule for rule in rules}
    return [last[name] for name in ORDER if name in last]


#: Rules on a fit; what is named by events or by the last rows alone is held against its own.
OF_A_FIT = ("relevance", "held_out")


def without(rules: Iterable[Rule], names: Iterable[str]) -> tuple[Rule, ...]:
    """Rules but those of some names."""
    return tuple(rule for rule in rules if rule.name not in tuple(names))


def passed(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """Rules but those that stopped a name."""
    return tuple(rule for rule in rules if rule.passed is not False)


def without_pattern(rules: Iterable[Rule]) -> tuple[Rule, ...]:
    """Rules without the outcome of `nameless`, of a pattern that was taken back."""
    return tuple(rule for rule in rules if rule.name != "residual" or rule.value is not None)


def percent(share: float) -> str:
    """A share in percent, as far as it is worth telling."""
    if share == float("inf"):
        return "all"
    if 0.0 < share < 1e-4:
        return "less than 0.01 %"
    return f"{100.0 * share:.2g} %" if share < 0.995 else f"{100.0 * share:.0f} %"
