"""Draws docs/images/solids.png: a cross-section of the solid of every built-in kernel.

python docs/images/solids.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from pellicle.show import save_figure
from pellicle.show.figure_style import OKABE_ITO

SOLID, FILM, SKIN = "0.87", "0.6", OKABE_ITO[1]
TENSED, BENT = "tension τ₀", "bending B"
TOP, BOTTOM = 0.75, 0.05
"""Height of the surface, and of the lower edge of what is drawn."""


def main() -> None:
    """Draw."""
    save_figure(draw, Path(__file__).with_name("solids"), ["png"], (9.6, 3.2))


def draw(figure: Figure) -> None:
    """Draw ten solids."""
    panels = figure.subplots(2, 5).ravel()
    for axes, (name, parts) in zip(panels, SOLIDS.items(), strict=True):
        for part, *values in parts:
            part(axes, *values)
        axes.set(xlim=(-0.15, 1.15), ylim=(-0.03, 0.92))
        axes.axis("off")
        axes.set_title(name, family="monospace", fontsize="small")


def block(axes: Axes, top: float, bottom: float, colour: str, text: str = "") -> None:
    """Draw a layer."""
    axes.add_patch(Rectangle((0, bottom), 1, top - bottom, facecolor=colour, edgecolor="none"))
    axes.text(0.5, (top + bottom) / 2, text, ha="center", va="center", fontsize="x-small")


def base(axes: Axes, gap: float) -> None:
    """Draw a rigid base, on which rollers run if there is a gap."""
    top = 0.12
    hatched = {"facecolor": "white", "edgecolor": "0.3", "hatch": "/////", "linewidth": 0.0}
    axes.add_patch(Rectangle((0, top - 0.12), 1, 0.12, **hatched))
    axes.plot([0, 1], [top, top], color="black", linewidth=1.2)
    for x in np.linspace(0.08, 0.92, 8) if gap else ():
        axes.plot(x, top + gap / 2, "o", color="black", markersize=4, markerfacecolor="white")


def skin(axes: Axes, text: str, width: float) -> None:
    """Draw a skin under tension."""
    axes.plot([0, 1], [TOP, TOP], color=SKIN, linewidth=width, solid_capstyle="butt")
    for end, way in ((0, -1), (1, 1)):
        axes.annotate(
            "",
            (end + 0.14 * way, TOP),
            (end, TOP),
            arrowprops={"arrowstyle": "->", "color": SKIN, "shrinkA": 0, "shrinkB": 0},
        )
    axes.text(0.5, TOP + 0.05, text, ha="center", va="bottom", fontsize="x-small", color=SKIN)


def springs(axes: Axes) -> None:
    """Draw springs side by side on a rigid base."""
    base(axes, 0)
    y = np.linspace(0.12, TOP, 40)
    for x in np.linspace(0.08, 0.92, 8):
        axes.plot(x + 0.035 * np.sin(np.linspace(0, 8 * np.pi, 40)), y, color="0.4", linewidth=1)


def relaxation(axes: Axes) -> None:
    """Draw how a stiffness falls in time."""
    t = np.linspace(0, 1, 50)
    axes.plot(0.3 + 0.4 * t, 0.2 + 0.4 * (0.25 + 0.75 * np.exp(-4 * t)), color="black")
    axes.annotate("", (0.78, 0.2), (0.25, 0.2), arrowprops={"arrowstyle": "->", "linewidth": 0.7})
    axes.text(0.8, 0.2, "$t$", va="center", fontsize="x-small")
    axes.text(0.23, 0.55, "$E$", ha="right", va="center", fontsize="x-small")


HALF_SPACE = (block, TOP, BOTTOM, SOLID)
LAYER = (block, TOP, 0.12, SOLID, "h")
BASE = (base, 0)
SOLIDS = {
    "half_space": [(block, TOP, BOTTOM, SOLID, "E*")],
    "tensed_membrane": [HALF_SPACE, (skin, TENSED, 1.5)],
    "bending_skin": [HALF_SPACE, (skin, f"{TENSED}, {BENT}", 4.0)],
    "gurtin_murdoch": [HALF_SPACE, (skin, "τ₀, stretching κₛ", 4.0)],
    "coated": [(block, TOP, BOTTOM, SOLID, "any kernel"), (skin, f"{TENSED}, {BENT}", 4.0)],
    "bonded_layer": [LAYER, BASE],
    "frictionless_layer": [(block, TOP, 0.2, SOLID, "h"), (base, 0.08)],
    "layered": [
        (block, TOP, 0.63, FILM, "film"),
        (block, 0.63, 0.3, SOLID, "gel"),
        (block, 0.3, BOTTOM, "0.75", "glass"),
    ],
    "winkler": [(springs,)],
    "viscoelastic": [HALF_SPACE, (relaxation,)],
}


if __name__ == "__main__":
    main()
