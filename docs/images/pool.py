"""Draws ``pool.png``: a small and a large bead on one solid, fitted together (docs/curves.md).

Run it as ``python docs/images/pool.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import pellicle as pl
from pellicle_fit.report.figures import save_figure


def main() -> None:
    """Fit, draw and write the picture next to this file."""
    random = np.random.default_rng(2)
    curves = {}
    radii = (5e-6, 50e-6)
    for radius in radii:
        bead = pl.indenter("paraboloid", radius=radius)
        assert isinstance(bead, pl.HasForceCurve)
        depth = np.linspace(-0.3, 1, 300) * 0.3 * radius
        force = 2e3 * bead.force_curve(depth, 5e-6).force
        force += 0.01 * force.max() * random.standard_normal(depth.size)
        curves[f"{1e6 * radius:.0f} µm"] = depth + 3.2e-6, force
    fit = pl.fit_pooled(curves, indenter="paraboloid", radius=list(radii))
    save_figure(fit, Path(__file__).with_name("pool"))


if __name__ == "__main__":
    main()
