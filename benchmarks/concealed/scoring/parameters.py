# SPDX-License-Identifier: BSD-3-Clause
"""How far the main parameter is from the concealed size, and whether its 95 % interval holds it."""

from dataclasses import dataclass

from benchmarks.concealed.scoring.lines import (
    concealed,
    entries_of,
    grouped,
    names_of,
    size_step,
)
from benchmarks.concealed.scoring.rates import Estimate, Rate, quantile_of, rate_of

# Why no interval is looked at; what makes the records says the same of each effect.
NOT_ONE_QUANTITY = (
    "wrong_characteristic (the plant blends two curves, the catalogue bends one)",
    "capacity_error, flow_meter_gain, flow_meter_bias and position_sensor_bias from the start (how much of "
    "them is calibration, nobody can say); later ones are looked at",
    "effects found in a form with another parameter (a share of air for a lag, a jump for stiction, a span "
    "that drifts)",
    "members of a class that are not its first, whose parameters alone are told",
)

# play between stem and position sensor, as the simulators call it
_LINKED = {"link_backlash", "linkage_backlash"}


def intervals(line):
    """For each main parameter whose class begins with the true name: (effect, inside, error).

    `inside` is None where the diagnosis gives no interval; the error is relative to the true size.
    """
    truth = line["truth"]
    for name, told in (truth.get("parameters") or {}).items():
        for entry in entries_of(line) if told else ():
            given = (entry.get("parameters") or {}).get(told.get("parameter"))
            if names_of(entry)[:1] != [name] or given is None or given.get("unit") != told.get("unit"):
                continue
            # play before and behind the position sensor share a name, not a quantity
            linked = bool(_LINKED & set(truth.get("concealed") or ()))
            if name == "backlash" and linked == ("overshoot" in entry["parameters"]):
                continue
            value, true = given.get("value"), told.get("value")
            if value is None or not true:
                continue
            ends = given.get("ci95")
            inside = None if not ends or None in ends else ends[0] <= true <= ends[1]
            yield name, inside, abs(value / true - 1.0)


@dataclass(frozen=True)
class Accuracy:
    """Of a group of parameters found.

    Attributes
    ----------
    of : int
        Parameters found in a class that begins with the true name.
    median, ninth : Estimate
        Half and nine tenths of the relative errors are below it.
    coverage : Rate
        The 95 % interval holds the true size, of those that have an interval.
    """

    of: int
    median: Estimate
    ninth: Estimate
    coverage: Rate


def accuracy(lines, step=None):
    """`Accuracy` of all parameters found; of records of one planned size where `step` is given."""
    some = [line for line in lines if step is None or size_step(line) == step]
    return _accuracy([(inside, error) for line in some for _, inside, error in intervals(line)])


def accuracy_by_size(lines):
    """(size, `Accuracy`) of each planned size."""
    steps = grouped(lines, size_step)
    return [(step, accuracy(steps[step])) for step in sorted(steps)]


def accuracy_by_effect(lines):
    """(generator's own name, or name of the catalogue within a pair; `Accuracy`) of each effect found."""
    found: dict = {}
    for line in lines:
        alone = len(line["truth"].get("effects") or ()) == 1
        for name, inside, error in intervals(line):
            found.setdefault(concealed(line) if alone else name, []).append((inside, error))
    return [(name, _accuracy(found[name])) for name in sorted(found)]


def _accuracy(found):
    errors = [error for _, error in found]
    return Accuracy(
        len(found),
        quantile_of(errors, 0.5, unit="%", digits=0),
        quantile_of(errors, 0.9, unit="%", digits=0),
        rate_of(inside for inside, _ in found),
    )
