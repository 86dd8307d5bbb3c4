"""The semi-analytic reference solution of a run with an axisymmetric contact."""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cache

import numpy as np

from pellicle import Run
from pellicle.arrays import Dataset
from pellicle.components import HasAbelSlope, Runs
from pellicle.errors import ConfigError
from pellicle.results import DERIVED, Result, StoredRuns, derive
from pellicle.variables import CORRECTED_AREA, CORRECTED_FRACTION, names_of
from pellicle_axisymmetric import AxisymmetricContact, indent, kinks_of
from pellicle_plugins.kernels.half_spaces import HalfSpace, TensedMembrane

_PRESCRIBED = "depth", "force", "contact_radius", "contact_area"
_LINE = 401
"""Points of a line from the centre to the edge of the contact."""


def contact(run: Dataset, step: int) -> AxisymmetricContact | None:
    """Return the reference contact of a load step, counted from 1; None if 0 is prescribed."""
    return _contact(run.attrs["configuration"], step)


@cache
def _contact(configuration: str, step: int) -> AxisymmetricContact | None:
    run = Run.from_json(configuration)
    kernel, (indenter, loading) = run.kernel, run.indentation
    prescribed = loading.prescribed
    if run.interaction is not None:
        raise ConfigError(
            "the axisymmetric solution is that of contact without adhesion, and this run has an "
            "[interaction]; leave one out",
            "reference",
        )
    if (
        not isinstance(kernel, (HalfSpace, TensedMembrane))
        or not isinstance(indenter, HasAbelSlope)
        or kinks_of(indenter)
        or run.grid.boundary != "free"
    ):
        raise ConfigError(
            f"kernel {kernel.type_name!r} and indenter {indenter.type_name!r}"
            f" on a {run.grid.boundary} boundary have no axisymmetric solution here; it needs the "
            "kernel half_space or tensed_membrane, an indenter with an Abel transform and without "
            "edges such as paraboloid, sphere or sharp cone, and a free boundary",
            "reference",
        )
    if prescribed not in _PRESCRIBED:
        raise ConfigError(
            f"loading.{prescribed} has no reference solution; prescribe {', '.join(_PRESCRIBED)}",
            "reference",
        )
    value = loading.values[step - 1]
    if value == 0:
        return None
    if prescribed == "contact_area":
        prescribed, value = "contact_radius", float(np.sqrt(value / np.pi))
    tension = getattr(kernel, "tension", 0.0)
    return indent(indenter, kernel.contact_modulus, tension, **{prescribed: value})


def exact(runs: Runs) -> Runs:
    """Return the table of ``runs`` with the numbers of the semi-analytic solution alone."""

    def no_fields(_name: str) -> Dataset:
        raise ConfigError(
            "the semi-analytic solution has no fields on a grid; compare fields by the output "
            "profiles",
            "reference",
        )

    names = [name for name in _numbers(None, 1.0, runs.table) if name in runs.table]
    dims = *runs.table["run"].dims, "step"
    shape = *runs.table["run"].shape, runs.table.sizes["step"]
    columns = {name: np.full(shape, np.nan) for name in names}
    for index, run in runs.datasets():
        if run is None:
            continue
        for position, step in enumerate(run["step"].values.tolist()):
            numbers = _numbers(contact(run, step), Result(run).grid.area, runs.table)
            for name in names:
                columns[name][(*index, position)] = numbers[name]
    table = runs.table[[*names_of("status"), "run"]].assign(
        {name: (dims, values, runs.table[name].attrs) for name, values in columns.items()}
    )
    for name, text in json.loads(table.attrs.get(DERIVED, "{}")).items():
        with suppress(ConfigError):
            table = derive(table, {name: text}, {})
            table[name].attrs = runs.table[name].attrs
    return StoredRuns(table, no_fields)


def _numbers(
    solution: AxisymmetricContact | None, domain: float, simulated: Dataset
) -> dict[str, float]:
    """Return the variables of a result that the equation gives; ``domain`` is in m².

    Corrected areas and fractions are those of ``simulated``: on a continuous surface none differs.
    """
    radius = solution.contact_radius if solution else 0.0
    force = solution.force if solution else 0.0
    area = np.pi * radius**2
    corrected, fractions = (
        [str(name) for name in simulated if str(name).startswith(prefix)]
        for prefix in (CORRECTED_AREA, CORRECTED_FRACTION)
    )
    return {
        "depth": solution.depth if solution else 0.0,
        "force": force,
        "mean_pressure": force / domain,
        "contact_fraction": area / domain,
        "mean_contact_pressure": force / area if area else np.nan,
        "contact_radius": radius,
        "semi_major_axis": radius,
        "semi_minor_axis": radius,
        "perimeter": 2 * np.pi * radius,
        **dict.fromkeys(["contact_area", *corrected], area),
        **dict.fromkeys(fractions, area / domain),
    }


def exact_line(run: Dataset) -> Dataset:
    """Return pressure, contact and numbers of the semi-analytic solution along a line.

    ``run`` is one step with either ``x`` or ``y`` as its only spatial dimension, along which the
    returned one has finer points, the edge of the contact among them.
    """
    import xarray as xr

    (along,) = {"x", "y"} & set(map(str, run.dims))
    (across,) = {"x", "y"} - {along}
    solution = contact(run, int(run["step"].item()))
    offset = float(run[across].item())
    end = float(np.abs(run[along].values).max())
    a = solution.contact_radius if solution else 0.0
    half = np.sqrt(max(a**2 - offset**2, 0.0))
    # Under tension the pressure jumps at the edge: one point lies on it, one just outside.
    inner = half * np.sin(np.linspace(0.0, np.pi / 2, _LINE))
    positive = np.concatenate([inner, [half * (1 + 1e-9), max(end, half * (1 + 2e-9))]])
    positions = np.concatenate([-positive[:0:-1], positive])
    r = np.minimum(np.hypot(positions, offset), np.where(np.abs(positions) <= half, a, np.inf))
    pressure = solution.pressure(r) if solution else np.zeros(r.shape)
    numbers = _numbers(solution, Result(run).grid.area, run)
    line = run.drop_dims(along)[[*names_of("status")]].assign(numbers)
    return line.assign_coords({along: (along, positions, run[along].attrs)}).assign(
        pressure=xr.DataArray(pressure, dims=along, attrs=run["pressure"].attrs),
        contact=xr.DataArray(r <= a, dims=along),
    )
