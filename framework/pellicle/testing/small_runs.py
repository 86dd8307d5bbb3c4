"""Small runs that the rules solve."""

from __future__ import annotations

from typing import Any

import xarray as xr

from pellicle.config.run import Run
from pellicle.runs.runner import solve

from .component import require

HALF_SPACE = {"type": "half_space", "reduced_modulus": 1e4}
PARABOLOID = {"type": "paraboloid", "radius": "1 mm"}
ROUGH = {
    "type": "self_affine",
    "rms_height": "10 um",
    "hurst": 0.7,
    "cutoff_wavelength": "0.125 mm",
    "seed": 5,
}
_PARTS: dict[str, Any] = {
    "grid": {"points": 24, "size": "1 mm"},
    "kernel": HALF_SPACE,
    "indenter": PARABOLOID,
}


def solve_small_run(**parts: Any) -> xr.Dataset:
    """Return the dataset of a run with ``parts`` in place of ours; every step must converge."""
    run = Run(**_PARTS | parts)
    result = solve(run)
    for step, message in result.failures():
        what = f"{run.grid.boundary} boundary, {run.prescribed} prescribed"
        require(False, f"step {step} of a run ({what}) did not converge: {message}")
    return result.dataset


def ignore(*progress: Any) -> None:
    """Monitor or report nothing."""
