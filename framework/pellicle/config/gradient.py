"""What a run may be differentiated by, and the variables of its derivatives."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Final

from pellicle.components import Interaction
from pellicle.components.kernel import branches_of
from pellicle.errors import ConfigError
from pellicle.schema.model import python_names, walk
from pellicle.units import Quantity, quantity_of, si_unit, unit_quantity
from pellicle.variables import VARIABLES, Variable

if TYPE_CHECKING:
    from .run import Run

HEIGHTS: Final = "heights"
"""What stands for the height of each cell of the indenter."""
_MAY = 'give "heights", or the path of a number of the kernel or the indenter, as "kernel.tension"'


def quantities_of(run: Run) -> dict[str, Quantity]:
    """Return the quantity of each number of kernel and indenter by its path, and of heights."""
    parts = {"kernel": run.kernel, "indenter": run.indenter}
    quantities = {
        path: (info and quantity_of(info)) or Quantity("1")
        for path, value, info in walk(parts)
        if isinstance(value, float)
    }
    return quantities | {HEIGHTS: Quantity("m")}


def refuse_undefined(run: Run, path: str, before: Iterable[str] = ()) -> None:
    """Refuse a path by which nothing is differentiable, or that is among those ``before``."""
    if path in before:
        raise ConfigError(f"{path!r} is given twice; leave one out")
    if path in VARIABLES:
        raise ConfigError(
            f"{path!r} is a result; what is differentiated are force and depth alone, since areas, "
            f"pull-off and the like change by whole cells; {_MAY}"
        )
    if path not in quantities_of(run):
        raise ConfigError(f"{path!r} is no real number of this kernel or indenter; {_MAY}")
    interaction, by_kernel = run.interaction, path.startswith("kernel.")
    if interaction and by_kernel and type(interaction).resolved is not Interaction.resolved:
        raise ConfigError(
            f"{path!r} also changes the range that {interaction.type_name!r} takes from kernel and "
            'cells; give "heights" or numbers of the indenter alone, or an interaction with a '
            "range of its own"
        )
    loading = run.indentation.loading
    if branches_of(run.kernel) and (len(loading.values) > 1 or loading.durations[0] > 0):
        raise ConfigError(
            f"{run.kernel.type_name!r} relaxes, so derivatives are those of a first step that is a "
            "jump; prescribe it alone"
        )


def derivatives_of(run: Run) -> list[Variable]:
    """Return the derivatives of force and depth by all that the gradient of a run names."""
    paths = run.gradient or ()
    names, quantities = python_names(paths), quantities_of(run) if paths else {}
    return [
        Variable(
            f"{quantity}_by_{names[path]}",
            unit
            if (by := quantities[path].unit) == "1"
            else si_unit(unit_quantity(unit) / unit_quantity(by)),
            f"derivative of the {quantity} by {path}, what is prescribed kept",
            "field" if path == HEIGHTS else "requested",
            title=f"d({quantity})/d({path})",
        )
        for path in paths
        for quantity, unit in (("force", "N"), ("depth", "m"))
    ]
