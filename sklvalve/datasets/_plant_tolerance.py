# SPDX-License-Identifier: BSD-3-Clause
"""What of a change calibration could take up: what a data sheet leaves open, linearised at one plant."""

import numpy as np
from numba import njit
from scipy.optimize import lsq_linear
from scipy.signal import lfilter

from sklvalve.datasets._plant_draw import sheet_trim
from sklvalve.datasets._plant_loop import COLUMNS, _play, _valve_flow

# the design's table of tolerances: capacity, trim, F_L, response [s], half the static error, zeros
CAPACITY, TRIM, RECOVERY, RESPONSE, STATIC, POSITION_ZERO = 0.1, 0.1, 0.1, 3.0, 0.005, 0.01
FLOW_ZERO, PRESSURE_ZERO = 0.005, 2.5  # share of span; [kPa] of a span of 1000


# no cache: a change of the functions it calls would go unnoticed
@njit
def _static_flow(opening, p1, p2, rho, floor, row, trim, other, fl, size4, knee, bypass_fl):
    out = np.empty(opening.size)
    for k in range(opening.size):
        x = min(max(opening[k], 0.0), 1.0)
        out[k] = _valve_flow(x, p1[k], p2[k], rho[k], floor[k], row, trim, other, fl, size4, knee, bypass_fl)
    return out


@njit
def side_of_play(inside, half):
    """Where in a gap of this half width a driven part stands, -1 to 1: by the direction of travel."""
    out = np.empty(inside.size)
    y = inside[0]
    for k in range(inside.size):
        y = _play(inside[k], y, 2.0 * half)
        out[k] = (y - inside[k]) / half
    return out


def healthy_flow(plant, opening, p1, p2, rho, floor, fl=1.0):
    """Flow [m3/h] of the healthy valve at rest at these openings [1] and pressures [Pa]; `fl` scales F_L."""
    row = np.array([plant.healthy[name] for name in COLUMNS])
    size4, knee, bypass_fl = plant.line[3:6]
    trims = (plant.trim, plant.other, fl * plant.fl)
    return _static_flow(opening, p1, p2, rho, floor, row, *trims, size4, knee, bypass_fl)


def slopes(plant, opening, *rest):
    """Change of the healthy flow [m3/h] with opening, and with the logarithm of F_L; both at rest."""
    at = lambda step, fl: healthy_flow(plant, opening + step, *rest, fl)  # noqa: E731
    return (at(0.01, 1.0) - at(-0.01, 1.0)) / 0.02, (at(0.0, 1.02) - at(0.0, 0.98)) / 0.04


def opening_columns(opening, slow):
    """Series [1] that calibration may add to a simulated opening, in any sum within their bounds.

    Parameters
    ----------
    opening, slow : ndarray of shape (n,)
        Of the healthy actuator, as it is and with as much lag as the tolerance of its response.

    Returns
    -------
    columns : ndarray of shape (n, 4)
    low, high : ndarray of shape (4,)
    """
    columns = [np.ones_like(opening), opening, slow - opening, side_of_play(opening, STATIC)]
    low = np.array([-POSITION_ZERO, -POSITION_ZERO, -0.3, 0.0])
    return np.column_stack(columns), low, np.array([POSITION_ZERO, POSITION_ZERO, 1.0, STATIC])


def flow_columns(plant, flow, opening, by_opening, by_recovery, drop):
    """Series [m3/h] that calibration may add to a simulated flow; less where the plant has used some of it.

    A capacity 8 % above its sheet has 2 % left upwards and 18 % downwards.

    Parameters
    ----------
    plant : Plant
    flow, opening, by_opening, by_recovery, drop : ndarray of shape (n,)
        Of the healthy flow side: flow [m3/h], opening [1], its `slopes` and the pressure drop [kPa].
    """
    healthy, span = plant.healthy, flow.max()
    own = np.array(
        [
            healthy["meter_bias"],
            plant.trim[-1] / plant.kv - 1.0,
            healthy["meter_lag"] / RESPONSE,
            0.0,
            healthy["plug_offset"],
            np.mean(plant.fl) / plant.sheet["fl"] - 1.0,
            0.0,
        ]
    )
    columns = [
        np.ones_like(flow),
        flow / (1.0 + own[1]),
        _slower(flow, RESPONSE) - flow,
        side_of_play(opening, STATIC) * by_opening,
        by_opening,
        by_recovery,
        0.5 * flow / np.maximum(drop, 1.0),
    ]
    shapes, used = _trim_shapes(plant, opening)
    low = np.array([-FLOW_ZERO * span, -CAPACITY, 0.0, 0.0, -POSITION_ZERO, -RECOVERY, -PRESSURE_ZERO])
    high = -low
    high[2], high[3] = 1.0, STATIC
    together = np.column_stack([*columns, shapes * flow[:, None]])
    return together, np.append(low - own, -1.0 - used), np.append(high - own, 1.0 - used)


def _trim_shapes(plant, opening):
    """Departures of a trim as large as they may be, each about one place, and how much the plant has used.

    The places are those at which the plant draws its own, but for the last one, which is the capacity.
    """
    sheet = (plant.sheet["characteristic"], plant.sheet["rangeability"], plant.sheet["shutoff"])
    most = lambda x: TRIM * sheet_trim(*sheet, np.maximum(x, sheet[2])) ** -0.2  # noqa: E731
    x, places = np.clip(opening, 0.0, 1.0), np.linspace(0.0, 1.0, 8)
    shapes = np.column_stack([np.interp(x, places, hat) for hat in np.eye(8)[:-1]])
    # below the shut-off a sheet says nothing of the trim
    places = np.maximum(places[:-1], sheet[2])
    own = np.interp(places, np.linspace(0.0, 1.0, plant.trim.size), plant.trim / plant.trim[-1])
    return shapes * most(x)[:, None], (own / sheet_trim(*sheet, places) - 1.0) / most(places)


def _slower(values, seconds):
    pole = np.exp(-1.0 / seconds)
    return lfilter([1.0 - pole], [1.0, -pole], values, zi=[pole * values[0]])[0]


def within(plant, name):
    """Size up to which an effect that is there from the start is itself a tolerance of the sheet."""
    own = {
        "backlash": 2.0 * STATIC,
        "linkage_backlash": 2.0 * STATIC,
        "positioner_deadband": STATIC,
        "dead_time": RESPONSE,
        "actuator_lag": RESPONSE,
        "slew_limit": 2.0 * RESPONSE,  # for positioner and actuator each
        "position_sensor_bias": POSITION_ZERO,
        "sensor_lag": RESPONSE - plant.healthy["meter_lag"],
    }
    return own.get(name, 0.0)


def left_over(change, columns, low, high):
    """Coefficients of the columns, within their bounds, that leave least of a change; all of it whitened."""
    q, r = np.linalg.qr(columns)
    scale = np.maximum(np.linalg.norm(r, axis=0), 1e-12)
    wide = np.maximum(high - low, 1e-12)
    solved = lsq_linear(r / scale, q.T @ change, (low * scale, (low + wide) * scale))
    return solved.x / scale
