# SPDX-License-Identifier: BSD-3-Clause
"""Many rows at once: properties by temperature, reducers, choking and viscosity in one compiled pass."""

import os
import threading
import warnings

import numpy as np

from sklvalve.mechanism._liquid_inputs import SENSELESS
from sklvalve.mechanism.fluid import STANDARD_TEMPERATURE, fluid_from
from sklvalve.mechanism.liquid import WATER_CRITICAL_PRESSURE
from sklvalve.mechanism.validity import MissingDatum, ValidityWarning
from sklvalve.mechanism.water import water_density, water_kinematic_viscosity, water_vapour_pressure

# a thread costs about as much to start as this many rows cost to rate
_ROWS_A_THREAD = 20_000

_NOTHING = np.empty(0)

# what an output needs
_NEEDS = {
    "flow": None,
    "mass_flow": None,
    "density": None,
    "p_vapour": "fl",
    "dp_choked": "fl",
    "viscosity": "fd",
    "reynolds": "fd",
    "fr": "fd",
}

_TOLD = {
    "temperature": "have a temperature outside 273.15 to 647.096 K (is it in kelvin?); above the range and "
    "below 230 K they give NaN.",
    "cold": "have a temperature outside 273.15 to 423.15 K: the viscosity is extrapolated, and NaN below "
    "230 K and above 647.096 K.",
    "boils": "have liquid at or below its vapour pressure before the valve; those at or below F_F p_v give "
    "NaN.",
    "kv": "have a negative kv; the linear continuation is returned.",
    "density": "have a density that is not positive and give NaN.",
    "viscosity": "have a viscosity that is not positive and give NaN.",
    "wide": "have a kv beyond 0.047 N18 d2: outside the accuracy of the standard.",
    "lost": "have no flow that satisfies the equations and give NaN.",
    "senseless": SENSELESS,
}


