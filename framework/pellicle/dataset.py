"""Measured load steps as xarray datasets: the form in which results are kept everywhere."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from . import storage
from .analysis import ellipse, patches, perimeter
from .grid import Grid
from .operators import Array
from .problem import Equilibrium

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


def step_dataset(
    grid: Grid, number: int, found: Equilibrium, scalars: Mapping[str, object]
) -> xr.Dataset:
    """Return load step ``number``, counted from 1, with dimensions (step: 1, x: nx, y: ny).

    ``scalars`` adds what is not in the equilibrium; an unknown name is taken to be an area [m²].
    """
    import xarray as xr

    contact = found.contact
    area = np.count_nonzero(contact) * grid.cell_area
    shape = ellipse(contact, grid)
    fields = {
        "pressure": found.pressure,
        "displacement": found.displacement,
        "gap": found.gap,
        "contact": contact,
    }
    values: dict[str, object] = {
        "depth": found.depth,
        "force": found.force,
        "mean_pressure": found.force / grid.area,
        "contact_area": area,
        "contact_fraction": area / grid.area,
        "mean_contact_pressure": found.force / area if area else np.nan,
        "contact_radius": np.sqrt(area / np.pi),
        "semi_major_axis": shape.semi_major_axis,
        "semi_minor_axis": shape.semi_minor_axis,
        "major_axis_angle": shape.angle,
        "patches": patches(contact, grid).count,
        "perimeter": perimeter(contact, grid),
        "residual_contact": found.residual_contact,
        "residual_penetration": found.residual_penetration,
        "residual_complementarity": found.residual_complementarity,
        "residual_load": found.residual_load,
        **scalars,
    }
    x, y = grid.coordinates()
    coordinates = {
        "step": ("step", [number], {"long_name": "load step, counted from 1"}),
        "x": ("x", x[:, 0], {"units": "m", "long_name": "x of the cell centres"}),
        "y": ("y", y[0], {"units": "m", "long_name": "y of the cell centres"}),
    }
    variables = {
        name: (("step", "x", "y"), value[None], _attributes(name)) for name, value in fields.items()
    } | {
        name: (
            ("step",),
            np.array([value], dtype=object if isinstance(value, str) else None),
            _attributes(name),
        )
        for name, value in values.items()
    }
    return xr.Dataset(variables, coordinates)


class Steps:
    """The finished load steps of a run, whose fields lie in arrays with room for all steps.

    The arrays become the result as they are, so that no field is in memory twice. The system
    provides their pages as steps are added.
    """

    def __init__(self, number: int) -> None:
        self._number = number
        self._fields: dict[str, xr.Variable] = {}
        self._scalars: list[xr.Dataset] = []

    def __len__(self) -> int:
        return len(self._scalars)

    @property
    def pressure(self) -> Array | None:
        """The pressure of the last step [Pa], or None before the first step."""
        return self._fields["pressure"].values[len(self) - 1] if self._scalars else None

    def append(self, step: xr.Dataset) -> xr.Dataset:
        """Copy a step of `step_dataset` into the arrays, and return it as a view of them."""
        import xarray as xr

        here = slice(len(self), len(self) + 1)
        fields = {}
        for name, variable in step.variables.items():
            if variable.ndim > 1:
                if name not in self._fields:
                    shape = (self._number, *variable.shape[1:])
                    room = np.empty(shape, variable.dtype)
                    self._fields[str(name)] = xr.Variable(variable.dims, room, variable.attrs)
                fields[str(name)] = self._fields[str(name)].isel(step=here)
                fields[str(name)].values[:] = variable.values
        self._scalars.append(step.drop_vars(fields))
        return step.assign(fields)

    def extend(self, steps: Iterable[xr.Dataset]) -> None:
        """Append several steps."""
        for step in steps:
            self.append(step)

    def joined(self) -> xr.Dataset:
        """Return all steps as one dataset; no step can be appended any more."""
        import xarray as xr

        done = slice(len(self))
        fields = {name: field.isel(step=done) for name, field in self._fields.items()}
        scalars = storage.joined(self._scalars)
        return xr.Dataset({**fields, **scalars.data_vars}, scalars.coords, scalars.attrs)


def header(name: str, variable: xr.DataArray) -> str:
    """Return the head of a variable's column in a table: its name and unit."""
    unit = variable.attrs.get("units", "1")
    return name if unit == "1" else f"{name} [{unit}]"


def _attributes(name: str) -> dict[str, str]:
    corrected = ("m2", f"contact area, {name.removeprefix('contact_area_')} correction")
    unit, meaning = DESCRIPTIONS.get(name, corrected)
    return {"long_name": meaning} | ({"units": unit} if unit else {})
