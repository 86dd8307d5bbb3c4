"""The adhesive curve of a solved path without adhesion."""

from __future__ import annotations

from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

from pellicle import Run, analysis
from pellicle.arrays import Array
from pellicle.components import Kernel
from pellicle.errors import ConfigError
from pellicle.results.result import Result

if TYPE_CHECKING:
    import xarray as xr

_ROUND = 0.02
"""Relative difference of the semi-axes, or of the area from that of an ellipse, of a circle."""

_EXCESS_CELLS = 0.115
"""Excess of the radius counted in cells, per power of q in the stiffness."""


def curve_of(path: xr.Dataset, work_of_adhesion: float) -> analysis.AdhesiveCurve:
    """Return the adhesive curve of the load steps of a run, for a work of adhesion [J/m²]."""
    grid = Result(path).grid
    area = path["contact_area"].values
    if area.size:
        contact = path["contact"][int(area.argmax())].values
        shape = analysis.ellipse(contact, grid)
        major, minor = shape.semi_major_axis, shape.semi_minor_axis
        # To a cell or 2 %.
        allowed = _ROUND + max(grid.spacing) / major
        filled = np.count_nonzero(contact) * grid.cell_area / (pi * major * minor)
        if not (major <= minor * (1 + allowed) and abs(filled - 1) <= allowed):
            raise ConfigError(
                f"the contact is not a circle: its semi-axes are {major:.3g} and {minor:.3g} m, "
                f"and it fills {filled:.3g} of that ellipse; an adhesive curve needs an "
                "axisymmetric indenter"
            )
    kernel = Run.from_json(path.attrs["configuration"]).kernel
    return analysis.adhesive_curve(
        path["depth"].values,
        path["force"].values,
        np.sqrt(area / pi) - excess_radius(kernel, sqrt(grid.cell_area)),
        path["stiffness"].values,
        work_of_adhesion,
    )


def steepest_slopes(path: xr.Dataset) -> Array:
    """Return the largest slope of the indenter in the contact of each load step, shape (step,)."""
    last = path.isel(step=-1)
    profile = last["displacement"].values - last["depth"].item() - last["gap"].values
    spacing = Result(path).grid.spacing
    # Where the indenter ends the profile is −inf.
    with np.errstate(invalid="ignore"):
        slope = np.hypot(*np.gradient(profile, *spacing))
    contacts = path["contact"].values
    return np.array([np.nanmax(slope[contact], initial=0.0) for contact in contacts])


def excess_radius(kernel: Kernel, spacing: float) -> float:
    """Return how much the contact radius counted in cells exceeds that of equal stiffness [m].

    Measured for flat punches of nine radii: 0 cells on springs, 0.115 on a half-space, whose
    stiffness grows as q, 0.24 under tension, as q², 0.18 where tension sets in at the size of a
    cell; with a bending stiffness 0.14 to 0.25, with a scatter of 0.05.
    """
    shortest = pi / spacing
    compliance = kernel.compliance(shortest * np.array([sqrt(0.5), sqrt(2.0)]))
    order = float(np.log2(compliance[0] / compliance[1]))
    return _EXCESS_CELLS * min(max(order, 0.0), 2.0) * spacing
