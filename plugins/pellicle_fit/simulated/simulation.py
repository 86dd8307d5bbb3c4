"""Plan, run and cache the studies behind the force curve of any indenter on any solid."""

from __future__ import annotations

import hashlib
import shutil
import warnings
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
from pellicle_axisymmetric import force_curve, punch_radius

from .equivalent import EquivalentBody
from .interpolated import RATIOS, SimulatedCurve, tensed
from .solid import UnitKernel, quantities_of

GRID_POINTS = 64
_OCTAVES = 6
"""Number of factors of 2 between the deepest and the shallowest node."""
_TOLERANCE = 1e-4
"""Of the solver, which errs by less than the cells."""
_COARSE = 2
"""Number of the node s/a whose contacts are solved on half the cells as well."""
_ROOM = 1.35
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
    cache: str | Path | None = None,
    executor: str | Executor = "serial",
    grid_points: int = GRID_POINTS,
    progress: bool = False,
) -> SimulatedCurve:
    """Return the force curve of an indenter on a solid down to a depth [m], from two studies.

    The first is without tension, and tells where contacts under tension end. The studies, of a
    reduced modulus of 1 Pa, are run here unless the folder ``cache`` has them, the user's own if
    None; ``grid_points`` are the cells of each grid along x and y.

    Raises
    ------
    ConfigError
        The indenter ends where the grid does, or its contact nowhere.
    ConvergenceError, StorageError
        A run fails, or the folder cannot be used.
    """
    depths, halves, plain = plan(indenter, solid, deepest, grid_points)
    plain["study"]["executor"] = {"type": executor} if isinstance(executor, str) else executor

    def table_of(contacts: dict[str, list[Any]]) -> xr.Dataset:
        values = {path: np.array(column).tolist() for path, column in contacts.items()}
        table = plain | {"study": plain["study"] | {"zip": [values]}}
        return solved(Study.from_mapping(table), cache, progress)

    boxes = 2 * (_MARGIN_OF_LAYERS if _is_layered(solid) else _MARGIN) * halves
    rows, coarse = tensed(depths), [grid_points // 2] * tensed(depths).size
    first = table_of(
        {
            "loading.depth": [*depths, *rows],
            "grid.size": [*boxes, *tensed(boxes)],
            "grid.points": [grid_points] * depths.size + coarse,
        }
    )
    bare, bare_coarse = np.split(first["force"].values.ravel(), [depths.size])
    curve = SimulatedCurve(EquivalentBody(depths, bare))
    shares = first["contact_radius"].values.ravel()[: depths.size] / np.sqrt(halves.prod(axis=1))
    widths = 2 * _ROOM * tensed(shares[:, None] * halves)
    lengths, count = curve.lengths, rows.size * RATIOS.size
    pairs = zip(rows.tolist(), lengths.tolist(), strict=True)
    narrower = np.array([_narrower(curve.body, depth, row) for depth, row in pairs])
    close = np.minimum(narrower[..., None] * widths[:, None], tensed(boxes)[:, None])
    tensions = np.append(lengths, lengths[:, _COARSE]) / 2
    for sizes in (close, np.broadcast_to(tensed(boxes)[:, None], close.shape)):
        contacts = {
            "loading.depth": [*np.repeat(rows, RATIOS.size), *rows],
            f"kernel.{solid.tension}": [*tensions],
            "grid.size": [*sizes.reshape(-1, 2), *sizes[:, _COARSE]],
            "grid.points": [grid_points] * count + coarse,
        }
        try:
            second = table_of(contacts)
            break
        except ConvergenceError:
            # A contact that is wider than that of the body of revolution reaches an edge.
            if sizes is not close:
                raise
    under, under_coarse = np.split(second["force"].values.ravel(), [count])
    forces = under.reshape(lengths.shape)
    changes = np.append(bare_coarse / tensed(bare), under_coarse / forces[:, _COARSE]) - 1
    accuracy = float(np.max(np.abs(changes)))
    return SimulatedCurve(curve.body, forces, accuracy, solid.is_half_space)


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
        "study": {},
    }
    return depths, np.array([half_widths(indenter, depth) for depth in depths]), study


def _is_layered(solid: UnitKernel) -> bool:
    return any(quantity.unit == "m" for _, quantity, _ in quantities_of(solid.kernel))


def _narrower(body: EquivalentBody, depth: float, lengths: list[float]) -> list[float]:
    """Return contact radii of a body at a depth [m] under tensions, over that without."""
    at = np.array([depth])
    radii = [punch_radius(force_curve(body, at, s).by_depth, s).radius[0] for s in [0.0, *lengths]]
    return [float(radius / radii[0]) for radius in radii[1:]]


def solved(study: Study, cache: str | Path | None, progress: bool) -> xr.Dataset:
    """Return the table of a study that has a place of its own in a folder, and may be there."""
    runs = "".join(point.run.identity for point in study.points)
    folder = Path(cache) if cache else platformdirs.user_cache_path("pellicle")
    folder = folder / "force-curves" / hashlib.sha256(runs.encode()).hexdigest()[:16]
    # Once all runs have converged they are deleted, so a table without them is whole.
    if (folder / "study.h5").exists() and not (folder / "runs").exists():
        table = results.table(folder / "study.h5")
    else:
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error", ConvergenceWarning)
                table = run_study(study, folder, progress=progress)
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
