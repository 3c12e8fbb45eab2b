# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmark judges: this package's finder, and the baselines that it is held against.

Each module has ``diagnose(recording, *, folder=None) -> found``; those of `WITH_HISTORY` take ``history``
besides, what their ``learn(recordings)`` made of recordings from before. `found` is laid out as
diagnosis.json, as far as the method knows: ``verdict``, ``mismatch``, ``effects``, ``location``. Under the
keys of `PRIVATE` it holds what is no plain data: simulations (``Recording -> {"flow", "opening"}`` in SI) and
rows.
"""

from importlib import import_module

#: Name in the lines of scores -> module.
METHODS = {
    "sklvalve": "ours",
    "stepwise_bic": "stepwise_bic",
    "random_forest": "random_forest",
    "sparse_regression": "sparse_regression",
    "no_noise_model": "no_noise_model",
    "sklvalve_history": "with_history",
}

#: Methods that are given a history of the plant as well; records without one are not theirs.
WITH_HISTORY = ("sklvalve_history",)

#: Entries of `found` that are no plain data.
PRIVATE = ("simulate", "simulate_nominal", "flagged", "boxes")


def method(name):
    """The function `diagnose` of a method.

    Raises
    ------
    ValueError
        If there is no such method.
    """
    return _module(name).diagnose


def learner(name):
    """The function `learn` of a method; None of one that takes no history."""
    return _module(name).learn if name in WITH_HISTORY else None


def _module(name):
    if name not in METHODS:
        raise ValueError(f"expected one of the methods {', '.join(METHODS)}; got {name!r}")
    return import_module(f"{__name__}.{METHODS[name]}")


def public(found):
    """What a line of scores keeps of `found`: its plain data."""
    return {key: value for key, value in found.items() if key not in PRIVATE}


__all__ = ["METHODS", "PRIVATE", "WITH_HISTORY", "learner", "method", "public"]
