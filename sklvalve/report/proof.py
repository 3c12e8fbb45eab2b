# SPDX-License-Identifier: BSD-3-Clause
"""On which rows the errors of a diagnosis were taken, in words.

``proof`` of a diagnosis says it: ``later_rows``, after those used for finding, which no step has seen;
``forward``, rows ahead of those that the parameters were fitted to, while the effect was chosen on all rows;
or ``four_blocks``, each predicted by fits to the other three.
"""

import numpy as np

from sklvalve.report.words import number, role_words, spoken, with_unit

LATER_ROWS, FORWARD, FOUR_BLOCKS = "later_rows", "forward", "four_blocks"


def with_proof(d: dict, traces: dict) -> dict:
    """A diagnosis that says on which rows its errors were taken, by its traces where it does not itself.

    Parameters
    ----------
    d : dict
    traces : dict
        Of the same diagnosis. Where rows lie behind those used, a simulation that runs on through them was
        judged there; one of which nothing is shown there was not.
    """
    if "proof" in d or "until" not in traces:
        return d
    until = traces["until"]
    behind = [np.asarray(values, dtype=float)[until:] for values in traces.get("nominal", {}).values()]
    ran_on = bool(until) and any(np.isfinite(values).any() for values in behind)
    return d | {"proof": LATER_ROWS if ran_on else FOUR_BLOCKS}


def held_out_rows(d: dict) -> int:
    """Largest number of rows on which a signal's error was taken; 0 where that is not known."""
    return max((fit.get("held_out_rows") or 0 for fit in (d.get("fit") or {}).values() if fit), default=0)


def heading(d: dict) -> str:
    """What goes above a table of errors, to stand after 'Error'."""
    count = held_out_rows(d)
    rows = f"{count} " if count else ""
    if d.get("proof") == LATER_ROWS:
        return f"on {rows}unseen rows"
    if d.get("proof") == FORWARD:
        return f"on {rows}forecast rows"
    return f"on {rows}rows, held out in turn" if d.get("proof") == FOUR_BLOCKS else f"on {rows}held-out rows"


def note(d: dict) -> str:
    """What the errors prove, and what they do not; empty where that is not known."""
    if d.get("proof") == LATER_ROWS:
        return "No earlier step used these rows, neither to find what is missing nor to fit it."
    chosen = "The verdict was reached on all rows; use --until to evaluate on untouched data."
    if d.get("proof") == FORWARD:
        return (
            "Forecasts: fits to the first 40, 55, 70 and 85 % of the rows each predict the next 15 %. "
            f"{chosen}"
        )
    if d.get("proof") == FOUR_BLOCKS:
        words = "Cross-validated in four blocks: each is predicted by fits to the other three."
        return f"{words} {chosen}"
    return ""


def error_words(d: dict, role: str) -> str:
    """An error and the rows on which it was taken: ``flow error on 1440 unseen rows``."""
    if d.get("proof") == FOUR_BLOCKS:
        return f"cross-validated {role_words(role)} error"
    count = ((d.get("fit") or {}).get(role) or {}).get("held_out_rows")
    if d.get("proof") == FORWARD:
        return f"{role_words(role)} error on {f'{count} ' if count else ''}forecast rows"
    kind = "unseen" if d.get("proof") == LATER_ROWS else "held-out"
    return f"{role_words(role)} error on {f'{count} ' if count else ''}{kind} rows"


def left_out(d: dict) -> str:
    """Why what no effect explains is not in the corrected simulation; empty where it is, or there is none."""
    unknown = d.get("unknown") or {}
    correction = unknown.get("correction") or {}
    if correction.get("added", True):
        return ""
    role = unknown["signal"]
    words = "it could not be modelled well enough to predict"
    without, learnt = correction.get("rmse_without"), correction.get("rmse_with")
    if without is None or learnt is None:
        return f"{words} and is not in the corrected simulation"
    unit = ((d.get("fit") or {}).get(role) or {}).get("unit")
    scale, unit = (100.0, "%") if unit == "1" else (1.0, unit)
    better = "helped too few of four blocks" if learnt < without else "made it worse"
    return (
        f"{words}: a correction fitted to three blocks {better} when it predicted the fourth "
        f"({role_words(role)} error {number(scale * without)} without it, "
        f"{with_unit(scale * learnt, unit)} with it), so it was left out"
    )


def further(d: dict) -> list[str]:
    """What else an error was taken of, a sentence each: outside the range fitted, elsewhere, of a rival."""
    lines = []
    for role, fit in (d.get("fit") or {}).items():
        rmse = (fit or {}).get("rmse") or {}
        if rmse.get("nominal") == rmse.get("corrected"):
            continue
        scale, unit = (100.0, "%") if fit.get("unit") == "1" else (1.0, fit.get("unit"))
        name = role_words(role)
        across = (fit.get("interleaved") or {}).get("rmse") or {}
        if None not in (across.get("nominal"), across.get("corrected")):
            lines.append(
                f"With each quarter predicted by fits to the other three, the {name} error is "
                f"{with_unit(scale * across['corrected'], unit)} "
                f"({number(scale * across['nominal'])} without the correction)."
            )
        if "extrapolation" in fit:
            far = fit["extrapolation"]
            error = {kind: number(scale * value) for kind, value in far["rmse"].items()}
            lines.append(
                f"With fits to {number(100.0 * far['fitted_from'])} to {number(100.0 * far['to'])} % "
                f"{role_words(far['signal'])} only, the {name} error outside that range is "
                f"{error['corrected']} {unit} ({error['nominal']} without the correction, black box "
                f"{error['black_box']})."
            )
        if "elsewhere" in fit:
            error = {kind: number(scale * value) for kind, value in fit["elsewhere"]["rmse"].items()}
            lines.append(
                f"In rows where what was found has less than a quarter of its largest effect, the {name} "
                f"error is {error['corrected']} {unit} ({error['nominal']} without the correction)."
            )
        if "ruled_out" in fit:
            rival = fit["ruled_out"]
            lines.append(
                f"With the best explanation that was ruled out ({spoken(rival['name'])}) the {name} error is "
                f"{with_unit(scale * rival['rmse'], unit)}."
            )
    return lines
