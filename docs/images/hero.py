"""Draws gallery/hero.png: a rough punch on a tensed solid, its pressure and a profile through it.

python docs/images/hero.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.show import save_figure
from pellicle.show.figure_style import NO_CONTACT, OKABE_ITO

POINTS, SIZE = 512, 200e-6
RUN = {
    "grid": {"points": POINTS, "size": SIZE},
    "kernel": {"type": "tensed_membrane", "reduced_modulus": "10 kPa", "tension": "20 mN/m"},
    "indenter": {
        "type": "sum",
        "parts": [
            {"type": "sphere", "radius": "150 um"},
            {
                "type": "self_affine",
                "rms_height": "0.35 um",
                "hurst": 0.8,
                "roll_off_wavelength": "50 um",
                "cutoff_wavelength": "6 um",
                "seed": 4,
            },
        ],
    },
    "loading": {"depth": "14 um"},
    "solver": {"type": "active_set", "tolerance": 1e-6},
}


def main() -> None:
    """Solve and draw."""
    step = pl.run(RUN, progress=False).dataset.isel(step=0)
    x, pressure = step["x"].values * 1e6, step["pressure"].values * 1e-3
    line = step.isel(y=POINTS // 2)
    surface = -line["displacement"].values * 1e6
    indenter = surface + line["gap"].values * 1e6

    def draw(figure: Figure) -> None:
        left, right = figure.subplots(1, 2, width_ratios=(1, 1.25))
        edge = SIZE / 2 * 1e6
        image = left.imshow(
            np.ma.masked_equal(pressure.T, 0),
            origin="lower",
            extent=(-edge, edge, -edge, edge),
            cmap="inferno",
            vmin=0,
            interpolation="nearest",
        )
        left.set_facecolor(NO_CONTACT)
        left.axhline(x[POINTS // 2], color="black", linewidth=0.6, linestyle=(0, (6, 4)))
        left.set(xlim=(-60, 60), ylim=(-60, 60))
        left.set(xlabel="x [µm]", ylabel="y [µm]", title="contact pressure")
        beside = left.inset_axes((1.04, 0.0, 0.05, 1.0))
        figure.colorbar(image, cax=beside, label="pressure [kPa]")
        low, high = surface.min() - 5, surface.max() + 8
        right.fill_between(x, np.minimum(indenter, high), high, color="0.35", linewidth=0)
        right.fill_between(x, surface, low, color="#BFE3F5", linewidth=0)
        right.plot(x, surface, color=OKABE_ITO[0], linewidth=1.6)
        right.set(
            xlabel="x [µm]",
            ylabel="height [µm]",
            title="along the dashed line",
            xlim=(-80, 80),
            ylim=(low, high),
        )
        right.text(0, high - 2, "rough bead", color="white", ha="center", va="top")
        right.text(0, low + 1, "gel under tension", ha="center", va="bottom")

    save_figure(draw, Path(__file__).with_name("gallery") / "hero", ["png"], (10.0, 4.0))


if __name__ == "__main__":
    main()
