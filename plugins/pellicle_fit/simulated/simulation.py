"""Plan, run and cache the studies behind the force curve of any indenter on any solid."""

from __future__ import annotations

import hashlib
import shutil
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import platformdirs
import xarray as xr

from pellicle import Grid, Study, results, run_study
from pellicle.arrays import Array
from pellicle.components import Executor, Indenter
from pellicle.errors import ConfigError, ConvergenceError, ConvergenceWarning
from pellicle.units import readable

from .equivalent import EquivalentBody
from .interpolated import RATIOS, SimulatedCurve, tensed_depths
from .solid import UnitKernel, quantities_of

GRID_POINTS = 64
_OCTAVES = 6
"""Number of factors of 2 between the deepest and the shallowest node."""
_TOLERANCE = 1e-4
"""Of the solver, which errs by less than the cells."""
_COARSE = 2
"""Number of the node s/a whose contacts are solved on half the cells as well."""
_ROOM = 1.5
"""Edge of the grid over the width of the contact that is expected under a tension."""
_MARGIN = 1.08
_MARGIN_OF_LAYERS = 1.9
"""Edge of the grid over the width of the indenter: an incompressible thin layer bulges beside the
contact, which is then up to √3 times as wide."""
_CELLS = 129
"""Samples of the indenter along each axis when its width is measured."""
_CLOSE = 0.95
"""Least width of the indenter over that of the sampled domain."""
_WIDEST = 1e9


