# SPDX-License-Identifier: BSD-3-Clause
"""Answers of the baselines, laid out as diagnosis.json."""

from sklvalve.mismatch.effects import CATALOGUE

_BLOCKS: dict = {}
for _effect in CATALOGUE:
    _BLOCKS.setdefault(_effect.name, _effect.block)


def effect_of(members, probability=None):
    """Entry of one effect: names that may stand for it, the most probable first.

    Parameters
    ----------
    members : dict
        Name -> probability.
    probability : float, default=None
        That it is one of them; the sum unless given.
    """
    order = sorted(members.items(), key=lambda item: -item[1])
    total = sum(members.values()) if probability is None else probability
    return {
        "members": [{"name": name, "probability": round(float(p), 4)} for name, p in order],
        "probability": round(float(min(total, 1.0)), 4),
        "blocks": sorted({_BLOCKS[name] for name in members}),
        "onset": None,
        "parameters": {},
    }


def found_of(verdict, p_value, effects, recording, *, alpha, onset=None, **private):
    """What a method found, as diagnosis.json has it.

    Parameters
    ----------
    verdict : {"no_mismatch", "named", "cannot_tell", "none_of_these"}
    p_value : float
    effects : list of dict
        Of `effect_of`.
    recording : Recording
    alpha : float
    onset : float, default=None
        When what was found begins [s].
    **private
        Simulations and rows.
    """
    detected = verdict != "no_mismatch"
    end = float(recording.time[-1] - recording.time[0])
    location = {
        "blocks": sorted({b for e in effects for b in e["blocks"]}),
        "regions": [],
        "onset": onset,
        "intervals": [[onset or 0.0, end]] if detected else [],
    }
    mismatch = {"detected": detected, "p_value": float(p_value), "alpha": float(alpha)}
    return {
        "verdict": verdict,
        "mismatch": mismatch,
        "location": location,
        "effects": effects,
        **private,
    }
