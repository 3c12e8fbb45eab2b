# SPDX-License-Identifier: BSD-3-Clause
"""How large a change of the simulation is, and whether such a change matters in practice."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from sklvalve.history import ValveHistory
from sklvalve.mismatch.inference.hypothesis import Model
from sklvalve.recording import Recording
from sklvalve.simulation import Tolerance
from sklvalve.simulation.calibration import drop_is_unknown, span_of

# share of its span by which a flow follows a drop that varies by three per cent and is nowhere recorded
_FLOW_OF_A_DROP = 0.015
# of a stem that is known from its own history so much of what counts otherwise: sound, it comes out as before
# within 0.01 to 0.13 % of travel (`benchmarks/sound_scatter.py`), where 0.5 % counts against a data sheet
_OF_A_KNOWN_STEM = 0.5
# of the span of all recordings that were joined, what one of them has at least
_LEAST_SPAN = 0.2
_TINY = 1e-300


class Sizes:
    """Sizes of changes in a problem of `channels`, `spans`, a `recording`, a `tolerance`, and a `history`."""

    recording: Recording
    tolerance: Tolerance
    channels: tuple[str, ...]
    spans: dict[str, float]
    history: ValveHistory | None

    def change(self, model: Model, other: Model) -> dict[str, float]:
        """How two fitted hypotheses differ in a channel: rms where they do, as share of its span.

        Where several recordings were joined it is the largest of theirs, each by its own span: what counted
        in a loop at a third of its flow counts still when a test over the whole travel is put behind it.

        Returns
        -------
        sizes : dict
            Channel -> share of span [1].
        """
        return {
            channel: max((size for _, size in self.by_recording(channel, model, other)), default=0.0)
            for channel in self.channels
        }

    def by_recording(self, channel: str, model: Model, other: Model) -> list[tuple[slice, float]]:
        """How two fitted hypotheses differ in a channel, for each recording that was joined.

        Returns
        -------
        sizes : list of (slice, float)
            Rows, and share of the span of their recording [1]; without recordings that lack the channel.
        """
        gap = self._gap(channel, model, other)
        return [(rows, _rms_where_acting(gap[rows]) / span) for rows, span in self._recorded[channel]]

    def change_in_all(self, channel: str, model: Model, other: Model) -> float:
        """The same over all recordings, as share of the span of all [1]."""
        return _rms_where_acting(self._gap(channel, model, other)) / max(self.spans[channel], _TINY)

    @cached_property
    def _recorded(self) -> dict[str, list[tuple[slice, float]]]:
        """Of each channel the rows of every recording that has it, and its span there."""
        pieces: dict[str, list[tuple[slice, float]]] = {channel: [] for channel in self.channels}
        for channel, whole in self.spans.items():
            # in what hardly flows a hair's breadth is a large share
            least = max(_LEAST_SPAN * whole, _TINY)
            for rows in (slice(*span) for span in self.recording.spans):
                values = self.recording[channel][rows]
                if np.isfinite(values).any():
                    span = 1.0 if channel == "opening" else max(span_of(values), least)
                    pieces[channel].append((rows, span))
        return pieces

    def _gap(self, channel: str, model: Model, other: Model) -> np.ndarray:
        gap = np.abs(model.predictions[channel] - other.predictions[channel])
        # what was not recorded speaks for nothing
        return np.where(np.isfinite(self.recording[channel]), gap, np.nan)

    def counts(self, sizes: dict[str, float]) -> bool:
        """Whether a change is one that matters in practice."""
        return any(size >= self.least(channel) for channel, size in sizes.items())

    def least(self, channel: str) -> float:
        """Size from which on a change of a channel counts, share of span [1]."""
        if channel == "flow" and drop_is_unknown(self.recording):
            return max(self.tolerated(channel), _FLOW_OF_A_DROP)
        known = channel == "opening" and self.history is not None
        return self.tolerated(channel) * (_OF_A_KNOWN_STEM if known else 1.0)

    def tolerated(self, channel: str) -> float:
        """Size that the tolerance leaves open, share of span [1]."""
        return self.tolerance.counts(channel)


def _rms_where_acting(gap: np.ndarray) -> float:
    """Root mean square of a difference where it acts: in the rows that carry its upper part."""
    gap = gap[np.isfinite(gap)]
    if not gap.any():
        return 0.0
    acting = (gap > 0.25 * np.quantile(gap, 0.99)) & (gap > 0.0)
    return float(np.sqrt(np.mean(gap[acting] ** 2)))
