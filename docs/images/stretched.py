"""Draws ``stretched.png``: the contact of a sphere under a skin that is tensed more one way.

Run it as ``python docs/images/stretched.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.arrays import Dataset
from pellicle.show import save_figure
from pellicle.show.figure_style import OKABE_ITO

RADIUS, SIZE, POINTS = 50e-6, 0.8e-3, 256
MEAN = 0.05  # √(T₁T₂) [N/m]
RATIOS = (1.0, 2.0, 4.0, 8.0)
MODULI = {20.0: 1e2, 2.0: 1e3, 0.2: 1e4}
"""E* [Pa] by s/a, with s = 2√(T₁T₂)/E* and a the radius of the circle of the contact's area."""


def main() -> None:
    """Write the picture next to this file, and print its numbers."""
    save_figure(draw, Path(__file__).with_name("stretched"), ["png"], (8.4, 3.6))


def contact(ratio: float, modulus: float) -> Dataset:
    """Return the step of a sphere on a skin with T₂ = ratio T₁, T₁ along x."""
    tension = [MEAN / np.sqrt(ratio), MEAN * np.sqrt(ratio)]
    run = {
        "grid": {"points": POINTS, "size": SIZE, "boundary": "periodic"},
        "kernel": {"type": "tensed_membrane", "reduced_modulus": modulus, "tension": tension},
        "indenter": {"type": "paraboloid", "radius": 1e-3},
        "loading": {"contact_radius": RADIUS},
    }
    return pl.run(run, progress=False).dataset.isel(step=0)


def draw(figure: Figure) -> None:
    """Solve and draw."""
    shapes, slender = figure.subplots(1, 2)
    for colour, (length, modulus) in zip(OKABE_ITO, MODULI.items(), strict=False):
        values = []
        for ratio in RATIOS:
            step = contact(ratio, modulus)
            values.append(float(step["semi_major_axis"] / step["semi_minor_axis"]))
            if length == 2.0 and ratio in (1.0, 2.0, 8.0):
                x, y = step["x"].values * 1e6, step["y"].values * 1e6
                inside = step["contact"].values.T.astype(float)
                shapes.contour(x, y, inside, [0.5], colors=[str(0.7 - 0.1 * ratio**0.9)])
        print(f"s/a = {length:g}:", ", ".join(f"{value:.2f}" for value in values))
        slender.plot(RATIOS, values, "o-", color=colour, label=f"s/a = {length:g}")
    fine = np.linspace(1, RATIOS[-1])
    slender.plot(fine, np.sqrt(fine), color="black", linewidth=0.8, label="no solid: √(T₂/T₁)")
    slender.set(xlabel="T₂/T₁", ylabel="slenderness of the contact")
    slender.legend(frameon=False)
    limits = -100, 100
    shapes.set(xlabel="x [µm]", ylabel="y [µm]", aspect="equal", xlim=limits, ylim=limits)
    shapes.set_title("s/a = 2: T₂/T₁ = 1, 2 and 8", fontsize="medium")


if __name__ == "__main__":
    main()