def rate_liquid(
    kv,
    p1,
    p2,
    temperature=None,
    *,
    fluid="water",
    fl=None,
    fd=None,
    kv_rated=None,
    nominal_size=None,
    inlet_pipe=None,
    outlet_pipe=None,
    strict=False,
    outputs="flow",
    n_jobs=None,
    warn=True,
):
    r"""Flow through a valve for very many operating points: everything in one compiled pass.

    Gives what `liquid_flow` gives with the density, the vapour pressure and the viscosity of the fluid at the
    temperature of each row, without an array in between.

    Parameters
    ----------
    kv : float or array-like
        Flow coefficient at the actual opening. [m3/h]
    p1, p2 : float or array-like
        Pressures before and behind the valve, absolute. [Pa]
    temperature : float or array-like, default=None
        Temperature of the liquid before the valve; None is 20 degC. [K]
    fluid : str or Fluid, default="water"
        Water is computed within the pass; the properties of any other `Fluid` are computed before it.
    fl : float or array-like, default=None
        Pressure recovery factor at the actual travel; None leaves choking out, as does, with `fd`, a fluid
        without a vapour pressure. [1]
    fd : float or array-like, default=None
        Valve style modifier. With it flow at a low Reynolds number is reduced by F_R; needs `fl` and
        `nominal_size`. [1]
    kv_rated : float or array-like, default=None
        Flow coefficient of the open valve, which says what kind of trim it has; None takes `kv`, see
        `trim_parameter`. [m3/h]
    nominal_size : float or array-like, default=None
        Bore of the valve's ends. [m]
    inlet_pipe, outlet_pipe : float or array-like, default=None
        Bores of the pipes; with one of them the reducers count, and None is a pipe of the nominal size. [m]
    strict : bool, default=False
        The Reynolds factor by the letter of the standard, with its jumps.
    outputs : str or sequence of str, default="flow"
        ``"flow"`` [m3/s], ``"mass_flow"`` [kg/s], ``"density"`` [kg/m3], ``"p_vapour"`` [Pa], ``"dp_choked"``
        [Pa] (both with `fl` only), ``"viscosity"`` [m2/s], ``"reynolds"`` [1], ``"fr"`` [1] (with `fd` only).
    n_jobs : int, default=None
        Threads; None takes as many as the machine and the variables ``OMP_NUM_THREADS`` and
        ``NUMBA_NUM_THREADS`` lend, and never more than pay.
    warn : bool, default=True
        Emit a `ValidityWarning` for each kind of trouble with the number of rows.

    Returns
    -------
    result : float, ndarray or dict
        The one output in the broadcast shape of the inputs, always in double precision; for a sequence a
        dictionary by name. NaN where `liquid_flow` gives NaN, and for water below 230 K.

    Raises
    ------
    ValueError
        If an output is unknown or needs a datum that is missing, or shapes do not broadcast.

    See Also
    --------
    liquid_flow : The same from density, vapour pressure and viscosity.

    Notes
    -----
    The equations are those of `liquid_flow`, `piping_factor`, `nonturbulent_flow_ratio`, `water_density`,
    `water_vapour_pressure` and `water_kinematic_viscosity`. Results agree with theirs to about 1e-14; more
    roughly only where rounding itself is magnified, as close to boiling. The first call in a new installation
    compiles for some seconds. Numbers that stand for all rows and columns of a matrix are read in place;
    other types than double precision are copied to it first.

    Examples
    --------
    >>> rate_liquid([40.0, 80.0], 6e5, 2e5, [293.15, 423.15], fl=0.9).round(5)
    array([0.02223, 0.02661])
    >>> small = {"fl": 0.9, "fd": 0.3, "nominal_size": 0.015}
    >>> found = rate_liquid(0.02, 6e5, 5e5, 293.15, outputs=["flow", "fr"], **small)
    >>> round(float(found["fr"]), 3)
    0.828
    """
    names = [outputs] if isinstance(outputs, str) else list(outputs)
    given = {"kv": kv, "p1": p1, "p2": p2, "fl": fl, "fd": fd, "kv_rated": kv_rated}
    given |= {"nominal_size": nominal_size, "inlet_pipe": inlet_pipe, "outlet_pipe": outlet_pipe}
    given = {name: np.asarray(value, dtype=float) for name, value in given.items() if value is not None}
    _check(names, given)
    piping = "inlet_pipe" in given or "outlet_pipe" in given
    viscous = "fd" in given
    if piping or viscous:
        given.setdefault("inlet_pipe", given["nominal_size"])
        given.setdefault("outlet_pipe", given["nominal_size"])
    fluid = fluid_from(fluid)
    # as `liquid_flow`: viscosity asks for fl too, and alone does not mean choking
    needless = viscous and not {"p_vapour", "dp_choked"} & set(names)
    choking = "fl" in given and (fluid.knows("vapour_pressure") or not needless)
    of_water = _is_water(fluid, choking, viscous)
    given |= _properties(fluid, temperature, of_water, choking, viscous, warn)
    modes = (of_water, choking, piping, viscous, bool(strict))
    shape, found, counts = _run(given, names, modes, n_jobs)
    if warn:
        for trouble, count in counts.items():
            if count:
                many = int(np.prod(shape))
                message = f"rate_liquid: {count} of {many} rows {_TOLD[trouble]}"
                warnings.warn(message, ValidityWarning, stacklevel=2)
    results = {name: values.reshape(shape)[()] for name, values in zip(names, found, strict=True)}
    return results[outputs] if isinstance(outputs, str) else results


def _check(names, given):
    unknown = [name for name in names if name not in _NEEDS]
    if unknown:
        raise ValueError(f"unknown output {unknown[0]!r}: use some of {', '.join(_NEEDS)}.")
    for name in names:
        needed = _NEEDS[name]
        if needed and needed not in given:
            raise ValueError(f"the output {name!r} needs {needed}: give it, or leave the output out.")
    if ("inlet_pipe" in given or "outlet_pipe" in given) and "nominal_size" not in given:
        raise ValueError(
            "a pipe is given but nominal_size is not: reducers need the bore of the valve's ends [m]."
        )
    missing = [name for name in ("fl", "nominal_size") if name not in given]
    if "fd" in given and missing:
        raise ValueError(
            f"fd is given but {' and '.join(missing)} not: the valve Reynolds number needs them; give them "
            "or leave fd out."
        )


