"""Load steps as xarray datasets, the form of all results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import xarray as xr

from pellicle.analysis import ellipse, patches, perimeter
from pellicle.arrays import Array
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.solution import State
from pellicle.contact.start import PathPoint
from pellicle.grid import Grid
from pellicle.variables import VARIABLES, Variable

from . import storage


def step_dataset(
    grid: Grid,
    number: int,
    equilibrium: Equilibrium,
    scalars: Mapping[str, object],
    variables: Iterable[Variable] = (),
) -> xr.Dataset:
    """Return load step ``number``, counted from 1, with dimensions (step: 1, x: nx, y: ny).

    ``scalars`` are further values by the name of their variable; ``variables`` describes those that
    are not in `VARIABLES`.
    """
    fields = {
        "pressure": equilibrium.pressure,
        "displacement": equilibrium.displacement,
        "gap": equilibrium.gap,
        "contact": equilibrium.contact,
    }
    values = {**_numbers(grid, equilibrium), **scalars}
    if equilibrium.problem.law:
        fields["wall_pressure"] = equilibrium.wall
        values |= {
            "zone_area": np.count_nonzero(equilibrium.zone) * grid.cell_area,
            "zone_width": equilibrium.zone_width,
            "energy": equilibrium.energy,
            "residual_traction": equilibrium.residual_traction,
        }
    described = {**VARIABLES, **{variable.name: variable for variable in variables}}
    x, y = grid.coordinates()
    coordinates = {
        "step": ("step", [number], {"long_name": "load step, counted from 1"}),
        "x": ("x", x[:, 0], {"units": "m", "long_name": "x of the cell centres"}),
        "y": ("y", y[0], {"units": "m", "long_name": "y of the cell centres"}),
    }
    data = {
        name: (("step", "x", "y"), value[None], described[name].attributes)
        for name, value in fields.items()
    } | {
        name: (
            ("step",),
            np.array([value], dtype=object if isinstance(value, str) else None),
            described[name].attributes,
        )
        for name, value in values.items()
    }
    return xr.Dataset(data, coordinates)


class Steps:
    """The finished load steps of a run, with fields in arrays allocated for all steps.

    The result uses the same arrays, so that no field is in memory twice. The operating system
    allocates their pages only when steps are added.
    """

    def __init__(self, number: int) -> None:
        self._number = number
        self._fields: dict[str, xr.Variable] = {}
        self._scalars: list[xr.Dataset] = []
        self.largest_area = 0.0
        """Largest contact area of the finished steps [m²]."""

    def __len__(self) -> int:
        return len(self._scalars)

    @property
    def state(self) -> State | None:
        """The state at the end of the last step, or None before the first step."""
        return self._state(len(self) - 1) if self._scalars else None

    @property
    def path(self) -> tuple[PathPoint, ...]:
        """The last two steps, the earlier one first.

        Only the last one if the path jumped there, and none that did not converge or lies before
        such a step.
        """
        points: list[PathPoint] = []
        for index in range(max(0, len(self) - 2), len(self)):
            scalars = self._scalars[index]
            if not scalars["converged"].item():
                points.clear()
                continue
            if "jumped" in scalars and scalars["jumped"].item():
                points.clear()
            energy = scalars["energy"].item() if "energy" in scalars else np.nan
            gap = self._fields["gap"].values[index]
            points.append(PathPoint(self._state(index), gap, energy))
        return tuple(points)

    def field(self, name: str) -> Array:
        """Return a field at the end of each step, in order; (step, nx, ny), a view."""
        if not self._scalars:
            return np.empty((0, 0, 0))
        values: Array = self._fields[name].values[: len(self)]
        return values

    def _state(self, index: int) -> State:
        pressure = self._fields["pressure"].values[index]
        wall = pressure
        if "wall_pressure" in self._fields:
            wall = self._fields["wall_pressure"].values[index]
        return State(pressure, wall, self._scalars[index]["depth"].item())

    def append(self, step: xr.Dataset) -> xr.Dataset:
        """Copy a step of `step_dataset` into the arrays, and return it as views of them."""
        index = slice(len(self), len(self) + 1)
        fields = {}
        for name, variable in step.variables.items():
            if variable.ndim > 1:
                if name not in self._fields:
                    shape = (self._number, *variable.shape[1:])
                    array = np.empty(shape, variable.dtype)
                    self._fields[str(name)] = xr.Variable(variable.dims, array, variable.attrs)
                fields[str(name)] = self._fields[str(name)].isel(step=index)
                fields[str(name)].values[:] = variable.values
        self._scalars.append(step.drop_vars(fields))
        self.largest_area = max(self.largest_area, step["contact_area"].item())
        return step.assign(fields)

    def joined(self) -> xr.Dataset:
        """Return all steps as one dataset; no step can be appended afterwards."""
        done = slice(len(self))
        fields = {name: field.isel(step=done) for name, field in self._fields.items()}
        scalars = storage.joined(self._scalars)
        return xr.Dataset({**fields, **scalars.data_vars}, scalars.coords, scalars.attrs)


def _numbers(grid: Grid, equilibrium: Equilibrium) -> dict[str, object]:
    """Return the variables of every load step: force, shape of the contact and residuals."""
    contact = equilibrium.contact
    area = np.count_nonzero(contact) * grid.cell_area
    shape = ellipse(contact, grid)
    return {
        "depth": equilibrium.depth,
        "force": equilibrium.force,
        "mean_pressure": equilibrium.force / grid.area,
        "contact_area": area,
        "contact_fraction": area / grid.area,
        "mean_contact_pressure": equilibrium.force / area if area else np.nan,
        "contact_radius": np.sqrt(area / np.pi),
        "semi_major_axis": shape.semi_major_axis,
        "semi_minor_axis": shape.semi_minor_axis,
        "major_axis_angle": shape.angle,
        "patches": patches(contact, grid).count,
        "perimeter": perimeter(contact, grid),
        "residual_contact": equilibrium.residual_contact,
        "residual_penetration": equilibrium.residual_penetration,
        "residual_complementarity": equilibrium.residual_complementarity,
        "residual_load": equilibrium.residual_load,
    }
