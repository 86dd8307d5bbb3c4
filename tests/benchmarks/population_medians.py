"""Medians of populations of known solids, as `fits-groups.csv` has them, over those of the sample.

    python tests/benchmarks/population_medians.py [curves [seed]]

No tension, 3 mN/m in all, 3 mN/m in one of two groups; E* is log-normal about 2 kPa.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pandas as pd
from tables import print_head, print_row

import pellicle as pl

RADIUS, DEPTH, ROWS, NOISE = 5e-6, 1.5e-6, 300, 0.005
MEDIAN, SPREAD = 2e3, 0.3
TENSION = 3e-3
POPULATIONS = {"no tension": (0.0,), "3 mN/m": (TENSION,), "half and half": (0.0, TENSION)}


def measure(folder: Path, tensions: tuple[float, ...], curves: int, seed: int) -> pd.DataFrame:
    """Write the curves of a population, and return the group, E* [Pa] and tension [N/m] of each."""
    random = np.random.default_rng([seed, len(tensions), tensions[0] > 0])
    bead: Any = pl.indenter("sphere", radius=RADIUS)
    truth = []
    for number in range(curves):
        tension = tensions[number % len(tensions)]
        modulus, start = MEDIAN * np.exp(SPREAD * random.standard_normal()), random.uniform(0, 3e-6)
        depth = np.linspace(-0.3, 1.0, ROWS) * DEPTH
        force = modulus * bead.force_curve(depth, 2 * tension / modulus).force
        force += NOISE * force.max() * random.standard_normal(ROWS)
        group = "tensed" if tension else "bare"
        table = np.column_stack([(depth + start) * 1e6, force * 1e9])
        head = "position [um],force [nN]"
        path = folder / f"{group}_{number:03}.csv"
        np.savetxt(path, table, "%.9g", ",", header=head, comments="")
        truth.append((group, modulus, tension))
    return pd.DataFrame(truth, columns=["group", "reduced_modulus", "tension"])


def main() -> None:
    """Print a row for each group of each population."""
    curves = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    print_head("population", "group", "n", "open", "median E* / true", "median τ₀ [mN/m]", "true")
    for name, tensions in POPULATIONS.items():
        with TemporaryDirectory() as folder:
            truth = measure(Path(folder), tensions, curves, seed)
            out = Path(folder) / "out"
            bead = pl.FitConfig.merged(indenter="sphere", radius=RADIUS, group_by="{group}_*.csv")
            pl.fit_many(f"{folder}/*.csv", config=bead, directory=out, progress=False)
            found = pd.read_csv(out / "fits-groups.csv").set_index(["group", "parameter"])
        for group in dict.fromkeys(found.index.get_level_values("group")):
            true = truth if group == "all" else truth[truth["group"] == group]
            modulus, medians = found.loc[group, "reduced_modulus"], true.median(numeric_only=True)
            ratio = modulus["median"] / medians["reduced_modulus"]
            tension = 1e3 * found["median"].get((group, "tension"), np.nan)
            cells = f"{ratio:.3f}", f"{tension:.3g}", f"{1e3 * medians['tension']:.3g}"
            print_row(name, group, modulus["n"], modulus["open"], *cells)


if __name__ == "__main__":
    main()
