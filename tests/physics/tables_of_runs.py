"""Tables of runs, and the steps that they have."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import xarray as xr

import pellicle as pl

Table = dict[str, Any]
ROUGH: Table = {
    "type": "self_affine",
    "rms_height": 1e-5,
    "hurst": 0.7,
    "cutoff_wavelength": 1.25e-4,
    "seed": 5,
}
"""A rough punch for domains of 1 mm and cells of 30 µm."""


def reference_rows(name: str) -> list[dict[str, float]]:
    """Return the rows of a table of reference values in tests/data."""
    text = (Path(__file__).parents[1] / "data" / name).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def half_space(modulus: float = 1.0) -> Table:
    """Return a half-space of E* [Pa]."""
    return {"type": "half_space", "reduced_modulus": modulus}


def tensed(modulus: float, tension: float) -> Table:
    """Return a half-space of E* [Pa] under a surface tension [N/m]."""
    return {"type": "tensed_membrane", "reduced_modulus": modulus, "tension": tension}


def relaxing(solid: Table, fraction: float, time: float) -> Table:
    """Return a solid of which a fraction relaxes within a time [s]."""
    relaxation = [{"fraction": fraction, "time": time}]
    return {"type": "viscoelastic", "solid": solid, "relaxation": relaxation}


def coated(substrate: Table, tension: float) -> Table:
    """Return a kernel under a surface tension [N/m]; the kernel itself without one."""
    return {"type": "coated", "tension": tension, "substrate": substrate} if tension else substrate


def paraboloid(radius: float = 1.0) -> Table:
    """Return a paraboloid of a radius [m]."""
    return {"type": "paraboloid", "radius": radius}


def heights(values: Any) -> Table:
    """Return an indenter of heights [m]."""
    return {"type": "heights", "values": values, "unit": 1.0}


def steps(
    solver: str = "active_set", tolerance: float = 1e-8, converged: bool = True, **tables: Any
) -> xr.Dataset:
    """Return the steps of a run, all of which converged unless ``converged`` is false."""
    chosen = {"type": solver, "tolerance": tolerance}
    data = pl.run(pl.Run(**{"solver": chosen, **tables}), progress=False).dataset
    assert not converged or data["converged"].all(), data["status"].values
    return data


def step(*arguments: Any, **tables: Any) -> xr.Dataset:
    """Return the first of these steps."""
    return steps(*arguments, **tables).isel(step=0)
