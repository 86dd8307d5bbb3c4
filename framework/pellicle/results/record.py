"""Load steps as xarray datasets, the form of all results."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from functools import lru_cache

import numpy as np
import xarray as xr

from pellicle.analysis import ellipse, patches, perimeter
from pellicle.arrays import Array, Mask
from pellicle.contact.caveats import sentence_of, status_of, to_text
from pellicle.contact.equilibrium import AdhesiveEquilibrium, Deformation, Equilibrium
from pellicle.contact.load_step import FinishedStep, LoadStep
from pellicle.grid import Grid
from pellicle.variables import CAVEATS, VARIABLES, Variable, names_of


def step_dataset(
    grid: Grid,
    number: int,
    step: LoadStep[Deformation],
    variables: Iterable[Variable] = (),
    seconds: float = 0.0,
) -> xr.Dataset:
    """Return load step ``number``, counted from 1, with dimensions (step: 1, x: nx, y: ny).

    ``variables`` describes the measures of the step that are not in `VARIABLES`; it took
    ``seconds`` to solve.
    """
    equilibrium, measures = step.equilibrium, dict(step.measures)
    fields: dict[str, Array | Mask] = {
        "pressure": equilibrium.pressure,
        "displacement": equilibrium.displacement,
    }
    if isinstance(equilibrium, Equilibrium):
        fields |= {"gap": equilibrium.gap, "contact": equilibrium.counted_contact}
    fields |= step.fields
    of_law: dict[str, object] = {}
    if isinstance(equilibrium, AdhesiveEquilibrium):
        fields["wall_pressure"] = equilibrium.wall
        of_law = {
            "zone_area": np.count_nonzero(equilibrium.zone) * grid.cell_area,
            "zone_width": equilibrium.zone_width,
            # A measure if it does not follow from the surface.
            "energy": measures.pop("energy", equilibrium.energy),
            "residual_traction": equilibrium.residual_traction,
        }
    status = status_of(step.caveats)
    values = {
        **_numbers(grid, equilibrium),
        **measures,
        "iterations": step.iterations,
        "operator_applications": step.applications,
        "converged": status.converged,
        "status_code": status.name,
        "status": sentence_of(step.caveats),
        CAVEATS: to_text(step.caveats),
        "wall_time": seconds,
        **of_law,
    }
    described = {**VARIABLES, **{variable.name: variable for variable in variables}}
    x, y = grid.coordinates()
    coordinates = {
        "step": ("step", [number], {"long_name": "load step, counted from 1"}),
        "x": ("x", x[:, 0], {"units": "m", "long_name": "x of the cell centres"}),
        "y": ("y", y[0], {"units": "m", "long_name": "y of the cell centres"}),
    }
    data = {
        name: (("step", "x", "y"), value[None], _attributes(described[name]))
        for name, value in fields.items()
    } | {
        name: (
            ("step",),
            np.array([value], dtype=object if isinstance(value, str) else None),
            _attributes(described[name]),
        )
        for name, value in values.items()
    }
    return xr.Dataset(data, coordinates)


@lru_cache
def _attributes(variable: Variable) -> dict[str, str]:
    """Return the attributes of a variable, which xarray copies, made once for all steps."""
    return variable.attributes


class Steps:
    """The finished load steps of a run, with fields in arrays allocated for all steps.

    The result uses the same arrays, so that no field is in memory twice. The operating system
    allocates their pages only when steps are added.
    """

    def __init__(self, number: int) -> None:
        self._number = number
        self._fields: dict[Hashable, xr.Variable] = {}
        self._numbers: list[dict[str, xr.Variable]] = []
        self._attributes: dict[Hashable, object] = {}
        self.path: list[FinishedStep] = []
        """The finished steps, as later ones see them."""

    def __len__(self) -> int:
        return len(self._numbers)

    def append(self, step: xr.Dataset) -> xr.Dataset:
        """Copy a step of `step_dataset` into the arrays, whose views become its fields."""
        fields, numbers = {}, {}
        for name, variable in step.variables.items():
            if variable.ndim > 1:
                if name not in self._fields:
                    shape = (self._number, *variable.shape[1:])
                    array = np.empty(shape, variable.dtype)
                    self._fields[name] = xr.Variable(variable.dims, array, variable.attrs)
                view = self._fields[name].values[len(self) : len(self) + 1]
                view[:] = variable.values
                variable.data = view
                fields[str(name)] = view[0]
            else:
                numbers[str(name)] = variable
        self._numbers.append(numbers)
        self._attributes = self._attributes or step.attrs
        self.path.append(
            FinishedStep.of(fields, {n: v.values.item() for n, v in numbers.items() if v.size == 1})
        )
        return step

    def join_steps(self) -> xr.Dataset:
        """Return all steps as one dataset; no step can be appended afterwards."""
        columns = {name: field[: len(self)] for name, field in self._fields.items()}
        for name, first in self._numbers[0].items():
            steps = [numbers[name].values for numbers in self._numbers]
            values = np.concatenate(steps) if first.dims == ("step",) else steps[0]
            columns[name] = xr.Variable(first.dims, values, first.attrs)
        return xr.Dataset(columns, attrs=self._attributes)


_RESIDUALS = names_of("residual")


def _numbers(grid: Grid, equilibrium: Deformation) -> dict[str, object]:
    """Return the variables of every load step: force, shape of the contact and residuals."""
    of_all = {
        "force": equilibrium.force,
        "mean_pressure": equilibrium.force / grid.area,
        "elastic_energy": equilibrium.elastic_energy,
    }
    if not isinstance(equilibrium, Equilibrium):
        return dict(of_all)
    contact = equilibrium.counted_contact
    area = np.count_nonzero(contact) * grid.cell_area
    shape = ellipse(contact, grid)
    return {
        "depth": equilibrium.depth,
        **of_all,
        "contact_area": area,
        "contact_fraction": area / grid.area,
        "mean_contact_pressure": equilibrium.force / area if area else np.nan,
        "contact_radius": np.sqrt(area / np.pi),
        "semi_major_axis": shape.semi_major_axis,
        "semi_minor_axis": shape.semi_minor_axis,
        "major_axis_angle": shape.angle,
        "patches": patches(contact, grid).count,
        "perimeter": perimeter(contact, grid),
        **{name: getattr(equilibrium, name) for name in _RESIDUALS},
    }
