"""Whether fits of curves that were made on a grid, with noise, hold modulus and tension.

    python tests/benchmarks/grid_tips.py 20 [seed [kinds]]

For cones with a blunt tip and for sharp pyramids it prints in how many of so many curves the
intervals hold, and the CPU time of a fit beside that of a sphere.
"""

from __future__ import annotations

import sys
from time import process_time
from typing import Any

import numpy as np
from fit_verdicts import held
from scipy.interpolate import CubicSpline
from tables import print_head, print_row

import pellicle as pl
from pellicle.components import Indenter
from pellicle_fit.simulated.simulation import half_widths
from tests.physics.frozen.fit_curves import MODULUS, Array

DEEPEST, ROWS, NOISE = 1.5e-6, 350, 0.005
DEPTHS: Array = DEEPEST * np.geomspace(1e-3, 1, 22)
"""Depths of contacts [m], between which forces are interpolated."""
POINTS, ROOM = (96, 192), 1.1
"""Points of two grids from which forces are extrapolated, in proportion to the edge of a cell."""


def tip_of(kind: str, random: np.random.Generator) -> dict[str, Any]:
    """Return an indenter of a kind, its shape drawn."""
    tip = {"type": kind, "half_angle": np.radians(random.uniform(60, 80))}
    if kind == "cone":
        return tip | {"tip_radius": float(random.uniform(0.05, 1.0)) * 1e-6}
    if kind == "pyramid":
        return tip | {"sides": int(random.choice([3, 4]))}
    return {"type": kind, "radius": 5e-6}


def on_grid(tip: dict[str, Any], tension: float, depth: float) -> float:
    """Return the force [N] at a depth [m]."""
    size = [2 * ROOM * half for half in half_widths(pl.registry().make(Indenter, tip), depth)]
    found = []
    for points in POINTS:
        run: dict[str, Any] = {
            "grid": {"points": points, "size": size},
            "kernel": {"type": "tensed_membrane", "reduced_modulus": MODULUS, "tension": tension},
            "indenter": tip,
            "loading": {"depth": depth},
        }
        found.append(float(pl.run(run).dataset["force"][-1]))
    coarse, fine = found
    return 2 * fine - coarse


def outcome(kind: str, random: np.random.Generator) -> tuple[bool, bool, float]:
    """Return whether a fit holds E* and τ₀, and its CPU time [s]."""
    tip = tip_of(kind, random)
    # s = 2τ₀/E* of a twentieth of the depth to twice.
    tension = float(np.exp(random.uniform(np.log(0.05), np.log(2.0)))) * DEEPEST * MODULUS / 2
    forces = [on_grid(tip, tension, depth) for depth in DEPTHS.tolist()]
    depth = np.linspace(-0.3, 1.0, ROWS) * DEEPEST
    deep = np.log(np.maximum(depth, DEPTHS[0]))
    # Shallower than the first node the force is far below the noise.
    exact = np.exp(CubicSpline(np.log(DEPTHS), np.log(forces))(deep)) * (depth > DEPTHS[0])
    force = exact + NOISE * forces[-1] * random.standard_normal(ROWS)
    began = process_time()
    fit = pl.fit(depth, force, indenter=tip)
    seconds = process_time() - began
    return held(fit.reduced_modulus, MODULUS), held(fit.tension, tension), seconds


def main() -> None:
    """Print a row for each kind of tip."""
    curves, seed = int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 1
    print_head("tip", "curves", "E* held", "τ₀ held", "CPU s")
    for kind in sys.argv[3:] or ("cone", "pyramid", "sphere"):
        random = np.random.default_rng([seed, *kind.encode()])
        outcomes = [outcome(kind, random) for _ in range(curves)]
        moduli, tensions, seconds = zip(*outcomes, strict=True)
        print_row(kind, curves, sum(moduli), sum(tensions), f"{np.median(seconds):.1f}")


if __name__ == "__main__":
    main()