def _is_water(fluid, choking, viscous):
    used = {"density": water_density}
    if choking:
        used["vapour_pressure"] = water_vapour_pressure
        if fluid.critical_pressure != WATER_CRITICAL_PRESSURE:
            return False
    if viscous:
        used["kinematic_viscosity"] = water_kinematic_viscosity
    return all(fluid.properties.get(what) is formula for what, formula in used.items())


def _properties(fluid, temperature, of_water, choking, viscous, warn):
    """What the pass reads of the liquid: its temperature, or its properties."""
    if of_water:
        return {
            "temperature": np.asarray(
                STANDARD_TEMPERATURE if temperature is None else temperature, dtype=float
            )
        }
    found = {"density": fluid.density(temperature, warn=warn)}
    if choking:
        found["p_vapour"] = fluid.vapour_pressure(temperature, warn=warn)
        if fluid.critical_pressure is None:
            raise MissingDatum(
                f"the fluid {fluid.name!r} has no critical_pressure: choking needs it; give it."
            )
        found["p_critical"] = fluid.critical_pressure
    if viscous:
        found["viscosity"] = fluid.kinematic_viscosity(temperature, warn=warn)
    return {name: np.asarray(value, dtype=float) for name, value in found.items()}


def _run(given, names, modes, n_jobs):
    # compiled code is imported where it is needed: the package must come up in a blink
    from sklvalve.mechanism._rating_kernel import TROUBLES, rate
    from sklvalve.mechanism._rating_stages import BLOCK, INPUTS, OUTPUTS

    shape = np.broadcast_shapes(*(values.shape for values in given.values()))
    size = int(np.prod(shape))
    found = np.empty((len(names), size))
    inner, memory, steps = _as_read(given, INPUTS, shape, size)
    wanted = np.array([OUTPUTS.index(name) for name in names], dtype=np.int64)
    many = _threads(n_jobs, size)
    bounds = [min(size, -(-size * k // many // BLOCK) * BLOCK) for k in range(many)] + [size]
    counts = np.zeros((many, len(TROUBLES)), dtype=np.int64)

    def work(k):
        rate(bounds[k], bounds[k + 1], inner, memory, steps, wanted, found, counts[k], *modes)

    others = [threading.Thread(target=work, args=(k,)) for k in range(1, many)]
    for thread in others:
        thread.start()
    work(0)
    for thread in others:
        thread.join()
    return shape, found, dict(zip(TROUBLES, counts.sum(axis=0).tolist(), strict=True))


def _as_read(given, names, shape, size):
    """The shape to walk through, and for each name its memory as one line and its steps along the axes."""
    plain = all(
        values.size == 1 or (values.shape == shape and values.flags.c_contiguous) for values in given.values()
    )
    walked = (size,) if plain or not shape else shape
    memory, steps = [], np.zeros((len(names), len(walked)), dtype=np.int64)
    for k, name in enumerate(names):
        if name not in given:
            line = _NOTHING
        elif plain:
            line = given[name].reshape(-1).view()
            steps[k] = line.size > 1
        else:
            line, steps[k] = _line(np.broadcast_to(given[name], walked), size)
        # one kind of array for the compiler, whatever the caller may write to
        line.flags.writeable = False
        memory.append(line)
    return np.array(walked), tuple(memory), steps


def _line(values, size):
    """The memory of an array from its first element to its last, and its steps along the axes."""
    if any(step < 0 or step % values.itemsize for step in values.strides) or not values.flags.aligned:
        values = np.ascontiguousarray(values)
    steps = [step // values.itemsize for step in values.strides]
    span = 1 + sum((n - 1) * step for n, step in zip(values.shape, steps, strict=True))
    return np.lib.stride_tricks.as_strided(values, (span if size else 0,), (values.itemsize,)), steps


def _threads(n_jobs, size):
    paying = max(1, size // _ROWS_A_THREAD)
    if n_jobs is None:
        if paying == 1:
            return 1
        from joblib import cpu_count

        lent = [os.environ.get(name, "") for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS")]
        n_jobs = min([cpu_count(), *(int(text) for text in lent if text.isdigit() and int(text) > 0)])
    elif not isinstance(n_jobs, int | np.integer) or n_jobs < 1:
        raise ValueError(f"n_jobs must be a number of threads, 1 or more, or None; got {n_jobs!r}.")
    return min(int(n_jobs), paying)
