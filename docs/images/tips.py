"""Draws ``tips.png``: the tips that laboratories have, with the lengths and angles of their fields.

Run it as ``python docs/images/tips.py``.
"""

from __future__ import annotations

from math import atan, cos, pi, radians, tan
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc

import pellicle as pl
from pellicle.components import Indenter
from pellicle.show import save_figure

ANGLE = radians(50)
X = np.linspace(-1.6, 1.6, 801)


def main() -> None:
    """Write the picture next to this file."""
    save_figure(draw, Path(__file__).with_name("tips"), ["png"], (9.6, 4.6))


def draw(figure: Figure) -> None:
    """Draw sections of six tips."""
    axes = figure.subplots(2, 3).ravel()
    edge = atan(tan(ANGLE) / cos(pi / 4))
    cone = {"half_angle": ANGLE}
    tips = (
        ("cone", pl.indenter("cone", **cone), 0.0, ANGLE, "half_angle"),
        ("cone, tip_radius", pl.indenter("cone", **cone, tip_radius=0.6), 0.0, ANGLE, "half_angle"),
        ("pyramid, through its faces", pl.indenter("pyramid", **cone), 0.0, ANGLE, 'of "faces"'),
        ("pyramid, through its edges", pl.indenter("pyramid", **cone), pi / 4, edge, 'of "edges"'),
        ("sphere", pl.indenter("sphere", radius=1.2), 0.0, None, ""),
        ("sphere, flat_radius", pl.indenter("sphere", radius=1.2, flat_radius=0.5), 0.0, None, ""),
    )
    for one, (title, tip, azimuth, angle, words) in zip(axes, tips, strict=True):
        section(one, tip, azimuth)
        one.set_title(title, fontsize="medium")
        if angle is not None:
            marked(one, tip, angle, words)
    arrow = {"arrowstyle": "->", "color": "C3"}
    axes[1].annotate("", (0.0, 0.0), (0.0, 0.6), arrowprops=arrow)
    axes[1].text(-0.06, 0.62, "tip_radius", color="C3", ha="right")
    axes[4].annotate("", (1.2 * np.sin(0.9), 1.2 - 1.2 * np.cos(0.9)), (0.0, 1.2), arrowprops=arrow)
    axes[4].text(-0.06, 0.95, "radius", color="C3", ha="right")
    axes[5].annotate("", (0.5, -0.12), (0.0, -0.12), arrowprops={**arrow, "arrowstyle": "<->"})
    axes[5].text(0.25, -0.2, "flat_radius", color="C3", ha="center", va="top")


def section(axes: Axes, tip: Indenter, azimuth: float) -> None:
    """Draw a tip in the plane of an azimuth [rad] through its axis."""
    height = -np.asarray(tip.profile(X * np.cos(azimuth), X * np.sin(azimuth)))
    inside = np.isfinite(height) & (height < 1.3)
    axes.fill_between(X[inside], height[inside], 1.3, color="0.85", edgecolor="black")
    axes.axvline(0.0, color="0.5", linestyle="-.", linewidth=0.8)
    axes.axhline(0.0, color="C0", linewidth=1.0)
    axes.set(xlim=(-1.6, 1.6), ylim=(-0.45, 1.35), aspect="equal")
    axes.set_axis_off()


def marked(axes: Axes, tip: Indenter, angle: float, words: str) -> None:
    """Mark the angle between axis and flank, at the point where the flank meets the axis."""
    radius = getattr(tip, "tip_radius", None) or 0.0
    apex = -radius / 2 / tan(ANGLE) ** 2
    reach = 1.3 - apex
    axes.plot([0.0, reach * tan(angle)], [apex, 1.3], color="C3", linestyle="--", linewidth=0.9)
    sweep = Arc((0.0, apex), 1.5, 1.5, theta1=90 - np.degrees(angle), theta2=90, color="C3")
    axes.add_patch(sweep)
    axes.text(0.14, apex + 0.86, words, color="C3")


if __name__ == "__main__":
    main()
