# SPDX-License-Identifier: BSD-3-Clause
"""What came of a test: pure functions of names, promises and distances."""

APART = 14.0
# outcomes of records whose diagnosis left a class open with the truth in it, the good one first
SPLIT, LOST, LEFT, TOO_MUCH = "split rightly", "truth lost", "rivals left", "promised too much"
WRONG = "wrong name beside"
NOT_JUDGED, NO_PROMISE, NO_PROGRAM, SENSOR = "not judged", "no promise", "no program", "sensor"
JUDGED = (SPLIT, LOST, LEFT, TOO_MUCH, WRONG)


def open_class(effects, told):
    """Members of the class that holds the truth, where it has more than one; else nothing.

    Parameters
    ----------
    effects : list of list of str
        Classes of a diagnosis, by the names of their members.
    told : str
        The truth, by its name in the catalogue.
    """
    return next((list(c) for c in effects if told in c and len(c) > 1), [])


def promised(pairs, told):
    """Names that a test is to set apart from the truth.

    Parameters
    ----------
    pairs : list of dict
        ``names``, the distance ``now``, and whether the test is said to have them ``told_apart``.
    told : str
    """
    new = [p["names"] for p in pairs if told in p["names"] and p["now"] < APART and p["told_apart"]]
    return [next(n for n in names if n != told) for names in new]


def outcome(told, names, reached, verdict, after):
    """Whether a class split rightly: the truth is named, and nothing that is wrong.

    Parameters
    ----------
    told : str
    names : list of str
        Those that were promised to be set apart.
    reached : dict
        Distances of these by the plant, after the test; without those it cannot make.
    verdict : str
    after : list of list of str
        Classes of the diagnosis after the test.

    Returns
    -------
    outcome : str
    left : list of str
        Names that ought to have gone and did not.
    """
    if not names:
        return NO_PROMISE, []
    able = [n for n in names if reached.get(n, 0.0) >= APART]
    held = [c for c in after if told in c] if verdict == "named" else []
    left = [n for n in able if held and n in held[0]]
    if not any(n in reached for n in names):
        return NOT_JUDGED, left
    if not held:
        return LOST, left
    if not able:
        return TOO_MUCH, left
    if any(told not in c for c in after):
        return WRONG, left
    return (LEFT if left else SPLIT), left


def says_truly(reached):
    """Whether it is true that no test of the valve tells the truth from any other member."""
    return all(d < APART for d in reached.values()) if reached else None
