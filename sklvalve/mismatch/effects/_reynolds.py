# SPDX-License-Identifier: BSD-3-Clause
"""Flow that is not turbulent, quickly: the closed form of IEC 60534-2-1 annex A from a table."""

from functools import lru_cache

import numpy as np

from sklvalve.mechanism import at_travel, nonturbulent_flow_ratio, trim_parameter, valve_reynolds_number
from sklvalve.mechanism.liquid import FLOW_CONSTANT
from sklvalve.simulation.chain import Chain

# of a globe valve, where the sheet has none
_FD, _FL, _TRIM = 0.42, 0.9, 4.0
_LOG_REYNOLDS = np.linspace(np.log(1e-3), np.log(1e6), 1200)


def viscous_share(kv: np.ndarray, viscosity: float | np.ndarray, chain: Chain) -> np.ndarray:
    """Share of the turbulent flow that a viscous liquid keeps.

    Parameters
    ----------
    kv : ndarray of shape (n,)
        Capacity [m3/h].
    viscosity : float or ndarray of shape (n,)
        Kinematic viscosity [m2/s].
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
    reynolds = valve_reynolds_number(
        flow, kv, viscosity, fl=fl, fd=sheet.fd or _FD, inlet_pipe=sheet.inlet_pipe or bore
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.exp(np.interp(np.log(reynolds), _LOG_REYNOLDS, _log_share(trim, fl)))
    # without flow or drop there is no Reynolds number, and nothing to be kept
    return np.where(reynolds > 0.0, share, 1.0)


@lru_cache(maxsize=32)
def _log_share(trim: float, fl: float) -> np.ndarray:
    return np.log(nonturbulent_flow_ratio(np.exp(_LOG_REYNOLDS), trim, fl))
