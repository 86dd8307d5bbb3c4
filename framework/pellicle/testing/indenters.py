"""Contract rules of indenters: a profile on the grid's points, 0 at its lowest point."""

from __future__ import annotations

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import read_only, real_array
from pellicle.components import ForceCurve, HasForceCurve, Indenter
from pellicle.components.calls import profile_of
from pellicle.errors import excerpt
from pellicle.grid import Grid

from .component import check, require, require_close, rules_of
from .small_runs import solve_small_run


def check_indenter(indenter: Indenter, grid: Grid | None = None) -> None:
    """Check that an indenter keeps its contract: the rules below, and those of all components.

    The points of ``grid`` suit the indenter, its lowest point among them; they are 13 × 11 on
    1.3 mm × 1.1 mm if None.
    """
    check(
        indenter,
        Indenter,
        rules_of(__name__),
        grid or Grid(points=[13, 11], size=["1.3 mm", "1.1 mm"]),
    )


def profile_is_accepted(indenter: Indenter, grid: Grid) -> None:
    """A run accepts profile(x, y), float64 ≤ 0, the same in a second call; and the footprint."""
    first, second = (profile_of(indenter, grid) for _ in range(2))
    require(np.array_equal(first, second), "the second profile differs")


def lowest_point_is_at_zero(indenter: Indenter, grid: Grid) -> None:
    """The highest value is 0; if the indenter ends with the domain, 0 may lie between the cells."""
    profile = indenter.profile(*grid.coordinates())
    allowed = (1e-12 if indenter.footprint == "unbounded" else 0.1) * _range(profile)
    require(-profile.max() <= allowed, f"the highest value is {profile.max():g} m")


def heights_depend_on_their_own_point(indenter: Indenter, grid: Grid) -> None:
    """An unbounded indenter has the same heights if only some of the points are evaluated."""
    if indenter.footprint != "unbounded":
        return
    x, y = grid.coordinates()
    whole = indenter.profile(x, y)
    part = indenter.profile(x[1:4], y[:, 2:4])
    require(
        np.allclose(part, whole[1:4, 2:4], rtol=1e-12, atol=0),
        f"heights at some points are {part.tolist()} m, but as a part of the whole grid "
        f"{whole[1:4, 2:4].tolist()} m; a shape that ends with the domain has footprint 'domain'",
    )


def force_curve_rises(indenter: Indenter, grid: Grid) -> None:
    """A force curve is 0 without contact, rises with depth, and agrees with its derivatives."""
    if not isinstance(indenter, HasForceCurve) or not indenter.depth_limit:
        return
    scale = 0.01 * (_range(indenter.profile(*grid.coordinates())) or min(grid.size))
    unit = min(scale, 0.1 * indenter.depth_limit)
    depth, length, step = unit * np.array([-1.0, 0.0, 0.5, 1.0, 2.0]), unit, 1e-4 * unit
    curve = _force_curve(indenter, depth, length)
    require(not curve.force[:2].any(), f"forces {curve.force[:2]} m² at depths ≤ 0")
    require((np.diff(curve.force[1:]) > 0).all(), f"forces {curve.force} m² at rising depths")
    for name, low, high in (
        ("by_depth", (depth - step, length), (depth + step, length)),
        ("by_length", (depth, length - step), (depth, length + step)),
    ):
        below, above = (_force_curve(indenter, *at).force[2:] for at in (low, high))
        derivative = getattr(curve, name)[2:]
        require_close(
            derivative, (above - below) / (2 * step), f"force_curve().{name}", relative=1e-3
        )


def _force_curve(indenter: HasForceCurve, depth: Array, length: float) -> ForceCurve:
    curve = indenter.force_curve(read_only(depth), length)
    require(isinstance(curve, ForceCurve), f"{excerpt(curve)}, not a pellicle.ForceCurve")
    for part, values in curve._asdict().items():
        real_array(indenter, f"force_curve().{part}", values, depth.shape)
    return curve


def run_converges(indenter: Indenter, grid: Grid) -> None:
    """Pressed into a half-space, the indenter makes contact and the run converges."""
    depth = 0.01 * _range(indenter.profile(*grid.coordinates())) or 0.01 * min(grid.size)
    dataset = solve_small_run(grid=grid, indenter=indenter, loading={"depth": depth})
    require(dataset["force"].item() > 0, f"no contact at a depth of {depth:g} m")


def _range(heights: Array) -> float:
    return float(np.ptp(heights[np.isfinite(heights)]))
