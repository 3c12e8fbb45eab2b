# SPDX-License-Identifier: BSD-3-Clause
"""Private: which rows of a gas duty have data that make sense, and what is said about the others."""

import numpy as np

from sklvalve.mechanism.validity import warn_rows


def sensible(values):
    """The values as floats, NaN where they are not positive and finite."""
    values = np.asarray(values, dtype=float)
    return np.where((values > 0.0) & (values < np.inf), values, np.nan)[()]


class GasData:
    """The data of gas and valve that have to be positive, and that the flow depends on.

    What is not used (a style modifier without a viscosity) may be anything.
    """

    def __init__(self, gas, viscous, pipes):
        used = dict(zip(("temperature", "molar_mass", "compressibility", "gamma", "xt"), gas, strict=True))
        self.viscous = viscous[0] is not None
        if self.viscous:
            used |= zip(("dynamic_viscosity", "fl", "fd", "kv_rated"), viscous, strict=True)
        if self.viscous or any(pipe is not None for pipe in pipes[1:]):
            used |= zip(("nominal_size", "inlet_pipe", "outlet_pipe"), pipes, strict=True)
        self.used = {
            name: np.asarray(value, dtype=float) for name, value in used.items() if value is not None
        }

    @property
    def known(self):
        """Rows where nothing is missing or senseless."""
        known = np.True_
        for values in self.used.values():
            known = known & (values > 0.0) & (values < np.inf)
        return known

    def warn(self, where, shape, *, stacklevel=4):
        """Count the rows with a senseless datum, and those with an unusual gas."""
        wrong = {name: (values <= 0.0) | np.isinf(values) for name, values in self.used.items()}
        names = [name for name, rows in wrong.items() if np.any(rows)]
        senseless = np.zeros(shape, dtype=bool)
        for name in names:
            senseless = senseless | wrong[name]
        what = f"have a {' or '.join(names)} that is not positive and finite: NaN."
        warn_rows(senseless, where, what, stacklevel=stacklevel)
        gamma = self.used["gamma"]
        unusual = ((gamma < 1.08) | (gamma > 1.65)) & ~wrong["gamma"]
        what = "have a gamma outside 1.08 to 1.65, for which F_gamma is known."
        warn_rows(np.broadcast_to(unusual, shape), where, what, stacklevel=stacklevel)
