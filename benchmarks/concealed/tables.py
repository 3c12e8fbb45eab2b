# SPDX-License-Identifier: BSD-3-Clause
"""Tables of a blind trial, from the lines that score.py wrote; every rate with its exact 95 % interval."""

from collections import Counter, defaultdict

import numpy as np
from scipy.stats import beta

SINGLE = ("right", "wrong name", "cannot tell", "none of these", "missed", "failed")
PAIR = ("both found", "one found", "neither", "wrong name", "failed")
# Why no interval is looked at; sklvalve/datasets/_plant_parameters.py says the same of each effect.
NOT_ONE_QUANTITY = (
    "wrong_characteristic (the plant blends two curves, the catalogue bends one)",
    "capacity_error, flow_meter_gain, flow_meter_bias and position_sensor_bias from the start (how much of "
    "them is calibration, nobody can say); later ones are looked at",
    "effects found in a form with another parameter (a share of air for a lag, a jump for stiction, a span "
    "that drifts)",
    "members of a class that are not its first, whose parameters alone are told",
)


def classes_of(found):
    """Names by class, the most probable class first."""
    return [{member["name"] for member in entry["members"]} for entry in found["effects"]]


def judge(row):
    """One word for what came of a record.

    A class that holds no true name is a `wrong name`, also where the verdict is that it cannot tell.
    """
    truth = row["truth"]
    if "failed" in row:
        return "failed"
    found, true = row["found"], set(truth["effects"])
    classes, verdict = classes_of(found), found["verdict"]
    if not true and truth["verdict"] == "no_mismatch":
        return "right" if verdict == "no_mismatch" else "alarm"
    if any(not names & true for names in classes):
        return "wrong name"
    if not true:
        plain = {"none_of_these": "right", "cannot_tell": "cannot tell", "no_mismatch": "missed"}
        return plain.get(verdict, "wrong name")
    seen = [any(name in names for names in classes) for name in true] if verdict == "named" else [False]
    if len(true) > 1:
        return "both found" if all(seen) else "one found" if any(seen) else "neither"
    if all(seen):
        return "right"
    return {"cannot_tell": "cannot tell", "none_of_these": "none of these"}.get(verdict, "missed")


def exact(count, of):
    """Clopper and Pearson's 95 % interval of a rate, in percent."""
    low = beta.ppf(0.025, count, of - count + 1) if count > 0 else 0.0
    high = beta.ppf(0.975, count + 1, of - count) if count < of else 1.0
    return 100.0 * low, 100.0 * high


def rate(count, of):
    """Text of a rate and its interval."""
    if of == 0:
        return "-"
    low, high = exact(count, of)
    return f"{100.0 * count / of:.0f} % ({low:.0f}-{high:.0f})"


def class_size(row):
    """Names in the class that holds the true one."""
    true = set(row["truth"]["effects"])
    return next(len(names) for names in classes_of(row["found"]) if names & true)


def intervals(row):
    """For each main parameter whose class begins with the true name: (effect, inside, error), or None inside.

    `inside` is None where the diagnosis gives no interval, and the error is relative to the true size.
    """
    truth = row["truth"]
    for name, told in truth.get("parameters", {}).items():
        for entry in row.get("found", {"effects": []})["effects"]:
            given = entry["parameters"].get(told["parameter"])
            if entry["members"][0]["name"] != name or given is None or given["unit"] != told["unit"]:
                continue
            # play before and behind the position sensor share a name, not a quantity
            linked = "linkage_backlash" in truth["concealed"]
            if name == "backlash" and linked == ("overshoot" in entry["parameters"]):
                continue
            ends, true = given["ci95"], told["value"]
            inside = None if ends is None else ends[0] <= true <= ends[1]
            yield name, inside, abs(given["value"] / true - 1.0)


def _table(head, lines):
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head)] + lines)


