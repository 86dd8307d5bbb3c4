"""A bead that yields too: its constants, and its force curves with a sample."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from pellicle import registry
from pellicle.components import Kernel
from pellicle.errors import ConfigError, problems_within
from pellicle_axisymmetric import BodyOfRevolution
from pellicle_fit.contact.soft_bead import SoftBead

from .interpolated import tensed_depths
from .simulation import GRID_POINTS, plan, solve_contacts
from .solid import UnitKernel

_SKIN = "tensed_membrane"
_EDGE = 1.2
"""Edge of the grid over the width of the contact with a rigid bead."""


def constants_of(bead: Mapping[str, Any], poissons_ratio: float | None) -> tuple[float, float]:
    """Return the reduced modulus [Pa] and the tension [N/m] of a bead.

    ``poissons_ratio`` is used if the bead has none of its own.
    """
    table = {"tension": 0.0, **bead}
    with problems_within("bead"):
        if "type" in table:
            raise ConfigError("is not a field of a bead; give its modulus and tension", "type")
        if "youngs_modulus" in table and poissons_ratio is not None:
            table.setdefault("poissons_ratio", poissons_ratio)
        kernel: Any = registry().make(Kernel, {"type": _SKIN, **table})
        if not kernel.is_isotropic:
            raise ConfigError("is to be one number: force curves are of round beads", "tension")
    return kernel.contact_modulus, kernel.one_tension


def soft_bead(
    rigid: object,
    modulus: float,
    tension: float,
    deepest: float,
    *,
    skins: bool,
    grid_points: int = GRID_POINTS,
    **options: Any,
) -> SoftBead:
    """Return a bead of a reduced modulus [Pa] and a tension [N/m] down to a depth [m].

    If it or the sample may have ``skins``, pairs of both are simulated; ``options`` are those of
    `solve_contacts`.
    """
    if not isinstance(rigid, BodyOfRevolution):
        raise ConfigError("is no body of revolution; a bead that yields has to be", "indenter")
    bead = SoftBead(rigid, modulus, 2 * tension / modulus)
    if not skins:
        return bead
    body = {"type": _SKIN, "reduced_modulus": 1.0, "tension": 0.0}
    kernel = registry().make(Kernel, {"type": "pair", "first": body, "second": body})
    pair = UnitKernel(kernel, "first.tension", None)
    # Depths are rounded up, by less than twice; a sphere ends at its equator.
    deepest = min(deepest, 0.4 * rigid.depth_limit)
    depths, _, study = plan(rigid, pair, deepest, grid_points)
    rows = tensed_depths(depths)
    lengths, _, softer = bead.nodes(rows)
    parts = (rows[:, None, None], lengths, 1 / softer)
    depth, length, own = (part.ravel() for part in np.broadcast_arrays(*parts))
    # Beside a sample of 1 Pa; the last contacts are those in the middle on half the cells.
    middle = np.arange(depth.size).reshape(softer.shape)[:, 2, 1]
    chosen = np.append(np.arange(depth.size), middle)
    points = [grid_points] * depth.size + [grid_points // 2] * rows.size
    radii = np.repeat(rigid.contact_radius(rows, 0.0).radius, depth.size // rows.size)
    contacts = {
        "loading.depth": depth[chosen],
        "kernel.first.tension": length[chosen] / 2,
        "kernel.second.reduced_modulus": own[chosen],
        "kernel.second.tension": own[chosen] * bead.length / 2,
        "grid.size": 2 * _EDGE * np.outer(radii[chosen], [1.0, 1.0]),
        "grid.points": np.array(points),
    }
    forces = solve_contacts(study, contacts, **options)["force"].values.ravel()
    accuracy = float(np.max(np.abs(forces[depth.size :] / forces[middle] - 1)))
    return replace(
        bead, depths=rows, forces=forces[: depth.size].reshape(softer.shape), accuracy=accuracy
    )
