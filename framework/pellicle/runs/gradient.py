"""Derivatives of a result that is solved."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.fft
import xarray as xr

from pellicle.components import Depth, Force, Search
from pellicle.components.calls import target_of
from pellicle.config.gradient import derivatives_of
from pellicle.config.run import Run
from pellicle.contact.caveats import from_text
from pellicle.contact.equilibrium import AdhesiveEquilibrium, Equilibrium
from pellicle.contact.load_step import LoadStep
from pellicle.contact.problem import Adhesive
from pellicle.contact.solution import State, Stop
from pellicle.errors import ConfigError, excerpt
from pellicle.results.result import Result
from pellicle.variables import CAVEATS, COORDINATES, WALL_PRESSURE

from .compose import compose
from .runner import default_threads
from .terms import Surroundings
from .terms.gradient import Gradient


def gradient(result: Result, *, by: str | Sequence[str]) -> xr.Dataset:
    """Return derivatives of force and depth of each step of a result, with what is prescribed kept.

    One linear solve per step serves all of them, and one operator application more each.

    Parameters
    ----------
    result
        A result of `run` or `load`.
    by
        ``"heights"``, paths of numbers of kernel and indenter, such as ``"kernel.tension"``, or a
        list of them. They are the entries of ``gradient`` of a run.

    Returns
    -------
    xarray.Dataset
        ``force_by_kernel_tension`` and ``depth_by_kernel_tension`` of each step, and so on; by
        heights for each cell. NaN for a step that did not converge; a ConfigError where there is
        no derivative.
    """
    if not isinstance(result, Result):
        raise ConfigError(f"{excerpt(result)} is not a result; give that of pellicle.run", "result")
    paths = [by] if isinstance(by, str) else [*by]
    run = Run.from_mapping(result.configuration | {"gradient": paths})
    setting, data, loading = compose(run), result.dataset, run.indentation.loading
    differentiated = Gradient(run, setting)
    columns: dict[str, list[object]] = {}
    with scipy.fft.set_workers(default_threads(run.grid)):
        for index, value in enumerate(loading.values[: data.sizes["step"]]):
            row = data.isel(step=index)
            target = target_of(loading.prescription, setting, value)
            depth, pressure = row["depth"].item(), row["pressure"].values
            if isinstance(target, Search):
                is_depth = target.control is Depth
                target = Depth(depth) if is_depth else Force(row["force"].item())
            problem = setting.problem(target)
            equilibrium = Equilibrium(problem, pressure)
            if isinstance(problem, Adhesive):
                wall = State(pressure, row[WALL_PRESSURE].values, depth)
                equilibrium = AdhesiveEquilibrium(problem, pressure, wall)
            caveats = tuple(from_text(row[CAVEATS].item()))
            step = LoadStep(equilibrium, 0, Stop.DONE, caveats=caveats)
            step = differentiated.add(run, step, Surroundings((), lambda *_: None))
            for name, entry in {**step.measures, **step.fields}.items():
                columns.setdefault(name, []).append(entry)
    described = {v.name: v.attributes for v in derivatives_of(run)}
    arrays = {name: np.array(values) for name, values in columns.items()}
    return xr.Dataset(
        {name: (COORDINATES[: a.ndim], a, described[name]) for name, a in arrays.items()},
        {name: data[name] for name in COORDINATES},
    )
