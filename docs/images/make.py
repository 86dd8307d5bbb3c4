"""Draws ``indent-profile.png``: pressure under a paraboloid, with and without tension.

Run it as ``python docs/images/make.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.show import save_figure
from pellicle.show.figure_style import OKABE_ITO
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid

RADIUS, MODULUS, DEPTH = 1e-3, 10e3, 50e-6
TENSIONS = {0.0: (OKABE_ITO[0], "o"), 0.1: (OKABE_ITO[1], "s"), 1.0: (OKABE_ITO[2], "^")}
POINTS, SIZE = 128, 0.5e-3
_EDGE = 2
"""Cells at the edge, whose pressure depends on where it passes through them."""


def main() -> None:
    """Write the picture next to this file."""
    save_figure(draw, Path(__file__).with_name("indent-profile"), ["png"], (6.4, 3.9))


def draw(figure: Figure) -> None:
    """Solve and draw."""
    axes = figure.add_subplot()
    for tension, (colour, marker) in TENSIONS.items():
        true = indent(Paraboloid(radius=RADIUS), MODULUS, tension, depth=DEPTH)
        r = np.linspace(0, 0.999999 * true.contact_radius, 400)
        r, p = np.append(r, true.contact_radius), np.append(true.pressure(r), 0.0)
        for side in (-1, 1):
            axes.plot(side * r * 1e3, p * 1e-3, color="black", linewidth=0.8, zorder=1)
        result = pl.run(
            {
                "grid": {"points": POINTS, "size": SIZE},
                "kernel": {
                    "type": "tensed_membrane",
                    "reduced_modulus": MODULUS,
                    "tension": tension,
                },
                "indenter": {"type": "paraboloid", "radius": RADIUS},
                "loading": {"depth": DEPTH},
            },
            progress=False,
        )
        line = result.dataset.isel(step=0, y=POINTS // 2)
        line = line.isel(x=line["contact"].values)
        line = line.isel(x=slice(_EDGE, -_EDGE))
        line = line.isel(x=slice(line.sizes["x"] // 2 % 3, None, 3))
        axes.plot(
            line["x"].values * 1e3,
            line["pressure"].values * 1e-3,
            marker,
            color=colour,
            markersize=3.5,
            markerfacecolor="white",
            label=f"τ₀ = {tension:g} N/m",
        )
    axes.plot([], [], color="black", linewidth=0.8, label="integral equation")
    axes.set(
        xlabel="x [mm]",
        ylabel="contact pressure [kPa]",
        title="Paraboloid, R = 1 mm, E* = 10 kPa, depth 50 µm",
    )
    axes.set_ylim(0.0, 4.4)
    axes.set_xlim(-SIZE / 2 * 1e3, SIZE / 2 * 1e3)
    axes.legend(frameon=False, loc="upper center", ncols=2)


if __name__ == "__main__":
    main()
