"""The adhesive curve of a solved path without adhesion."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

import pellicle as pl
from pellicle import analysis
from pellicle.arrays import Dataset
from pellicle.components import Kernel
from pellicle.errors import ConfigError
from pellicle.results import Result
from pellicle.surface import along_axes
from pellicle_axisymmetric import AdhesiveCurve, adhesive_curve

_ROUND = 0.02
"""Relative difference of a circle's semi-axes, or of its area from the ellipse's, beyond a cell."""

_CELLS_OF_FLAT = 2.0
"""Radius in cells from which cells of one height are a flat end, which a few at the tip are not."""
_LEVEL = 1e-12
"""Difference of two heights that are one, over the depth."""

_EXCESS_CELLS = 0.115
"""Excess of the radius counted in cells, per power of q in the stiffness of a wave, 1/G."""


def curve_of(path: Dataset, work_of_adhesion: float) -> AdhesiveCurve:
    """Return the adhesive curve of the load steps of a run, for a work of adhesion [J/m²]."""
    grid = Result(path).grid
    area = path["contact_area"].values
    if area.any():
        contact = path["contact"][int(area.argmax())].values
        shape = analysis.ellipse(contact, grid)
        major, minor = shape.semi_major_axis, shape.semi_minor_axis
        allowed = _ROUND + max(grid.spacing) / major
        filled = np.count_nonzero(contact) * grid.cell_area / (pi * major * minor)
        if not (major <= minor * (1 + allowed) and abs(filled - 1) <= allowed):
            raise ConfigError(
                f"the contact is not a circle: its semi-axes are {major:.3g} and {minor:.3g} m, "
                f"and it fills {filled:.3g} of that ellipse; an adhesive curve needs an "
                "axisymmetric indenter"
            )
    # Of heights in memory the configuration has the hash alone, and makes no run.
    table = dict(Result(path).configuration["kernel"])
    kernel = pl.kernel(table.pop("type"), **table)
    curve = adhesive_curve(
        path["depth"].values,
        path["force"].values,
        np.sqrt(area / pi) - excess_radius(kernel, sqrt(grid.cell_area)),
        path["stiffness"].values,
        work_of_adhesion,
    )
    pinned = curve.contact_radius[0] == curve.contact_radius[1]
    if pinned and curve.contact_radius[0] < _CELLS_OF_FLAT * min(grid.spacing):
        return AdhesiveCurve(*(values[2:] for values in curve))
    last = path.isel(step=-1)
    heights = (last["displacement"] - last["gap"]).values
    flat = sqrt(np.count_nonzero(heights > (1 - _LEVEL) * heights.max()) * grid.cell_area / pi)
    if not pinned and flat > _CELLS_OF_FLAT * min(grid.spacing):
        raise ConfigError(
            f"the edge of a flat end of radius {flat:.3g} m holds the contact, and no step of the "
            "path touches the flat alone; begin at a smaller depth"
        )
    return curve


def excess_radius(kernel: Kernel, spacing: float) -> float:
    """Return how much the contact radius counted in cells exceeds that of equal stiffness [m].

    It is 0.115 n h, where h is the spacing and n = −d ln G / d ln q over the octave around the
    shortest wave of the grid, q = π/h, kept between 0 and 2. The formula is empirical. Flat punches
    of nine radii, 13 to 19 cells, are as stiff as exact ones that are smaller by 0.115 ± 0.007
    cells on a half-space, n = 1; by 0.19 ± 0.01 if tension sets in at the size of a cell, n = 1.5
    (formula 0.17); by 0.24 ± 0.01 under strong tension, n = 2 (formula 0.23). With a bending
    stiffness B (formula 0.23) it is 0.32 ± 0.01 if (2B/E*)^⅓ is half a cell, and 0.12 ± 0.06 if it
    is more than the radius.
    """
    shortest = pi / spacing
    compliance = along_axes(kernel.symbol, shortest * np.array([sqrt(0.5), sqrt(2.0)]))
    order = float(np.log2(compliance[0] / compliance[1]))
    return _EXCESS_CELLS * min(max(order, 0.0), 2.0) * spacing
