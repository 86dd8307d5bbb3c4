"""Writes patch.gwy and patch.x3p: one surface in the formats of Gwyddion and of ISO 25178-72.

``python tests/data/patch.py`` puts them next to itself. Those that are here were made so, with
SurfaceTopography 1.27.1; nobody measured them.
"""

import warnings
from datetime import datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

SHAPE, SIZE = (39, 33), (1.3e-3, 1.1e-3)
"""Points, and edge lengths [m]."""
MISSING = np.zeros(SHAPE, dtype=np.bool_)
"""What patch.x3p lacks."""
MISSING[10:13, 20:22] = MISSING[30, 5] = True


def surface() -> NDArray[np.float64]:
    """Return the heights [m] along x then y: a tilt and 40 waves of random direction."""
    rng = np.random.default_rng(11)
    # In millimetres.
    x, y = ((np.arange(n) + 0.5) / 30 for n in SHAPE)
    heights = np.add.outer(0.02 * x, -0.01 * y)
    for _ in range(40):
        q = 2 * np.pi / np.exp(rng.uniform(np.log(0.3), np.log(1.3)))
        direction, phase = rng.uniform(0, np.pi), rng.uniform(0, 2 * np.pi)
        along = np.add.outer(np.cos(direction) * x, np.sin(direction) * y)
        heights += 0.012 * q**-1.3 * np.cos(q * along + phase)
    # Both formats hold what single precision does.
    return heights.astype(np.float32).astype(np.float64) / 1e3


def write(folder: Path) -> None:
    """Write both files."""
    with warnings.catch_warnings():
        # It says that there is no MPI.
        warnings.simplefilter("ignore", ImportWarning)
        from SurfaceTopography import Topography

    whole = Topography(surface(), SIZE, unit="m")
    whole.to_gwy(str(folder / "patch.gwy"), name="Height")
    dated = {"acquisition_time": datetime(2026, 11, 21)}
    holes = np.ma.masked_array(surface(), MISSING)
    Topography(holes, SIZE, unit="m", info=dated).to_x3p(str(folder / "patch.x3p"), dtype="F")


if __name__ == "__main__":
    write(Path(__file__).parent)
