# SPDX-License-Identifier: BSD-3-Clause
"""Right, wrong or abstained: the rules by which an answer is judged, and the referee's two flags.

- No label, no judgement; a crash or a timeout is `failed`, a refusal in a sentence `abstained`.
- `cannot_tell` and `none_of_these` give no name: `abstained`.
- `no_mismatch` is wrong where a fault or a property is labelled, else right.
- A class with a labelled name among its members is right.
- A class of properties only that the label does not list is neither: a label seldom lists them all.
- On a sound valve any other class is a fault that is not there: wrong, whatever else was named.
- On a faulty one the answer is right if a labelled fault is named, and wrong if none is.
"""

#: What a sound valve may have and a simulation may lack; used where no kind is given.
PROPERTIES = frozenset(
    [
        "slew_limit",
        "dead_time",
        "actuator_lag",
        "positioner_characteriser",
        "positioner_deadband",
        "tight_shutoff",
        "choked_flow",
        "cavitation",
        "flashing",
        "gas_expansion",
        "viscous_flow",
        "wrong_characteristic",
        "flow_inertia",
        "line_loss",
        "piping_reducers",
        "capacity_error",
        "sensor_lag",
    ]
)
#: A name given with at least this probability is sure: what the tool calls 94 % is above it.
SURE = 0.9
#: The black box halves the error: issue 27.
HALVES = 0.5


def is_property(effect):
    """Whether every member of a class is a property; a kind that the diagnosis gives goes first."""
    of_class = effect.get("kind")
    kinds = [m.get("kind", of_class) for m in effect["members"]]
    named = zip(kinds, effect["members"], strict=True)
    return all(k == "property" if k in ("property", "fault") else m["name"] in PROPERTIES for k, m in named)


def is_sure(effect):
    """Whether a class is given as sure: by its probability, or by a strong grade where there is none."""
    chance = effect.get("probability")
    if chance is not None:
        return chance >= SURE
    grade = effect.get("grade") or {}
    return grade.get("level") == "strong"


def judged(diagnosis, label):
    """Judgement and whether it is sure.

    Parameters
    ----------
    diagnosis : dict
        Of diagnosis.json.
    label : dict or None
        `faults`, `properties`: lists of names; `sound`: no fault.

    Returns
    -------
    judgement : {"right", "wrong", "abstained", "unjudged"}
    sure : bool
        Whether a name that decided was sure; `no_mismatch` is.
    """
    if not label:
        return "unjudged", False
    verdict = diagnosis["verdict"]
    faults, properties = set(label.get("faults", ())), set(label.get("properties", ()))
    if verdict in ("cannot_tell", "none_of_these"):
        return "abstained", False
    if verdict == "no_mismatch":
        return ("wrong" if faults | properties else "right"), True
    effects = diagnosis.get("effects", [])
    names = [{m["name"] for m in effect["members"]} for effect in effects]
    if faults:
        hits = [e for e, n in zip(effects, names, strict=True) if n & faults]
        deciding = hits or effects
        return ("right" if hits else "wrong"), any(map(is_sure, deciding))
    hits = [e for e, n in zip(effects, names, strict=True) if n & properties]
    false = [e for e in effects if e not in hits and not is_property(e)]
    if false:
        return "wrong", any(map(is_sure, false))
    return ("right", any(map(is_sure, hits))) if hits else ("unjudged", False)


def errors_of(diagnosis):
    """Errors of the first signal that has any: signal, unit, nominal, black_box, corrected, proof."""
    for signal, fit in (diagnosis.get("fit") or {}).items():
        rmse = (fit or {}).get("rmse") or {}
        if rmse:
            kept = {kind: rmse.get(kind) for kind in ("nominal", "black_box", "corrected")}
            return {"signal": signal, "unit": fit.get("unit"), **kept, "proof": diagnosis.get("proof")}
    return {}


def referee(diagnosis):
    """Flags by every signal's errors, on rows of whatever proof the diagnosis has."""
    flags = set()
    for fit in (diagnosis.get("fit") or {}).values():
        rmse = (fit or {}).get("rmse") or {}
        nominal, box, corrected = (rmse.get(k) for k in ("nominal", "black_box", "corrected"))
        if nominal is None:
            continue
        if diagnosis["verdict"] == "no_mismatch" and box is not None and box <= HALVES * nominal:
            flags.add("no_mismatch")
        if corrected is not None and corrected > nominal:
            flags.add("corrected")
    return sorted(flags)
