"""Draws ``loading.png``: force against depth, there and back, and the contact stiffness.

Run it as ``python docs/images/loading.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import pellicle as pl
from pellicle.show import save_figure
from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid

RADIUS, MODULUS, DEEPEST = 1e-3, 10e3, 40e-6
TENSIONS = {0.0: ("C0", "o"), 0.5: ("C1", "s")}


def main() -> None:
    """Write the picture next to this file."""
    save_figure(draw, Path(__file__).with_name("loading"), ["png"], (9.6, 4.2))


def draw(figure: Figure) -> None:
    """Solve and draw."""
    left, right = figure.subplots(1, 2)
    for tension, (colour, marker) in TENSIONS.items():
        label = f"τ₀ = {tension:g} N/m"
        data = pl.run(
            {
                "grid": {"points": 96, "size": "0.45 mm"},
                "kernel": {
                    "type": "tensed_membrane",
                    "reduced_modulus": MODULUS,
                    "tension": tension,
                },
                "indenter": {"type": "paraboloid", "radius": RADIUS},
                "loading": {
                    "depth": {"start": DEEPEST / 8, "stop": DEEPEST, "num": 8, "back": True},
                    "stiffness": True,
                },
            },
            progress=False,
        ).dataset
        depth, force, stiffness = (data[n].values for n in ("depth", "force", "stiffness"))
        steps = slice(0, 8)
        left.plot(depth[steps] * 1e6, force[steps] * 1e6, marker, color=colour, mfc="white", ms=7)
        left.plot(depth[8:] * 1e6, force[8:] * 1e6, "x", color=colour, ms=5)
        for d, f, k in zip(depth[steps], force[steps], stiffness[steps], strict=True):
            near = np.array([-1, 1]) * DEEPEST / 22
            left.plot((d + near) * 1e6, (f + k * near) * 1e6, color=colour, linewidth=1.0)
        left.plot([], [], marker, color=colour, mfc="white", label=label)
        right.plot(depth[steps] * 1e6, stiffness[steps], marker, color=colour, mfc="white")
        finer = np.linspace(DEEPEST / 20, DEEPEST, 20)
        exact = [indent(Paraboloid(radius=RADIUS), MODULUS, tension, depth=d).force for d in finer]
        right.plot(finer * 1e6, np.gradient(exact, finer, edge_order=2), color=colour, label=label)
    left.plot([], [], "x", color="0.4", label="unloading")
    left.plot([], [], color="0.4", linewidth=1.0, label="slope dF/dδ of the solution")
    left.set(xlabel="depth δ [µm]", ylabel="force F [µN]", xlim=(0, None), ylim=(0, None))
    right.set(xlabel="depth δ [µm]", ylabel="contact stiffness dF/dδ [N/m]", xlim=(0, None))
    right.set_ylim(bottom=0)
    for axes in (left, right):
        axes.grid(alpha=0.3)
        axes.legend()


if __name__ == "__main__":
    main()