def _line(cells):
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def _by(rows, label, key, outcomes, sizes=True):
    groups = defaultdict(list)
    for row in rows:
        groups[key(row)].append(row)
    lines = []
    for name, group in [*sorted(groups.items()), ("all", rows)]:
        counted = Counter(judge(row) for row in group)
        cells = [name, len(group), *(counted[o] for o in outcomes)]
        cells += [rate(counted[outcomes[0]], len(group)), rate(counted["wrong name"], len(group))]
        if sizes:
            held = [class_size(row) for row in group if judge(row) == "right"]
            cells.append(f"{np.mean(held):.1f}" if held else "-")
        lines.append(_line(cells))
    head = [label, "records", *outcomes, outcomes[0] + " (95 %)", "wrong (95 %)"]
    return _table(head + (["mean class"] if sizes else []), lines)


def summary(rows):
    """Text of all tables."""
    kinds = defaultdict(list)
    for row in rows:
        truth = row["truth"]
        few = len(truth["effects"])
        healthy = truth["verdict"] == "no_mismatch"
        kinds["healthy" if healthy else ("nameless", "single")[few] if few < 2 else "pair"].append(row)
    parts = []
    healthy = kinds["healthy"]
    if healthy:
        lines = []
        loops = sorted({(r["truth"]["loop"], r["truth"]["noise"]) for r in healthy})
        for what in [*loops, None]:
            group = [r for r in healthy if what in (None, (r["truth"]["loop"], r["truth"]["noise"]))]
            alarms = sum(judge(r) != "right" for r in group)
            name = "all" if what is None else f"{what[0]}, noise {what[1]:g}"
            lines.append(_line([name, len(group), alarms, rate(alarms, len(group))]))
        parts.append("Healthy\n\n" + _table(["loop", "records", "alarms", "rate (95 %)"], lines))
    single = kinds["single"]
    if single:
        words = "One effect with a name\n\n"
        parts.append(words + _by(single, "effect", lambda r: r["truth"]["concealed"][0], SINGLE))
        parts.append(_by(single, "loop", lambda r: r["truth"]["loop"], SINGLE))
        late = lambda r: "later" if r["truth"]["onset"] > 0.0 else "from the start"  # noqa: E731
        parts.append(_by(single, "begins", late, SINGLE))
        doubtful = sum(judge(r) == "wrong name" and r["found"]["verdict"] == "cannot_tell" for r in single)
        parts.append(f"Of the wrong names, {doubtful} are candidates only, under the verdict cannot_tell.")
    if kinds["nameless"]:
        words = "One effect that no catalogue holds\n\n"
        outcomes = ("right", "cannot tell", "missed", "wrong name", "failed")
        key = lambda r: r["truth"]["concealed"][0]  # noqa: E731
        parts.append(words + _by(kinds["nameless"], "effect", key, outcomes, sizes=False))
    if kinds["pair"]:
        key = lambda r: " + ".join(r["truth"]["concealed"])  # noqa: E731
        parts.append("Two effects\n\n" + _by(kinds["pair"], "effects", key, PAIR, sizes=False))
    parts.append(_coverage(rows))
    seconds = [r["seconds"] for r in rows if "seconds" in r]
    if seconds:
        codes = ", ".join(f"{c} ({n})" for c, n in Counter(r["code"] for r in rows).items())
        parts.append(
            f"{len(rows)} records, {np.median(seconds):.0f} s in the median, {max(seconds):.0f} s at most; "
            f"load {np.mean([r['load'] for r in rows]):.1f}; code {codes}."
        )
    return "\n\n".join(parts)


def _coverage(rows):
    seen = defaultdict(list)
    for row in rows:
        for name, inside, error in intervals(row):
            seen[name].append((inside, error))
    everything = [item for items in seen.values() for item in items]
    lines = []
    for name, items in [*sorted(seen.items()), ("all", everything)]:
        told = [inside for inside, _ in items if inside is not None]
        error = f"{100.0 * np.median([e for _, e in items]):.0f} %" if items else "-"
        lines.append(
            _line([name, len(items), len(items) - len(told), sum(told), rate(sum(told), len(told)), error])
        )
    head = ["effect", "found first", "no interval", "holds it", "coverage (95 %)", "median error"]
    words = "Whether the 95 % interval of the main parameter holds the true size. Not looked at:\n\n"
    words += "".join(f"- {reason}\n" for reason in NOT_ONE_QUANTITY)
    return words + "\n" + _table(head, lines)
