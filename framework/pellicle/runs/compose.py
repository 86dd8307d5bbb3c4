"""Create what all load steps of a run share; refuse or warn of what does not fit together."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from functools import lru_cache, partial
from typing import Final

import numpy as np

from pellicle.arrays import Array
from pellicle.checks import component_name, errors_attributed_to
from pellicle.components import Component, Force, Load, Search, Setting
from pellicle.components.calls import check_solver, check_values, profile_of, target_of, traction_of
from pellicle.components.installed import registry
from pellicle.components.interaction import law_of
from pellicle.components.kernel import instantaneous
from pellicle.components.rules import CHEAP, Case, first_violation
from pellicle.config.run import Run
from pellicle.contact.problem import Traction
from pellicle.contact.time_step import permanent_share
from pellicle.errors import ConfigError, PluginError
from pellicle.grid import Grid
from pellicle.plugins.component import components_in
from pellicle.surface.from_kernel import operator_of
from pellicle.surface.influence import warn_of_cells
from pellicle.surface.operators import Operator, along_axes
from pellicle.units import readable

# A step between opposite edges above this multiple of steps inside means a non-periodic surface.
_STEEPER: Final = 3.0
# Largest stiffness in the end, over the instantaneous one, of a liquid; it is rounding.
_LIQUID: Final = 1e-12


def compose(run: Run) -> Setting:
    """Return the setting of the first load step of a contact."""
    operator, (indenter, loading) = _operator(run), run.indentation
    profile = profile_of(indenter, run.grid)
    footprint = indenter.footprint
    if footprint == "domain":
        warn_of_period(profile, run.grid)
    _warn_of_liquid(run)
    setting = Setting(run.grid, operator, profile, footprint)
    if run.interaction:
        setting = replace(setting, law=law_of(run.interaction, run.kernel, run.grid))
        check_solver(run.solver, setting.problem(Force(0.0)))
    check_values(loading.prescription, setting, loading.values, loading.field_of)
    for index, value in enumerate(loading.values if run.interaction else ()):
        target = target_of(loading.prescription, setting, value)
        if isinstance(target, Search) and target.control is Force:
            raise ConfigError(
                "is searched by force, along which a contact that sticks jumps; prescribe depth or "
                "base_displacement where there is an interaction",
                loading.field_of(index),
            )
    return setting


def compose_load(run: Run, load: Load) -> list[Traction]:
    """Return what each step of a run with a load poses."""
    operator, distinct = _operator(run), run.steps if load.varying_field else 1
    tractions = [traction_of(load.at(index), run.grid) for index in range(distinct)]
    _warn_of_liquid(run)
    steps = [Traction(run.grid, operator, traction) for traction in tractions]
    return steps * (run.steps // distinct)


def _operator(run: Run) -> Operator:
    """Return the operator of the instantaneous solid; refuse components that break their rules."""
    case = Case(run.grid, run.kernel)
    parts = run.kernel, run.indenter, run.load, run.interaction, run.corrections
    for component in components_in(parts):
        if component.family in CHEAP and type(component) not in registry().own:
            # One that has no hash breaks its contract.
            with errors_attributed_to(component):
                _ask_stranger(component, case)
    with errors_attributed_to(run.kernel):
        operator = operator_of(instantaneous(run.kernel), run.grid)
        warn_of_cells(partial(along_axes, operator.symbol), run.grid)
    return operator


# Whether a rule holds depends on the values of a component and on the grid.
@lru_cache(maxsize=256)
def _ask_stranger(component: Component, case: Case) -> None:
    """Refuse a component of others that breaks a rule; those inside it are asked on their own."""
    if violation := first_violation(CHEAP[component.family], component, case):
        raise PluginError(f"{component_name(component)} breaks the rule {violation}")


def warn_of_period(heights: Array, grid: Grid) -> None:
    """Warn if opposite edges of a periodic surface meet in a step.

    The rms of this step is then more than three times that between any two neighbouring lines of
    cells. ``heights`` [m] have the grid's shape.
    """
    if grid.boundary != "periodic" or not np.isfinite(heights).all():
        return
    for axis, name in enumerate("xy"):
        lines = np.moveaxis(heights, axis, 0)
        if len(lines) < 4:
            continue
        inside = float(np.sqrt((np.diff(lines, axis=0) ** 2).mean(axis=1)).max())
        step = float(np.sqrt(((lines[0] - lines[-1]) ** 2).mean()))
        if step > _STEEPER * inside:
            warnings.warn(
                f"the surface is not periodic along {name}: its edges meet in a step of "
                f"{readable(step, 'm', 2)} (rms), where neighbouring cells differ by "
                f"{readable(inside, 'm', 2)} at most; press it on "
                'grid.boundary = "free", or make it periodic',
                stacklevel=3,
            )


def _warn_of_liquid(run: Run) -> None:
    """Warn if a solid relaxes to a liquid.

    A kernel that states its time span has a share of its own for all times beyond.
    """
    if not run.branches or run.kernel.time_span()[1] < math.inf:
        return
    if permanent_share(run.branches) < _LIQUID:
        warnings.warn(
            f"kernel: the shares of {run.kernel.type_name!r} that relax sum to 1, which makes the "
            "solid a liquid: in the end only a skin carries; let them sum to less for a solid",
            stacklevel=3,
        )
