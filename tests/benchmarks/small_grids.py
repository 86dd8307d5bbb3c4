"""CPU time of runs of four steps on small grids, for a comparison of two states of the code.

    PYTHONPATH=framework:plugins python tests/benchmarks/small_grids.py

Run it in turns in both working trees, on an idle core.
"""

from __future__ import annotations

import warnings
from itertools import product
from time import process_time
from typing import Any

import pellicle as pl

REPEATS = 7
SOLID = {"type": "half_space", "reduced_modulus": 1e4}


def run_of(points: int, boundary: str, tension: float) -> dict[str, Any]:
    """Return a paraboloid pressed in four steps; s is as long as the contact is wide, or 0."""
    tensed = {"type": "coated", "tension": tension, "substrate": SOLID}
    return {
        "grid": {"points": points, "size": 1e-3, "boundary": boundary},
        "kernel": tensed if tension else SOLID,
        "indenter": {"type": "paraboloid", "radius": 1e-3},
        "loading": {"depth": [5e-6, 1e-5, 2e-5, 3e-5]},
        "solver": {"type": "active_set", "tolerance": 1e-6},
    }


def seconds(run: dict[str, Any]) -> float:
    """Return the CPU time of a run [s]."""
    began = process_time()
    pl.run(run, progress=False)
    return process_time() - began


def main() -> None:
    """Print the least CPU time of each run, in ms."""
    warnings.simplefilter("ignore")
    print("points,boundary,tension,cpu_ms")
    for points, boundary, tension in product((64, 128), ("free", "periodic"), (0.0, 0.5)):
        run = run_of(points, boundary, tension)
        least = min(seconds(run) for _ in range(REPEATS))
        print(f"{points},{boundary},{tension},{1e3 * least:.1f}", flush=True)


if __name__ == "__main__":
    main()
