# SPDX-License-Identifier: BSD-3-Clause
"""How far a change of capacity goes beyond what a trim's data sheet leaves open."""

import numpy as np

from sklvalve.simulation.chain import Chain
from sklvalve.simulation.tolerance import Tolerance
from sklvalve.simulation.trim import GRID


def visited(chain: Chain) -> tuple[np.ndarray, np.ndarray]:
    """Openings between which nearly all rows of a recording lie, and the sheet's relative capacity there."""
    opening = chain.command if chain.measured is None else chain.measured
    low, high = np.nanquantile(opening, (0.01, 0.99)) if opening is not None else (0.0, 1.0)
    x = np.linspace(max(float(low), 0.0), min(max(float(high), 0.05), 1.0), 60)
    return x, np.interp(x, GRID, chain.trim.nominal)


def beyond_trim(change: np.ndarray, phi: np.ndarray, tolerance: Tolerance) -> bool:
    """Whether a relative change of capacity is anywhere larger than IEC 60534-2-4 allows.

    Parameters
    ----------
    change : ndarray of shape (n,)
        Change of capacity, share of the capacity there [1].
    phi : ndarray of shape (n,)
        Relative capacity [1].
    tolerance : Tolerance
    """
    return bool(np.any(np.abs(change) > tolerance.trim * np.maximum(phi, 1e-6) ** -0.2))
