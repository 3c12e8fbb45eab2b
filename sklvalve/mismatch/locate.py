# SPDX-License-Identifier: BSD-3-Clause
"""Where in the operating range, and when, an effect acts."""

import numpy as np

_LEAST_GAIN = 0.05


def acting_rows(workbench, model, without):
    """Rows in which a model differs from the one without its effect by a good part of the most it does."""
    flagged = np.zeros(len(workbench.recording), dtype=bool)
    for channel, size in workbench.change(model, without).items():
        if not workbench.counts({channel: size}):
            continue
        gap = np.abs(np.nan_to_num(model.predictions[channel] - without.predictions[channel]))
        flagged |= gap > max(0.25 * np.quantile(gap, 0.99), 1e-12)
    return flagged


def regions(chain, values, flagged):
    """The one range of a signal that tells flagged rows from the others best, if any does.

    Returns
    -------
    regions : list of dict
        ``signal, low, high, direction, share``; empty where the flagged rows lie everywhere.
    """
    if flagged.all() or not flagged.any():
        return []
    signals = {}
    # beside a flow that the user simulated the command stands for an opening that was not recorded
    given = "simulated_flow" in chain.recording
    if chain.measured is not None or chain.command is not None:
        driven = chain.measured is not None or given
        signals["opening"] = chain.drive(values) if driven else chain.opening(values)
    if chain.pressure_ratio is not None:
        signals["pressure_ratio"] = chain.pressure_ratio
    if chain.has_pressures:
        signals["dp"] = chain.dp
    if "temperature" in chain.recording:
        signals["temperature"] = chain.recording["temperature"]
    if "flow" in chain.recording:
        signals["flow"] = chain.recording["flow"]
    best, most = None, _overlap(np.ones_like(flagged), flagged) + _LEAST_GAIN
    for name, signal in signals.items():
        known = flagged & np.isfinite(signal)
        if known.sum() < 10:
            continue
        for trim in (0.0, 0.02, 0.1, 0.25):
            for low_cut, high_cut in ((trim, trim), (0.0, trim), (trim, 0.0)):
                low, high = np.quantile(signal[known], [low_cut, 1.0 - high_cut])
                inside = (signal >= low) & (signal <= high)
                score = _overlap(inside, flagged)
                if score > most:
                    best, most = (name, float(low), float(high), float(inside.mean())), score
    if best is None:
        return []
    name, low, high, share = best
    return [{"signal": name, "low": low, "high": high, "direction": None, "share": share}]


def _overlap(inside, flagged):
    both = np.sum(inside & flagged)
    return 2.0 * both / (np.sum(inside) + np.sum(flagged))
