"""The contact area by each correction."""

from __future__ import annotations

from pellicle.components.base import words_of_type
from pellicle.components.correction import corrected_area
from pellicle.config.run import Run
from pellicle.contact.load_step import LoadStep
from pellicle.variables import Variable, corrected_fraction
from pellicle.variables import corrected_area as area_variable

from .surroundings import Surroundings


def corrections(run: Run, step: LoadStep, surroundings: Surroundings) -> LoadStep:
    """Add the contact area by each correction, and after these the shares of the domain."""
    areas = [corrected_area(c, step.equilibrium.contact, run.grid) for c in run.corrections]
    values = [*areas, *(area / run.grid.area for area in areas)]
    names = [variable.name for variable in corrected_variables(run)]
    return step.having(dict(zip(names, values, strict=True)))


def corrected_variables(run: Run) -> tuple[Variable, ...]:
    """Return the variables of the corrected areas, and after these of the shares."""
    types = [(c.type_name, words_of_type(type(c), c.type_name)) for c in run.corrections]
    areas = [area_variable(*type_) for type_ in types]
    return (*areas, *map(corrected_fraction, areas))
