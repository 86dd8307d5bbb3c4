"""Draws ``gallery/force_map.png``: a map of 4,096 curves, fitted curve by curve (docs/gallery.md).

Run it as ``python docs/images/force_map.py``; it takes some minutes.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import pellicle as pl

SIDE, PITCH, RADIUS, DEPTH = 64, 0.5e-6, 5e-6, 1.2e-6
SOFT, STIFF, TENSION = 2e3, 6e3, 3e-3
"""E* of a gel and of an island in it [Pa], and the tension of the island [N/m]."""


def measure(folder: Path) -> Path:
    """Write the curves and the table that lists them, and return the table."""
    random, lines = np.random.default_rng(4), ["file,x [um],y [um]"]
    bead: Any = pl.indenter("sphere", radius=RADIUS)
    depth = np.linspace(-0.4, 1.0, 200) * DEPTH
    soft, stiff = (
        modulus * bead.force_curve(depth, 2 * tension / modulus).force
        for modulus, tension in ((SOFT, 0.0), (STIFF, TENSION))
    )
    for number in range(SIDE**2):
        y, x = divmod(number, SIDE)
        angle, distance = np.arctan2(y - 30, x - 34), np.hypot(y - 30, x - 34)
        is_island = distance < 17 + 4 * np.cos(3 * angle)
        force = (stiff if is_island else soft) * np.exp(0.05 * random.standard_normal())
        force = force + 0.005 * soft.max() * random.standard_normal(depth.size)
        rows = np.column_stack([(depth + 1e-7 * x) * 1e6, force * 1e9])
        name = f"{number:04}.csv"
        np.savetxt(folder / name, rows, "%.6g", ",", header="position [um],force [nN]", comments="")
        lines.append(f"{name},{1e6 * PITCH * x:g},{1e6 * PITCH * y:g}")
    path = folder / "map.csv"
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def main() -> None:
    """Measure, fit, and copy the figure of the map."""
    target = Path(__file__).parent / "gallery/force_map.png"
    with TemporaryDirectory() as folder:
        table, out = measure(Path(folder)), Path(folder, "fitted")
        pl.fit_map(
            table, indenter="sphere", radius=RADIUS, rivals=[], directory=out, progress=False
        )
        shutil.copy(out / "maps/map.png", target)


if __name__ == "__main__":
    main()