def simulated_curve(
    indenter: Indenter,
    solid: UnitKernel,
    deepest: float,
    *,
    grid_points: int = GRID_POINTS,
    **options: Any,
) -> SimulatedCurve:
    """Return the force curve of an indenter on a solid down to a depth [m], from two studies.

    The first is without tension, and tells where contacts under tension end; both are of a reduced
    modulus of 1 Pa. ``grid_points`` are the cells of each grid along x and y. The ``options`` are
    ``executor``, ``progress``, and the folder ``cache`` that keeps studies, the user's own if None.

    Raises
    ------
    ConfigError
        The indenter ends where the grid does, or its contact nowhere.
    ConvergenceError, StorageError
        A run fails, or the folder cannot be used.
    """
    depths, halves, study = plan(indenter, solid, deepest, grid_points)
    is_layered = any(quantity.unit == "m" for _, quantity, _ in quantities_of(solid.kernel))
    boxes = 2 * (_MARGIN_OF_LAYERS if is_layered else _MARGIN) * halves
    rows, fine, coarse = (
        tensed_depths(depths),
        [grid_points],
        [grid_points // 2] * tensed_depths(depths).size,
    )
    contacts = {
        "loading.depth": np.append(depths, rows),
        "grid.size": np.concatenate([boxes, tensed_depths(boxes)]),
        "grid.points": np.array(fine * depths.size + coarse),
    }
    first = solve_contacts(study, contacts, **options)
    bare, bare_coarse = np.split(first["force"].values.ravel(), [depths.size])
    curve = SimulatedCurve(EquivalentBody(depths, bare))
    lengths, _, narrower = curve.nodes
    shares = first["contact_radius"].values.ravel()[: depths.size] / np.sqrt(halves.prod(axis=1))
    # Under a tension contacts are narrower, about as those of the body; not so on thin layers.
    narrower = np.ones_like(narrower) if is_layered else narrower
    widths = 2 * _ROOM * tensed_depths(shares[:, None] * halves)[:, None] * narrower[..., None]
    sizes = np.minimum(widths, tensed_depths(boxes)[:, None])
    contacts = {
        "loading.depth": np.append(np.repeat(rows, RATIOS.size), rows),
        f"kernel.{solid.tension}": np.append(lengths, lengths[:, _COARSE]) / 2,
        "grid.size": np.concatenate([sizes.reshape(-1, 2), sizes[:, _COARSE]]),
        "grid.points": np.array(fine * lengths.size + coarse),
    }
    under, coarse_under = np.split(
        solve_contacts(study, contacts, **options)["force"].values.ravel(), [lengths.size]
    )
    forces = under.reshape(lengths.shape)
    changes = np.append(bare_coarse / tensed_depths(bare), coarse_under / forces[:, _COARSE]) - 1
    return SimulatedCurve(curve.body, forces, float(np.max(np.abs(changes))), solid.is_half_space)


def plan(
    indenter: Indenter, solid: UnitKernel, deepest: float, grid_points: int = GRID_POINTS
) -> tuple[Array, Array, dict[str, Any]]:
    """Return depths of nodes down to one [m], `half_widths` there, and a study of no contact."""
    if indenter.footprint != "unbounded":
        raise ConfigError(
            "ends where the grid does, so it has no force curve of its own; give one whose shape "
            "does not depend on the grid",
            "indenter",
        )
    # Rounded up, so that curves of about the same depth share a study.
    top = int(np.ceil(np.log2(deepest) - 1e-9))
    depths: Array = 2.0 ** np.arange(top - _OCTAVES, top + 1, dtype=np.float64)
    study: dict[str, Any] = {
        "title": f"force curve of {indenter.type_name} on {solid.kernel.type_name}",
        "grid": {"points": grid_points, "size": 1.0},
        "kernel": solid.kernel.model_dump(exclude_none=True),
        "indenter": indenter.model_dump(exclude_none=True),
        "loading": {"depth": 1.0},
        "solver": {"type": "active_set", "tolerance": _TOLERANCE},
        "outputs": [],
    }
    return depths, np.array([half_widths(indenter, depth) for depth in depths]), study


def solve_contacts(
    study: Mapping[str, Any],
    contacts: Mapping[str, Array],
    *,
    executor: str | Executor = "serial",
    cache: str | Path | None = None,
    progress: bool = False,
) -> xr.Dataset:
    """Return the table of a study of some contacts, from a place of its own if it is there."""
    columns = {path: column.tolist() for path, column in contacts.items()}
    by = {"type": executor} if isinstance(executor, str) else executor
    whole = Study.from_mapping({**study, "study": {"zip": [columns], "executor": by}})
    runs = "".join(point.run.identity for point in whole.points)
    folder = Path(cache) if cache else platformdirs.user_cache_path("pellicle")
    folder = folder / "force-curves" / hashlib.sha256(runs.encode()).hexdigest()[:16]
    # Once all runs have converged they are deleted, so a table without them is whole.
    if (folder / "study.h5").exists() and not (folder / "runs").exists():
        table = results.table(folder / "study.h5")
    else:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", ConvergenceWarning)
                table = run_study(whole, folder, progress=progress)
        except ConvergenceWarning as warning:
            raise ConvergenceError(
                f"the force curve needs the study in {folder}: {warning}; another number of "
                "grid points may help"
            ) from None
        shutil.rmtree(folder / "runs")
    if not (table["force"].values > 0).all():
        raise ConvergenceError("some contacts of the study carry no force; give more grid points")
    return table


def half_widths(indenter: Indenter, depth: float) -> tuple[float, float]:
    """Return half the width [m] along x and y of the indenter below the undeformed surface.

    On any kernel whose Green's function is positive the contact lies inside that part of the
    indenter.
    """
    half = np.array([depth, depth])
    while True:
        axes = Grid(points=_CELLS, size=tuple((2 * half).tolist())).coordinates()
        below = np.asarray(indenter.profile(*axes)) >= -depth
        reach = np.array([np.max(np.where(below, np.abs(x), 0.0)) for x in axes])
        outside = reach >= [np.max(np.abs(x)) for x in axes]
        fitted = reach + half / _CELLS
        if not outside.any() and (fitted >= _CLOSE * half).all():
            return float(fitted[0]), float(fitted[1])
        # At least one cell, so that the domain cannot shrink past the shape in one step.
        smaller = half if outside.any() else np.maximum(1.02 * fitted, 2 * half / _CELLS)
        half = np.where(outside, 2 * half, smaller)
        if half.max() > _WIDEST * depth:
            raise ConfigError(
                f"is less than {readable(depth, 'm')} high out to {readable(half.max(), 'm', 2)}; "
                "give one whose contact ends",
                "indenter",
            )
