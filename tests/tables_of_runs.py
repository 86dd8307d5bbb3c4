"""Tables of runs, made in one place, and the steps that they have."""

import csv
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import pellicle as pl
from pellicle.runs import solve as solving

Table = dict[str, Any]


def reference_rows(name: str) -> list[dict[str, float]]:
    """Return the rows of a table of reference values in tests/data."""
    text = (Path(__file__).parent / "data" / name).read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def half_space(modulus: Any = 1.0) -> Table:
    """Return a half-space of E* [Pa]."""
    return {"type": "half_space", "reduced_modulus": modulus}


def tensed(modulus: Any, tension: Any) -> Table:
    """Return a half-space of E* [Pa] under a surface tension [N/m]."""
    return {"type": "tensed_membrane", "reduced_modulus": modulus, "tension": tension}


def layer(base: str, thickness: Any, poissons_ratio: float, **modulus: Any) -> Table:
    """Return a layer [m] on a rigid base, bonded to it or not, of which one modulus is given."""
    return {"type": base, "thickness": thickness, "poissons_ratio": poissons_ratio, **modulus}


def relaxing(solid: Table, fraction: float, time: Any) -> Table:
    """Return a solid of which a fraction relaxes within a time [s]."""
    relaxation = [{"fraction": fraction, "time": time}]
    return {"type": "viscoelastic", "solid": solid, "relaxation": relaxation}


def coated(substrate: Table, tension: Any) -> Table:
    """Return a kernel under a surface tension [N/m]; the kernel itself without one."""
    return {"type": "coated", "tension": tension, "substrate": substrate} if tension else substrate


def paraboloid(radius: Any = 1.0) -> Table:
    """Return a paraboloid of a radius [m]."""
    return {"type": "paraboloid", "radius": radius}


def self_affine(rms_height: Any, hurst: float, cutoff_wavelength: Any, **others: Any) -> Table:
    """Return a self-affine surface; its height and shortest wave are in metres without a unit."""
    cutoff = {"cutoff_wavelength": cutoff_wavelength}
    return {"type": "self_affine", "rms_height": rms_height, "hurst": hurst, **cutoff, **others}


ROUGH = self_affine(1e-5, 0.7, 1.25e-4, seed=5)
"""A rough punch for domains of 1 mm and cells of 30 µm."""


def heights(values: Any) -> Table:
    """Return an indenter of heights [m]."""
    return {"type": "heights", "values": values, "unit": 1.0}


def pressing(
    points: Any, size: Any, kernel: Any, indenter: Any, *, boundary: str = "free", **loading: Any
) -> Table:
    """Return the tables of a run, whose loading is given by its fields."""
    grid = {"points": points, "size": size, "boundary": boundary}
    return {"grid": grid, "kernel": kernel, "indenter": indenter, "loading": loading}


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


def interrupt(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Let Ctrl-C come in the second step that is solved; return what each is called with."""
    solve, calls = solving.solve_step, list[Any]()

    def once(*arguments: Any) -> Any:
        calls.append(arguments)
        if len(calls) == 2:
            raise KeyboardInterrupt
        return solve(*arguments)

    monkeypatch.setattr(solving, "solve_step", once)
    return calls


RUN: dict[str, Any] = pressing(
    20, "0.4 mm", tensed("10 kPa", "1 N/m"), paraboloid("1 mm"), depth=["5 um", "10 um", "15 um"]
) | {"outputs": []}
"""A run of three steps that takes a few milliseconds."""


def run_file(study: str = "", **changes: Any) -> str:
    """Return the run, with changes, as the text of a TOML file, with the tables of a study."""
    return f"{pl.Run(**RUN | changes).to_toml()}\n{study}"
