"""Draws ``fit.png``: the curve of docs/fit.md, its fit, and the likelihood of its parameters.

Run it as ``python docs/images/fit.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

import pellicle as pl
from pellicle_fit.report.figures import save_figure


def main() -> None:
    """Fit, draw and write the picture next to this file."""
    bead = pl.indenter("sphere", radius="5 um")
    assert isinstance(bead, pl.HasForceCurve)
    depth = np.linspace(-0.5e-6, 1.5e-6, 1000)
    force = 2e3 * bead.force_curve(depth, 5e-6).force
    force += 0.005 * force.max() * np.random.default_rng(1).standard_normal(depth.size)
    save_figure(pl.fit(depth + 3.2e-6, force, indenter=bead), Path(__file__).with_name("fit"))


if __name__ == "__main__":
    main()
