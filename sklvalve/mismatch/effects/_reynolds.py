# SPDX-License-Identifier: BSD-3-Clause
"""Flow that is not turbulent, between the laws of IEC 60534-2-1 and without a kink."""

import numpy as np

from sklvalve.mechanism import at_travel, trim_parameter, valve_reynolds_number
from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.simulation.chain import Chain

# of a globe valve, where the sheet has none
_FD, _FL, _TRIM = 0.42, 0.9, 4.0
# the laminar law of annex A
_LAMINAR = 0.026
# of the logarithm of a number
_LARGEST_POWER = 600.0


def viscous_share(
    kv: np.ndarray, viscosity: float | np.ndarray, sharpness: float, chain: Chain
) -> np.ndarray:
    r"""Share of the turbulent flow that a viscous liquid keeps.

    The laminar law of the standard holds for thick liquids and the turbulent one for thin ones. Between them
    the editions of the standard differ by a tenth, and the present one has a kink, or a jump. Here one law
    goes over into the other (Churchill and Usagi, AIChE Journal 18, 1972), as sharply as a recording tells:

    .. math:: F_R = \left(1 + F_\mathrm{lam}^{-m}\right)^{-1/m}, \qquad
              F_\mathrm{lam} = \frac{0.026}{F_L} \sqrt{n\, Re_v}

    With m = 2 the laminar and the turbulent loss of pressure add up; m = 1.2 is near the standard's curve.
    The Reynolds number is that of the flow which is left, in closed form.

    Parameters
    ----------
    kv : ndarray of shape (n,)
        Capacity [m3/h].
    viscosity : float or ndarray of shape (n,)
        Kinematic viscosity [m2/s].
    sharpness : float
        The exponent m [1].
    chain : Chain
        Its sheet gives F_L, F_d and sizes; where it lacks them those of an ordinary globe valve stand in, and
        the viscosity is then known up to a factor only.

    Returns
    -------
    share : ndarray of shape (n,)
        Between 0 and 1; 1 where nothing flows.
    """
    sheet = chain.valve
    fl = _FL if sheet.fl is None else float(np.mean(at_travel(sheet.fl, np.linspace(0.1, 1.0, 10))))
    bore = sheet.nominal_size or np.inf
    trim = _TRIM if np.isinf(bore) else float(trim_parameter(chain.trim.rated, bore))
    flow = FLOW_CONSTANT * kv * np.sqrt(np.abs(chain.dp) / chain.density)
    turbulent = valve_reynolds_number(
        flow, kv, viscosity, fl=fl, fd=sheet.fd or _FD, inlet_pipe=sheet.inlet_pipe or bore
    )
    return _between_the_laws((_LAMINAR / fl) ** 2 * trim * turbulent, sharpness)


def _between_the_laws(laminar: np.ndarray, sharpness: float) -> np.ndarray:
    """Share r of which r**-m = 1 + (laminar r)**(-m/2), `laminar` being the share of a laminar flow."""
    # without flow or drop there is no Reynolds number, and nothing to be kept
    flows = laminar > 0.0
    # of what hardly flows the power of the share is beyond all numbers
    power = np.minimum(-0.5 * sharpness * np.log(np.where(flows, laminar, 1.0)), _LARGEST_POWER)
    return np.where(flows, np.exp(-2.0 / sharpness * np.arcsinh(0.5 * np.exp(power))), 1.0)
