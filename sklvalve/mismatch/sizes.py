# SPDX-License-Identifier: BSD-3-Clause
"""How large a change of the simulation is, and whether such a change matters in practice."""

import numpy as np

from sklvalve.simulation.calibration import drop_is_unknown

# share of its span by which a flow follows a drop that varies by three per cent and is nowhere recorded
_FLOW_OF_A_DROP = 0.015


class Sizes:
    """Sizes of changes in a workbench that has `channels`, `spans`, a `recording` and a `tolerance`."""

    def change(self, model, other):
        """How two fitted hypotheses differ in a channel: rms where they do, as share of its span.

        Returns
        -------
        sizes : dict
            Channel -> share of span [1].
        """
        sizes = {}
        for channel in self.channels:
            gap = model.predictions[channel] - other.predictions[channel]
            # what was not recorded speaks for nothing
            gap = np.abs(gap[np.isfinite(gap) & np.isfinite(self.recording[channel])])
            # where it acts: the rows that carry the upper part of the difference
            acting = gap > 0.25 * np.quantile(gap, 0.99) if len(gap) else gap > 0
            acting &= gap > 0.0
            rms = float(np.sqrt(np.mean(gap[acting] ** 2))) if acting.any() else 0.0
            sizes[channel] = rms / self.spans[channel]
        return sizes

    def counts(self, sizes):
        """Whether a change is one that matters in practice."""
        return any(size >= self.least(channel) for channel, size in sizes.items())

    def least(self, channel):
        """Size from which on a change of a channel counts, share of span [1]."""
        if channel == "flow" and drop_is_unknown(self.recording):
            return max(self.tolerated(channel), _FLOW_OF_A_DROP)
        return self.tolerated(channel)

    def tolerated(self, channel):
        """Size that the tolerance leaves open, share of span [1]."""
        return self.tolerance.opening_effect if channel == "opening" else self.tolerance.flow_effect
