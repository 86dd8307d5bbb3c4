"""The adhesive curve of a solved path without adhesion."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

import numpy as np

from pellicle import analysis
from pellicle.arrays import Mask
from pellicle.errors import ConfigError
from pellicle.grid import Grid
from pellicle.results.result import Result
from pellicle_plugins.corrections.yastrebov import Yastrebov

if TYPE_CHECKING:
    import xarray as xr

_ROUND = 0.02
"""Relative difference of the semi-axes, or of the area from that of an ellipse, of a circle."""


def curve_of(path: xr.Dataset, work_of_adhesion: float) -> analysis.AdhesiveCurve:
    """Return the adhesive curve of the load steps of a run, for a work of adhesion [J/m²].

    Raises
    ------
    ConfigError
        The contact is not a circle, or `pellicle.analysis.adhesive_curve` refuses the path.
    """
    grid = Result(path).grid
    contacts = [path["contact"][step].values for step in range(path.sizes["step"])]
    if contacts:
        _require_circle(max(contacts, key=np.count_nonzero), grid)
    areas = np.array([Yastrebov().area(contact, grid.spacing) for contact in contacts])
    return analysis.adhesive_curve(
        path["depth"].values,
        path["force"].values,
        np.sqrt(areas / pi),
        path["stiffness"].values,
        work_of_adhesion,
    )


def _require_circle(contact: Mask, grid: Grid) -> None:
    """Refuse a contact that is not a full circle, to a cell or 2 %.

    Raises
    ------
    ConfigError
        The semi-axes differ, or the contact does not fill its ellipse.
    """
    shape = analysis.ellipse(contact, grid)
    major, minor = shape.semi_major_axis, shape.semi_minor_axis
    allowed = _ROUND + max(grid.spacing) / major
    filled = np.count_nonzero(contact) * grid.cell_area / (pi * major * minor)
    if not (major <= minor * (1 + allowed) and abs(filled - 1) <= allowed):
        raise ConfigError(
            f"the contact is not a circle: its semi-axes are {major:.3g} and {minor:.3g} m, and it "
            f"fills {filled:.3g} of that ellipse; an adhesive curve needs an axisymmetric indenter"
        )
