"""Draws docs/images/kernels.png: the compliance of every built-in kernel against wavenumber.

python docs/images/kernels.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.show import save_figure
from pellicle.show.figure_style import LINES

MODULUS, LENGTH = 10e3, 100e-6  # E*, and the one length that all kernels are given
TENSION = MODULUS * LENGTH / 2  # so that s = 2τ₀/E* is LENGTH
SOLID = {"reduced_modulus": MODULUS, "poissons_ratio": 0.3}
LAYER = SOLID | {"thickness": LENGTH}
SOFT = LAYER | {"poissons_ratio": 0.5}

SKINS = {
    "half_space": pl.kernel("half_space", reduced_modulus=MODULUS),
    "tensed_membrane": pl.kernel("tensed_membrane", reduced_modulus=MODULUS, tension=TENSION),
    "bending_skin": pl.kernel(
        "bending_skin", reduced_modulus=MODULUS, bending=MODULUS * LENGTH**3 / 2
    ),
    "gurtin_murdoch, ν = 0": pl.kernel(
        "gurtin_murdoch",
        reduced_modulus=MODULUS,
        poissons_ratio=0.0,
        surface_stiffness=10 * TENSION,
    ),
}
LAYERS = {
    "half_space": SKINS["half_space"],
    "frictionless_layer": pl.kernel("frictionless_layer", **LAYER),
    "bonded_layer, ν = 0.3": pl.kernel("bonded_layer", **LAYER),
    "bonded_layer, ν = 0.5": pl.kernel("bonded_layer", **SOFT),
    "coated: bonded_layer, ν = 0.5": pl.kernel(
        "coated", tension=TENSION, substrate=pl.kernel("bonded_layer", **SOFT)
    ),
    "layered: film 0.1 h, 100 E*, on ν = 0.5": pl.kernel(
        "layered",
        layers=[
            {"reduced_modulus": 100 * MODULUS, "poissons_ratio": 0.3, "thickness": LENGTH / 10},
            SOFT,
        ],
        substrate="rigid",
    ),
    "winkler, k = E*/h": pl.kernel("winkler", foundation=MODULUS / LENGTH),
}


def main() -> None:
    """Draw."""
    save_figure(draw, Path(__file__).with_name("kernels"), ["png"], (9.6, 4.6))


def draw(figure: Figure) -> None:
    """Draw the kernels of both panels, told apart by colour and by dashes."""
    panels = figure.subplots(1, 2, sharey=True)
    q = np.geomspace(1e-2, 1e2, 400) / LENGTH
    for axes, kernels, name in zip(panels, (SKINS, LAYERS), ("ℓ", "h"), strict=True):
        for index, (label, kernel) in enumerate(kernels.items()):
            g = kernel.compliance(q) * MODULUS / LENGTH
            colour, width = ("0.7", 4.0) if index == 0 else (f"C{index - 1}", 1.6)
            dashes = LINES[(index - 1) % len(LINES)] if index else "-"
            axes.loglog(q * LENGTH, g, dashes, color=colour, linewidth=width, label=label)
        axes.set(xlabel=f"wavenumber × length, q{name}", ylim=(1e-9, 3e2))
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small", loc="lower left")
    panels[0].set(ylabel="compliance G E*/ℓ", title="half-space under a skin, s = ℓ")
    panels[1].set(title="layer of thickness h = ℓ, springs")


if __name__ == "__main__":
    main()
