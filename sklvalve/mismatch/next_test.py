# SPDX-License-Identifier: BSD-3-Clause
"""What to do at the valve to learn more."""


def next_test(classes, verdict, unknown, workbench):
    """One plain sentence: the test that separates what is left open, or that confirms what was found.

    Parameters
    ----------
    classes : list of dict
        Classes as `class_of` gives them.
    verdict : str
    unknown : Unknown or None
    workbench : Workbench

    Returns
    -------
    sentence : str or None
    """
    open_ones = [c for c in classes if len(c) > 1]
    for members in open_ones or classes:
        who = next(iter(members.values()))[1]
        return who.effect.separated_by
    if unknown is not None:
        inputs = " and ".join(name.replace("_", " ") for name in unknown.inputs)
        return f"Repeat a slow sweep of {inputs} at three levels of the other signals, both ways."
    if verdict == "no_mismatch" and "opening" not in workbench.recording:
        return "Record the stem position too: without it actuator and trim cannot be told apart."
    return None
