"""Draws ``indent-profile.png``: pressure under a paraboloid, with and without tension.

Run it as ``python docs/images/make.py``.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.style
import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle_plugins.analytic.axisymmetric import indent
from pellicle_plugins.indenters.paraboloid import Paraboloid

RADIUS, MODULUS, DEPTH = 1e-3, 10e3, 50e-6
TENSIONS = {0.0: "C0", 0.1: "C2", 1.0: "C3"}
POINTS, SIZE = 128, 0.5e-3


def main() -> None:
    """Solve, draw and write the picture next to this file."""
    matplotlib.style.use("default")
    figure = Figure(figsize=(6.4, 3.9), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    for tension, colour in TENSIONS.items():
        true = indent(Paraboloid(radius=RADIUS), MODULUS, tension, depth=DEPTH)
        r = np.linspace(0, 0.999999 * true.contact_radius, 400)
        r, p = np.append(r, true.contact_radius), np.append(true.pressure(r), 0.0)
        for side in (-1, 1):
            axes.plot(side * r * 1e3, p * 1e-3, color=colour, linewidth=1.2)
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
        line = line.isel(x=slice(line.sizes["x"] // 2 % 3, None, 3))
        axes.plot(
            line["x"].values * 1e3,
            line["pressure"].values * 1e-3,
            "o",
            color=colour,
            markersize=3.5,
            markerfacecolor="white",
            label=f"τ₀ = {tension:g} N/m",
        )
    axes.plot([], [], color="0.4", linewidth=1.2, label="integral equation")
    axes.set(
        xlabel="x [mm]",
        ylabel="contact pressure [kPa]",
        title="Paraboloid, R = 1 mm, E* = 10 kPa, depth 50 µm",
    )
    axes.set_ylim(0.0, 4.0)
    axes.set_xlim(-SIZE / 2 * 1e3, SIZE / 2 * 1e3)
    axes.legend(frameon=False, loc="upper center", ncols=2)
    figure.savefig(Path(__file__).with_name("indent-profile.png"))


if __name__ == "__main__":
    main()
