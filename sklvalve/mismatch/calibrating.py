# SPDX-License-Identifier: BSD-3-Clause
"""The nominal simulation, calibrated, and the noise that it leaves."""

from sklvalve.mismatch.first_guess import first_guess


def calibrated(workbench):
    """The simulation without any further effect, calibrated from several starts; the noise is learnt from it.

    Parameters
    ----------
    workbench : Workbench
        Afterwards it knows the noise, and the values of a sound actuator.

    Returns
    -------
    nominal : Model
    """
    guess, workbench.sound_values = first_guess(workbench)
    hold = "actuator_" if guess.values and not workbench.coupled else None
    model = workbench.fit((), start=guess, hold=hold)
    for _ in range(2):
        workbench.learn_noise(model, cautious=True, anew=True)
        other = _from_sound(workbench, model)
        model = workbench.fit((), start=model)
        if other is not None and other.log_likelihood > model.log_likelihood:
            model = other
    return model


def _from_sound(workbench, model):
    """The calibration begun anew from a sound actuator, which may lie in another valley."""
    if not workbench.sound_values:
        return None
    return workbench.fit((), start=workbench.sound(model))
