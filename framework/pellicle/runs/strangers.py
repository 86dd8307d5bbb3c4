"""Ask the rules that need no run of the components of a run that pellicle does not ship."""

from __future__ import annotations

from functools import lru_cache

from pellicle.checks import component_name, errors_attributed_to
from pellicle.components import Component
from pellicle.components.rules import CHEAP, Case, broken
from pellicle.config.run import Run, components_in
from pellicle.errors import PluginError
from pellicle.plugins import registry


def ask_strangers(run: Run) -> None:
    """Refuse components of others, also inside those of pellicle, that break a cheap rule.

    Raises
    ------
    PluginError
        A component breaks its contract; the message names it, the rule and the violation.
    """
    case = Case(run.grid, run.kernel)
    for component in components_in([run.kernel, run.indenter, run.interaction, run.corrections]):
        if component.family in CHEAP and not _is_own(component):
            # One that has no hash breaks its contract.
            with errors_attributed_to(component):
                _ask(component, case)


def _is_own(component: Component) -> bool:
    """Return whether the class is one that the distribution of pellicle registers."""
    registered = registry().components[component.family].get(getattr(component, "type", ""))
    return (
        registered is not None
        and registered.component is type(component)
        and registered.origin.is_own
    )


# Whether a rule holds depends on the values of a component and on the grid.
@lru_cache(maxsize=256)
def _ask(component: Component, case: Case) -> None:
    if violation := broken(CHEAP[component.family], component, case):
        raise PluginError(f"{component_name(component)} breaks the rule {violation}")
