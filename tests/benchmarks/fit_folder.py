"""How long a folder of many curves takes, as a user fits it: files in, table out.

Run it: ``python tests/benchmarks/fit_folder.py [curves] [workers]``.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np

import pellicle as pl
from pellicle.components import HasForceCurve

POINTS, NOISE, RADIUS = 2000, 0.005, 10e-6


def write(folder: Path, curves: int) -> None:
    """Write random curves, modulus and s/R log-uniform, each with its own contact point."""
    random = np.random.default_rng(2)
    indenter = pl.indenter("paraboloid", radius=RADIUS)
    assert isinstance(indenter, HasForceCurve)
    for number in range(curves):
        modulus = np.exp(random.uniform(np.log(500), np.log(20e3)))
        ratio = np.exp(random.uniform(np.log(0.03), np.log(1.0)))
        depth = np.linspace(-0.3, 1.0, POINTS) * 0.3 * RADIUS
        force = modulus * indenter.force_curve(depth, ratio * RADIUS).force
        measured = force + NOISE * force.max() * random.standard_normal(POINTS)
        position = depth + random.uniform(-1, 1) * RADIUS
        np.savetxt(
            folder / f"{number:04d}.csv",
            np.column_stack([position * 1e6, measured * 1e9]),
            delimiter=",",
            header="position [um],force [nN]",
            comments="",
        )


def main() -> None:
    """Print the figures."""
    curves = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    workers = int(sys.argv[2]) if len(sys.argv) > 2 else 2
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "curves"
        folder.mkdir()
        write(folder, curves)
        for executor in ("serial", {"type": "processes", "workers": workers}):
            name = executor if isinstance(executor, str) else f"{workers} processes"
            began = perf_counter()
            table = pl.fit_many(
                folder,
                indenter="paraboloid",
                radius=RADIUS,
                executor=executor,
                directory=Path(temporary) / name,
                progress=False,
            )
            seconds = perf_counter() - began
            fitted = int((table["status"] == "fitted").sum())
            print(f"{name}: {fitted} of {curves} curves of {POINTS} points in {seconds:.1f} s")


if __name__ == "__main__":
    main()
