"""Create the operator and profile that all load steps of a run share; check the loading."""

from __future__ import annotations

from pellicle.checks import errors_attributed_to
from pellicle.components import Force, Search, Setting
from pellicle.components.indenter import profile_of
from pellicle.components.interaction import law_of
from pellicle.components.kernel import instantaneous
from pellicle.components.prescription import check_value, target_of
from pellicle.components.solver import check_solver
from pellicle.config.run import Run
from pellicle.errors import ConfigError
from pellicle.surface.grid_checks import warn_of_cells, warn_of_period
from pellicle.surface.operators import make_operator

from .relaxation_checks import warn_of_relaxation
from .strangers import ask_strangers


def compose(run: Run) -> Setting:
    """Return the setting of the first load step."""
    ask_strangers(run)
    with errors_attributed_to(run.kernel):
        operator = make_operator(instantaneous(run.kernel), run.grid)
        warn_of_cells(run.kernel.compliance, run.grid)
    profile = profile_of(run.indenter, run.grid)
    if run.indenter.footprint == "domain":
        warn_of_period(profile, run.grid)
    warn_of_relaxation(run)
    law = law_of(run.interaction, run.kernel, run.grid) if run.interaction else None
    setting = Setting(run.grid, operator, profile, run.indenter.footprint, law=law)
    if law:
        check_solver(run.solver, setting.problem(Force(0.0)))
    prescription = run.loading.prescription
    for index, value in enumerate(run.loading.values):
        field = f"loading.{run.loading.field_of(index)}"
        check_value(prescription, setting, value, field)
        target = target_of(prescription, setting, value) if law else None
        if isinstance(target, Search) and target.control is Force:
            raise ConfigError(
                "is searched by force, along which a contact that sticks jumps; prescribe depth or "
                "base_displacement where there is an interaction",
                field,
            )
    return setting
