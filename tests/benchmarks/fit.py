"""What a fit costs: master curves, one curve, a hundred curves, and a simulated force curve.

Run it: ``python tests/benchmarks/fit.py [--simulate]``; times are those of the processor.  With
``--simulate`` the study of a quadric is run from nothing, which takes a minute or so.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np

import pellicle as pl
from pellicle.components import HasForceCurve
from pellicle_fit.models.simulation import simulate
from pellicle_fit.models.solid import solid

CURVES = 100
_RADIUS, _MODULUS, _LENGTH = 5e-6, 2e3, 3e-6


def _seconds(work: Callable[[], object]) -> float:
    began = process_time()
    work()
    return process_time() - began


def _fit_one(indenter: HasForceCurve, points: int, seed: int) -> pl.Fit:
    depth = np.linspace(-0.5e-6, 1.5e-6, points)
    force = _MODULUS * indenter.force_curve(depth, _LENGTH).force
    noise = 0.005 * force.max() * np.random.default_rng(seed).standard_normal(points)
    return pl.fit(depth + 1e-6, force + noise, indenter=indenter)


def main() -> None:
    """Print the times."""
    depth = np.array([1e-6])
    for type_ in ("paraboloid", "sphere"):
        indenter = pl.indenter(type_, radius=_RADIUS)
        assert isinstance(indenter, HasForceCurve)
        first = _seconds(lambda body=indenter: body.force_curve(depth, _LENGTH))  # type: ignore[misc]
        print(f"{type_}: master curve loaded in {1e3 * first:.1f} ms")
        for points in (60, 2000):
            times = [
                _seconds(lambda body=indenter, n=points, k=seed: _fit_one(body, n, k))  # type: ignore[misc]
                for seed in range(CURVES)
            ]
            print(
                f"  {points} points: {np.median(times):.2f} s a fit, {max(times):.2f} s the "
                f"longest, {sum(times):.1f} s for {CURVES} curves"
            )
    if "--simulate" in sys.argv:
        quadric = pl.indenter("quadric", radius_x=_RADIUS, radius_y=2 * _RADIUS)
        with tempfile.TemporaryDirectory() as folder:
            for what in ("from nothing", "from its table"):
                took = _seconds(
                    lambda: simulate(quadric, solid("tensed_membrane"), 3e-6, cache=Path(folder))
                )
                print(f"quadric, force curve {what}: {took:.1f} s")


if __name__ == "__main__":
    main()
