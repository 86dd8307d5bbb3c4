"""Curves over a path, with approach and retraction in different styles."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from pellicle.analysis import Leg
from pellicle.arrays import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_LEGS = 4
"""Largest number of legs of a path in time that are told apart by their style."""
RETRACTION = (0, (2.5, 1.2))
"""Line style of retraction; its markers are filled, those of approach are open."""


def draw_legs(
    axes: Axes, path: Iterable[Leg], x: Array, y: Array, *, arrows: bool = True, **style: Any
) -> None:
    """Draw a curve over the steps of a path, approach and retraction in different styles.

    Approach has the given style of ``Axes.plot``, which needs a color, with open markers;
    retraction has short dashes and filled markers. ``arrows`` point in the order of the steps; on
    logarithmic axes they might begin at values that are not positive. `name_legs` names both parts
    in the legend.
    """
    label = style.pop("label", None)
    # The legend shows the plain style if there is an approach.
    for leg in sorted(path, key=lambda leg: leg.direction):
        drawn = {**style, "markerfacecolor": "white"}
        if leg.direction == "retraction":
            drawn["markerfacecolor"] = style["color"]
            if style.get("linestyle") != "none":
                drawn["linestyle"] = RETRACTION
        u, v = x[leg.steps], y[leg.steps]
        axes.plot(u, v, label=label, **drawn)
        label = None
        # An arrow in the middle of the part of the line in which y changes.
        finite = np.isfinite(u) & np.isfinite(v)
        starts = np.flatnonzero(finite[:-1] & finite[1:] & (v[1:] != v[:-1]))
        if arrows and starts.size:
            start = int(starts[starts.size // 2])
            arrow = {"arrowstyle": "-|>", "mutation_scale": 15, "shrinkA": 0, "shrinkB": 0}
            axes.annotate(
                "",
                xy=((u[start] + u[start + 1]) / 2, (v[start] + v[start + 1]) / 2),
                xytext=(u[start], v[start]),
                arrowprops=arrow | {"color": style["color"]},
            )


def name_legs(axes: Axes, paths: Iterable[Iterable[Leg]], hue: str = "0.4") -> None:
    """Name approach and retraction in the legend to come, if the paths have both.

    ``hue`` is the colour of the curve, if there is only one.
    """
    if len({leg.direction for path in paths for leg in path}) > 1:
        style: dict[str, Any] = {"color": hue, "marker": "o", "markersize": 4}
        axes.plot([], [], label="approach", markerfacecolor="white", **style)
        axes.plot([], [], label="retraction", linestyle=RETRACTION, **style)
