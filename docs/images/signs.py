"""Draws ``signs.png``: what depth, displacement, profile, gap and mean plane are, and their signs.

Run it as ``python docs/images/signs.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.arrays import Array
from pellicle.show import save_figure
from pellicle.show.figure_style import OKABE_ITO

BLUE, ORANGE, GREEN = OKABE_ITO[:3]
SOLID, BODY = "#e8eef4", "#d9d9d9"
BOTTOM, TOP = 2.0, -4.0


def main() -> None:
    """Write the picture next to this file."""
    save_figure(draw, Path(__file__).with_name("signs"), ["png"], (9.6, 4.6))


def draw(figure: Figure) -> None:
    """Draw a bead on a free boundary and a rough surface on a periodic one."""
    left, right = figure.subplots(1, 2)
    _bead(left)
    _rough(right)
    for axes in (left, right):
        axes.set_ylim(BOTTOM, TOP)
        axes.axis("off")


def _bead(axes: Axes) -> None:
    """Draw a paraboloid that a spring holds, on the surface of Hertz."""
    radius, depth = 2.6, 1.0
    edge = np.sqrt(depth * radius)
    x = np.linspace(-4.6, 4.6, 601)
    r = np.maximum(np.abs(x), edge)
    outside = (2 * edge**2 - r**2) * np.arcsin(edge / r) + edge * np.sqrt(r**2 - edge**2)
    bottom = depth - x**2 / (2 * radius)
    surface = np.where(np.abs(x) > edge, outside / (np.pi * radius), bottom)
    _bodies(axes, x, surface, np.where(bottom > -1.45, bottom, np.nan), -1.45)
    axes.set_title("one indenter, free boundary")
    _line(axes, x, "undeformed surface, z = 0")
    # The spring, and the base that holds it; dotted, where that is at first touch.
    at_touch, base = -3.7, -2.4
    axes.plot([-0.9, 0.9], [at_touch] * 2, ":", color="0.3")
    axes.text(1.05, at_touch, "base at first touch", va="center", fontsize=9)
    axes.fill_between([-0.9, 0.9], base - 0.16, base, color="0.35")
    zigzag = np.array([0, 0, 1, -1, 1, -1, 1, 0, 0]) * 0.22
    axes.plot(zigzag, np.linspace(base, -1.45, zigzag.size), color="0.2", linewidth=1.2)
    axes.text(0.35, -1.95, "spring k", va="center", fontsize=9)
    _arrow(axes, 0.65, at_touch, base - 0.16, "base_displacement", "0.2", 1)
    _arrow(axes, 0.0, 0.0, depth, "δ", BLUE, -1)
    _arrow(axes, 1.05, 0.0, bottom[np.argmin(abs(x - 1.05))], "u", GREEN, 1)
    at = 2.55
    here = np.argmin(abs(x - at))
    axes.plot([0, at], [depth, depth], linewidth=0.6, color="0.4")
    _arrow(axes, at, depth, bottom[here], "f < 0", ORANGE, 1, 0.36)
    at = -2.9
    here = np.argmin(abs(x - at))
    _arrow(axes, at, bottom[here], surface[here], "gap", "0.2", -1, 0.35)
    _arrow(axes, -3.9, -3.7, -2.7, "z, into the solid", "0.2", 1)


def _rough(axes: Axes) -> None:
    """Draw a surface of two waves, solved as a line contact on a periodic half-space."""
    points = 512
    x = 2 * np.pi * (np.arange(points) + 0.5) / points
    heights = 0.8 * np.cos(x - 2.2) + 0.45 * np.cos(3 * x + 0.4)
    profile = heights - heights.max()
    depth = 0.62 * -profile.mean()
    result = pl.run(
        {
            "grid": {"points": [points, 1], "size": [20 * np.pi, 1.0], "boundary": "periodic"},
            "kernel": {"type": "half_space", "reduced_modulus": 1.0},
            "indenter": {"type": "heights", "values": profile[:, None], "unit": "1 m"},
            "loading": {"depth": depth},
        },
        progress=False,
    )
    surface = result.dataset["displacement"].isel(step=0).values.ravel()
    x = 9.2 * (x / (2 * np.pi) - 0.5)
    bottom = depth + profile
    _bodies(axes, x, surface, bottom, -2.6)
    axes.set_title("a rough surface, periodic half-space")
    _line(axes, x, "mean plane of the deformed surface, z = 0")
    mean = float(bottom.mean())
    axes.plot([-4.6, 4.6], [mean] * 2, "--", color=ORANGE, linewidth=1.0)
    axes.text(-2.4, mean - 0.1, "mean plane of the heights", fontsize=9, color=ORANGE)
    lowest = int(np.argmax(bottom))
    _arrow(axes, x[lowest], 0.0, bottom[lowest], "δ", BLUE, -1)
    _arrow(axes, 2.9, 0.0, mean, "", ORANGE, -1)
    axes.text(4.4, 0.3, "mean_plane_depth < 0", ha="right", va="center", color=ORANGE)


def _bodies(axes: Axes, x: Array, surface: Array, bottom: Array, top: float) -> None:
    axes.fill_between(x, surface, BOTTOM, color=SOLID, linewidth=0)
    axes.plot(x, surface, color="0.2", linewidth=1.2)
    axes.fill_between(x, bottom, top, color=BODY, linewidth=0)
    axes.plot(x, bottom, color="0.2", linewidth=1.2)


def _line(axes: Axes, x: Array, words: str) -> None:
    """Draw the plane from which a depth counts, and say below which it is."""
    axes.plot([x[0], x[-1]], [0.0, 0.0], "--", color="0.4", linewidth=0.9)
    axes.plot([x[0] + 0.2, x[0] + 1.0], [1.75, 1.75], "--", color="0.4", linewidth=0.9)
    axes.text(x[0] + 1.2, 1.75, words, va="center", fontsize=9)


def _arrow(
    axes: Axes,
    x: float,
    start: float,
    end: float,
    name: str,
    colour: str,
    side: int,
    share: float = 0.5,
) -> None:
    """Draw an arrow from where a quantity is 0 to its value, with its name to a side."""
    axes.annotate(
        "",
        (x, end),
        (x, start),
        arrowprops={"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0},
    )
    align = "left" if side > 0 else "right"
    at = start + share * (end - start)
    axes.text(x + 0.1 * side, at, name, ha=align, va="center", color=colour, fontsize=11)


if __name__ == "__main__":
    main()
