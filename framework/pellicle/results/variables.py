"""The variables of a result: name, unit and meaning."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

DESCRIPTIONS = {
    "pressure": ("Pa", "contact pressure"),
    "displacement": ("m", "surface displacement, positive into the solid"),
    "gap": ("m", "gap between surface and indenter"),
    "contact": ("1", "whether the cell is in contact"),
    "depth": ("m", "depth of the indenter's lowest point"),
    "force": ("N", "force on the indenter"),
    "mean_pressure": ("Pa", "force over the area of the domain"),
    "contact_area": ("m2", "area of the cells in contact"),
    "contact_fraction": ("1", "contact area over the area of the domain"),
    "mean_contact_pressure": ("Pa", "force over the contact area"),
    "contact_radius": ("m", "radius of the circle that has the contact area"),
    "semi_major_axis": ("m", "major semi-axis of the ellipse with the contact's second moments"),
    "semi_minor_axis": ("m", "minor semi-axis of the ellipse with the contact's second moments"),
    "major_axis_angle": ("rad", "angle from x to the major axis"),
    "patches": ("1", "parts of the contact; cells that share an edge are of one part"),
    "perimeter": ("m", "length of the border of the contact"),
    "mean_plane_depth": ("m", "depth of the indenter's mean plane, where that is prescribed"),
    "stiffness": ("N/m", "contact stiffness dF/dδ, where loading.stiffness asks for it"),
    "iterations": ("1", "iterations of the solver"),
    "operator_applications": ("1", "applications of the operator on the finest grid"),
    "residual_contact": ("1", "largest gap in contact over the indenter's height range there"),
    "residual_penetration": ("1", "largest penetration outside the contact over the same"),
    "residual_complementarity": ("1", "pressure-weighted mean gap over the same"),
    "residual_load": ("1", "relative error of the prescribed force"),
    "residual_area": ("1", "relative error of the contact area or radius, where prescribed"),
    "converged": ("1", "whether every residual is under the tolerance"),
    "status_code": ("", "how the step ended, a name of pellicle.Status"),
    "status": ("", "how the step ended, in a sentence"),
    "wall_time": ("s", "time that the step took"),
}
"""Unit and meaning of each variable of a result."""


OF_THE_CONTACT = (
    "mean_contact_pressure",
    "contact_radius",
    "semi_major_axis",
    "semi_minor_axis",
    "major_axis_angle",
    "patches",
    "perimeter",
)
"""What is told of the contact beside its area, in a table of its own."""


def header(name: str, variable: xr.DataArray) -> str:
    """Return the head of a variable's column in a table: its name and unit."""
    unit = variable.attrs.get("units", "1")
    return name if unit == "1" else f"{name} [{unit}]"


def attributes(name: str) -> dict[str, str]:
    """Return meaning and unit of a variable, as attributes of an xarray variable."""
    corrected = ("m2", f"contact area, {name.removeprefix('contact_area_')} correction")
    unit, meaning = DESCRIPTIONS.get(name, corrected)
    return {"long_name": meaning} | ({"units": unit} if unit else {})
