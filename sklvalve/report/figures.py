# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of a page as SVG, drawn by the displays from the traces of a diagnosis."""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from sklvalve.report import signals
from sklvalve.report.courses import compared_roles
from sklvalve.report.displays import (
    FitImprovementDisplay,
    RecordingDisplay,
    ResidualMapDisplay,
    SignatureDisplay,
)
from sklvalve.report.displays.improvement import improvements_of
from sklvalve.report.drawing import pyplot_free_figure, styled, to_svg
from sklvalve.report.words import either, number, role_words

_FLAGGED = "; shaded where what was found acts"


class Picture(NamedTuple):
    """A picture and what is told of it.

    Parameters
    ----------
    svg : str
    alt : str
        What it shows, for those who cannot see it.
    caption : str
    """

    svg: str
    alt: str
    caption: str


def recording_figure(traces: dict) -> Picture:
    """Recorded signals over time, flagged rows shaded; recordings and rows used marked."""
    display = RecordingDisplay.of_traces(traces)
    return _courses(display, "recording", "The recorded signals over time" + _FLAGGED)


def residual_figure(traces: dict) -> Picture | None:
    """Recorded minus simulated over time, before and after; None where nothing can be compared."""
    display = RecordingDisplay.of_traces(traces, show="residual")
    if not display.panels:
        return None
    shown = either([role_words(role) for role in compared_roles(traces)], "and")
    alt = f"Recorded minus simulated {shown} over time{when(traces)}"
    return _courses(display, "residual", alt + _FLAGGED)


def signature_figures(traces: dict) -> list[Picture]:
    """Opening against command, and flow against opening: those that the recording tells."""
    travel, capacity = signals.travel_signature(traces), signals.capacity_signature(traces)
    pictures = []
    if travel is not None:
        pictures.append(_signature(travel, "travel", f"Opening against command{when(traces)}"))
    if capacity is not None:
        place = capacity.x_label.split(" [")[0]
        freed = " at a drop of " in capacity.y_label
        told = f"Flow against {place}" + (", divided by the root of the pressure drop" if freed else "")
        pictures.append(_signature(capacity, "capacity", told + when(traces)))
    return pictures


def map_figures(traces: dict) -> list[Picture]:
    """Mean flow residual by opening and pressure ratio, before and after."""
    display = ResidualMapDisplay.of_traces(traces)
    if display is None:
        return []
    outlined = "; outlined: bins where what was found acts" if display.flagged.any() else ""
    pictures = []
    for model in display.means:
        when = {"nominal": " before the correction", "corrected": " after the correction"}[model]
        told = f"Mean flow residual{when if len(display.means) > 1 else ''}"
        alt = f"{told} by opening and pressure ratio{outlined}"
        draw = partial(display.plot, models=[model])
        pictures.append(_picture(draw, f"map-{model}", alt, f"{told}, of each bin{outlined}.", (3.7, 3.1)))
    return pictures


def improvement_figures(d: dict) -> list[Picture]:
    """Errors of each signal on held-out rows: before, black box, after."""
    pictures = []
    for count, improvement in enumerate(improvements_of(d)):
        told = ", ".join(f"{model.replace('_', ' ')} {number(v)}" for model, v in improvement.errors.items())
        noise = improvement.noise
        dashed = "" if noise is None else f" Dashed: what noise alone leaves, {number(noise)}."
        alt = f"Error of {improvement.name} on held-out rows [{improvement.unit}]: {told}."
        display = FitImprovementDisplay([improvement])
        caption = f"Error of {improvement.name} on rows left out of the fit; shorter is better.{dashed}"
        pictures.append(_picture(display.plot, f"improvement-{count}", alt + dashed, caption, (3.7, 1.5)))
    return pictures


def _courses(display: RecordingDisplay, name: str, alt: str) -> Picture:
    count = len(display.panels)
    with styled():
        figure = pyplot_free_figure(7.6, 1.4 * count + 0.5)
        display.plot(figure.subplots(count, 1, sharex=True, squeeze=False))
        return Picture(to_svg(figure, name, alt), alt, "")


def when(traces: dict) -> str:
    """What a heading adds where there is a corrected simulation."""
    return ", before and after the correction" if traces["corrected"] else ""


def _signature(signature: signals.Signature, name: str, told: str) -> Picture:
    alt = f"{told}: recorded and simulated"
    return _picture(SignatureDisplay([signature]).plot, name, alt, f"{alt}.", (3.7, 3.3))


def _picture(
    draw: Callable[[Any], object], name: str, alt: str, caption: str, size: tuple[float, float]
) -> Picture:
    with styled():
        figure = pyplot_free_figure(*size)
        draw(figure.subplots())
        return Picture(to_svg(figure, name, alt), alt, caption)
