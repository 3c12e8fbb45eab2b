# SPDX-License-Identifier: BSD-3-Clause
"""Errors on rows that served for no fit: the simulation before and after, and a black box."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Self

from sklvalve.report.displays.base import Diagnosed, Display, ink
from sklvalve.report.drawing import COLOURS
from sklvalve.report.rows import MODELS
from sklvalve.report.words import number, role_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ALONE = {"nominal": "simulation", "black_box": "black box"}
_NAMES = {"nominal": "simulation before", "black_box": "black box", "corrected": "simulation after"}


class Improvement(NamedTuple):
    """Errors of one signal.

    Parameters
    ----------
    name, unit : str
    errors : dict of float
        RMSE by model (``nominal``, ``black_box``, ``corrected``), in `unit`; those not known are missing.
    noise : float or None, default=None
        RMSE that noise alone leaves.
    """

    name: str
    unit: str
    errors: dict[str, float]
    noise: float | None = None


class FitImprovementDisplay(Display):
    """RMSE on held-out rows, one panel a signal.

    Best made by `from_diagnosis` or `from_estimator`.

    Parameters
    ----------
    improvements : sequence of Improvement

    Attributes
    ----------
    ax_ : Axes or ndarray of Axes
        One a panel.
    figure_ : Figure

    Examples
    --------
    >>> from sklvalve.report import FitImprovementDisplay
    >>> from sklvalve.report.displays.improvement import Improvement
    >>> flow = Improvement("flow", "m3/h", {"nominal": 1.9, "black_box": 0.5, "corrected": 0.22}, noise=0.2)
    >>> FitImprovementDisplay([flow]).plot().ax_.get_xlabel()
    'RMSE of flow [m3/h]'
    """

    def __init__(self, improvements: Sequence[Improvement]) -> None:
        self.improvements = list(improvements)

    @classmethod
    def from_diagnosis(cls, diagnosis: Diagnosed, *, ax: Any = None) -> Self:
        """Draw the errors of a diagnosis.

        Parameters
        ----------
        diagnosis : Diagnosis
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.

        Raises
        ------
        ValueError
            If it holds no errors.
        """
        return cls(improvements_of(diagnosis.to_dict())).plot(ax)

    def plot(self, ax: Any = None) -> Self:
        """Draw.

        Parameters
        ----------
        ax : Axes or sequence of Axes, default=None
            One a panel; a new figure where None.

        Raises
        ------
        ValueError
            If there is no panel, or not one Axes for each.
        """
        if not self.improvements:
            raise ValueError("there is nothing to draw: no error on held-out rows is known")
        count = len(self.improvements)
        for each, improvement in zip(
            self._drawn_on(ax, count, (3.7, 1.9), columns=count), self.improvements, strict=True
        ):
            _draw(each, improvement)
        return self


def improvements_of(d: dict) -> list[Improvement]:
    """Errors of a diagnosis as they are drawn, travel in percent."""
    # where nothing is missing nothing was corrected
    models = [model for model in MODELS if d["verdict"] != "no_mismatch" or model != "corrected"]
    found = []
    for role, fit in (d.get("fit") or {}).items():
        told = (fit or {}).get("rmse") or {}
        known = {model: told[model] for model in models if told.get(model) is not None}
        if not known:
            continue
        scale, unit = (100.0, "% of travel") if fit["unit"] == "1" else (1.0, fit["unit"])
        noise = fit.get("noise_floor")
        found.append(
            Improvement(
                role_words(role),
                unit,
                {model: scale * value for model, value in known.items()},
                None if noise is None else scale * noise,
            )
        )
    return found


def _draw(ax: "Axes", improvement: Improvement) -> None:
    models = list(improvement.errors)
    values = list(improvement.errors.values())
    bars = ax.barh(
        [_NAMES[model] if "corrected" in models else _ALONE[model] for model in models],
        values,
        height=0.6,
        color=[COLOURS[model] for model in models],
    )
    ax.bar_label(bars, [number(value) for value in values], padding=4)
    ax.invert_yaxis()
    ax.grid(visible=False, axis="y")
    ax.set_xlim(0.0, 1.35 * max([*values, improvement.noise or 0.0]) or 1.0)
    ax.set_xlabel(f"RMSE of {improvement.name} [{improvement.unit}]")
    if improvement.noise is not None:
        ax.axvline(improvement.noise, color=ink(), linewidth=1.0, linestyle=(0, (2, 2)))
