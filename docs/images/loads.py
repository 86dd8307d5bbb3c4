"""Draws the three figures of the page on loads: tensions, layers, and a ridge that grows.

Run it as ``python docs/images/loads.py``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.show import save_figure
from pellicle.show.figure_style import OKABE_ITO

MODULUS, LIQUID = 4e3, 0.02
"""Reduced modulus of an incompressible gel of 3 kPa [Pa], and γ sin θ of the liquid [N/m]."""
TENSIONS = 0.035, 0.05, 0.1, 0.2, 0.4
THICKNESSES = 10e-6, 30e-6, 100e-6, 300e-6
TIMES = 0.0, 0.1, 0.3, 1.0, 3.0, 30.0


def main() -> None:
    """Write the pictures next to this file."""
    for draw in (tensions, layers, growth):
        stem = Path(__file__).with_name(f"loads-{draw.__name__}")
        save_figure(draw, stem, ["png"], (6.4, 3.4))


def tensions(figure: Figure) -> None:
    """Draw the ridge under a straight contact line for five tensions."""
    axes = axes_of(figure, "distance from the contact line")
    for number, tension in enumerate(TENSIONS):
        kernel = {"type": "tensed_membrane", "reduced_modulus": MODULUS, "tension": tension}
        data = solved(
            grid={"points": [1024, 2], "size": 0.4e-3, "boundary": "periodic"},
            kernel=kernel,
            load={"type": "ridge", "line_force": -LIQUID},
        )
        height = -data["displacement"].values[0, :, 0]
        # Against the surface midway to the next line.
        plot(axes, data["x"].values, height - height[0], number, f"{tension * 1e3:g} mN/m")
    axes.legend(title="surface tension τ₀", frameon=False)
    axes.set_xlim(-100, 100)


def layers(figure: Figure) -> None:
    """Draw a droplet on a bonded layer of four thicknesses."""
    axes = axes_of(figure, "distance from the centre of the drop")
    for number, thickness in enumerate(THICKNESSES):
        layer = {
            "type": "bonded_layer",
            "youngs_modulus": 3e3,
            "poissons_ratio": 0.5,
            "thickness": thickness,
        }
        data = solved(
            grid={"points": 256, "size": 0.5e-3},
            kernel={"type": "coated", "tension": 0.04, "substrate": layer},
            load={
                "type": "droplet",
                "radius": 0.1e-3,
                "surface_tension": LIQUID,
                "contact_angle": "90 degree",
            },
        )
        line = -data["displacement"].values[0, :, 128]
        plot(axes, data["x"].values, line, number, f"{thickness * 1e6:g} µm")
    axes.legend(title="thickness", frameon=False)


def growth(figure: Figure) -> None:
    """Draw a ridge that grows on a gel whose modulus falls to a fifth."""
    axes = axes_of(figure, "distance from the contact line")
    gel = {
        "type": "viscoelastic",
        "solid": {"type": "half_space", "reduced_modulus": 5 * MODULUS},
        "relaxation": [{"fraction": 0.8, "time": "1 s"}],
    }
    data = solved(
        grid={"points": [1024, 2], "size": 0.4e-3, "boundary": "periodic"},
        kernel={"type": "coated", "tension": 0.04, "substrate": gel},
        load={"type": "ridge", "line_force": -LIQUID},
        loading={"time": TIMES},
    )
    for number, time in enumerate(TIMES):
        height = -data["displacement"].values[number, :, 0]
        plot(axes, data["x"].values, height - height[0], number, f"{time:g} s")
    axes.legend(title="time", frameon=False)
    axes.set_xlim(-100, 100)


def solved(**parts: Any) -> Any:
    """Return the dataset of a run."""
    return pl.run(pl.Run(**parts), progress=False).dataset


def axes_of(figure: Figure, across: str) -> Axes:
    """Return axes in micrometres."""
    axes = figure.add_subplot()
    axes.set(xlabel=f"{across} [µm]", ylabel="height of the surface [µm]")
    return axes


def plot(axes: Axes, x: Any, height: Any, number: int, label: str) -> None:
    """Draw a surface, its lengths in m."""
    axes.plot(
        np.asarray(x) * 1e6, height * 1e6, color=OKABE_ITO[number], label=label, linewidth=1.2
    )


if __name__ == "__main__":
    main()
