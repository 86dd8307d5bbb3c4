"""The lines of a figure of curves, as drawn and as written beside it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.analysis import Leg, extrapolate
from pellicle.arrays import Array
from pellicle.show.leg_styles import RETRACTION, draw_legs

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def line_style(colour: Any, line: Any, marker: str) -> dict[str, Any]:
    """Return keywords of ``Axes.plot`` of a curve; retractions have filled markers."""
    return {
        "color": colour,
        "marker": marker,
        "linestyle": line,
        "markersize": 4,
        "markerfacecolor": colour if line is RETRACTION else "white",
        "linewidth": 1.2,
    }


@dataclass(frozen=True)
class CurvePoints:
    """The points of one curve, each array of shape (points,)."""

    x: Array
    y: Array
    """Of several runs the mean."""
    low: Array
    """The lowest y of the runs."""
    high: Array
    """The highest y of the runs."""
    good: Array
    """1 where every run converged."""
    runs: Array
    """Number of runs that each point is the mean of."""

    def ordered(self) -> CurvePoints:
        """Return the same points in the order of x."""
        order = np.argsort(self.x)
        return CurvePoints(*(getattr(self, field.name)[order] for field in fields(self)))


NO_POINTS = CurvePoints(*[np.empty(0)] * 6)


@dataclass(frozen=True)
class Line:
    """Points, as drawn and as written in columns ``curve`` and ``series``."""

    points: CurvePoints
    style: dict[str, Any]
    """Keywords of ``Axes.plot``."""
    legend: str
    number: int | None = None
    """Index of y; None where neither steps that failed nor ranges are marked."""
    curve: str = ""
    series: str = ""
    path: Sequence[Leg] = ()
    """The legs of a path, if approach and retraction are to be told apart."""

    def draw(self, axes: Axes, factor_x: float, factor_y: float, log: bool) -> None:
        """Draw the points times the factors of the axes; on ``log`` axes without arrows."""
        points, style = self.points, self.style
        x, y = points.x * factor_x, points.y * factor_y
        drawn = style | {"label": self.legend or None}
        if self.path:
            draw_legs(axes, self.path, x, y, arrows=not log, **drawn)
        else:
            axes.plot(x, y, **drawn)
        if self.number is None:
            return
        bad = points.good < 1
        axes.plot(x[bad], y[bad], "x", color="red", markersize=9, label="_not converged")
        # The range of the first series only: several bands cannot be told apart.
        if self.number == 0 and (points.runs > 1).any():
            low, high = points.low * factor_y, points.high * factor_y
            axes.fill_between(x, low, high, color=style["color"], alpha=0.2, linewidth=0)

    def rows(self) -> Iterator[dict[str, object]]:
        """Yield the numbers drawn."""
        columns = (getattr(self.points, field.name) for field in fields(self.points))
        # A turn belongs to the leg that reaches it.
        directions = {
            step: leg.direction
            for leg in reversed(self.path)
            for step in range(leg.steps.start, leg.steps.stop)
        }
        for step, (x, y, low, high, good, runs) in enumerate(zip(*columns, strict=True)):
            row: dict[str, object] = {"curve": self.curve, "series": self.series, "x": x, "y": y}
            if runs > 1:
                row |= {"y_lowest": low, "y_highest": high, "runs": int(runs)}
            if step in directions:
                row["direction"] = directions[step]
            yield row | {"converged": bool(good)}


class Limit:
    """The limit of a curve for x → 0."""

    def __init__(self, points: CurvePoints, colour: Any, curve: str, series: str) -> None:
        self._points, self._colour = points, colour
        self._fit = extrapolate(points.x, points.y)
        self._head = {"curve": curve, "series": series}

    def draw(self, axes: Axes, factor_x: float, factor_y: float, _log: bool) -> None:
        """Draw the fitted curve down to x = 0, and the limit with its error."""
        fit, colour = self._fit, self._colour
        x = np.linspace(0, float(self._points.x.max()), 200)
        y = np.append(fit.limit, fit(x[1:]))
        axes.plot(x * factor_x, y * factor_y, color=colour, linewidth=0.8, zorder=1)
        spread = np.maximum([[fit.limit - fit.lowest], [fit.highest - fit.limit]], 0.0) * factor_y
        style: dict[str, Any] = {"markersize": 12, "linewidth": 0.8, "capsize": 3, "clip_on": False}
        axes.errorbar([0.0], [fit.limit * factor_y], spread, fmt="_", color=colour, **style)

    def rows(self) -> Iterator[dict[str, object]]:
        """Yield the limit, its range and the exponent."""
        yield {
            **self._head,
            "x": 0.0,
            "y": self._fit.limit,
            "y_lowest": self._fit.lowest,
            "y_highest": self._fit.highest,
            "converged": bool((self._points.good == 1).all()),
            "exponent": self._fit.exponent,
        }
