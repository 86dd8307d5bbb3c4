"""Create the operator and profile that all load steps of a run share; check the loading."""

from __future__ import annotations

from pellicle.checks import errors_attributed_to
from pellicle.components import Setting
from pellicle.components.calls import check_value, instantaneous, law_of, profile_of
from pellicle.config.run import Run
from pellicle.numerics.grid_checks import warn_of_cells, warn_of_period
from pellicle.numerics.operators import make_operator


def compose(run: Run) -> Setting:
    """Return the setting of the first load step.

    Raises
    ------
    ConfigError
        The kernel, the indenter or the loading does not fit the grid.
    """
    with errors_attributed_to(run.kernel):
        operator = make_operator(instantaneous(run.kernel), run.grid)
        warn_of_cells(run.kernel.compliance, run.grid)
    profile = profile_of(run.indenter, run.grid)
    if run.indenter.footprint == "domain":
        warn_of_period(profile, run.grid)
    law = law_of(run.interaction, run.kernel, run.grid) if run.interaction else None
    setting = Setting(run.grid, operator, profile, run.indenter.footprint, law=law)
    for index, value in enumerate(run.loading.values):
        field = f"loading.{run.loading.prescribed}.{index}"
        check_value(run.loading.prescription, setting, value, field)
    return setting
