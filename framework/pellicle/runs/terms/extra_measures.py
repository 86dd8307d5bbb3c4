"""Measures on request: corrected areas, those of the prescription, the stiffness."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pellicle.components import Depth
from pellicle.components.calls import corrected_area, report_of, response_of
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import AdhesiveEquilibrium, Stiffness, measure_stiffness
from pellicle.variables import CORRECTED_AREA, CORRECTED_FRACTION

from . import AroundContact, ContactStep, Surroundings


def corrections(run: Run, step: ContactStep, surroundings: Surroundings) -> ContactStep:
    """Add the contact area by each correction, and after these the shares of the domain."""
    areas = {
        correction.type_name: corrected_area(correction, step.equilibrium.counted_contact, run.grid)
        for correction in run.corrections
    }
    measures = {f"{CORRECTED_AREA}{type_}": area for type_, area in areas.items()}
    shares = {f"{CORRECTED_FRACTION}{t}": area / run.grid.area for t, area in areas.items()}
    return step.with_measures(measures | shares)


def prescription(run: Run, step: ContactStep, surroundings: AroundContact) -> ContactStep:
    """Add the variables of the prescription; that of kind ``residual`` is what a search missed."""
    prescribed = run.indentation.loading.prescription
    report = report_of(prescribed, surroundings.setting, step.equilibrium)
    report |= {v.name: step.missed for v in prescribed.variables if v.name not in report}
    return step.with_measures(report)


def stiffness(run: Run, step: ContactStep, surroundings: Surroundings) -> ContactStep:
    """Add the contact stiffness [N/m], δ being the depth of the indenter."""
    step = add_response(run, step, surroundings)
    assert step.response
    return step.with_measures({"stiffness": step.response[1]})


def add_response(run: Run, step: ContactStep, surroundings: Surroundings) -> ContactStep:
    """Return the step with its response to a change of δ, and a caveat if that is not known."""
    if step.response:
        return step
    equilibrium, tolerance = step.equilibrium, run.solver.tolerance
    problem = replace(equilibrium.problem, control=Depth(equilibrium.depth))
    contact = equilibrium.contact
    response = np.ones(contact.shape)
    if contact.all() and not problem.operator.has_mean_compliance:
        # A period in full contact whose mean displacement is 0.
        measured = Stiffness(np.inf, 0.0)
    elif not contact.any():
        measured, response = Stiffness(0.0, 0.0), np.zeros(contact.shape)
    else:
        response = response_of(run.solver, problem, equilibrium.state, surroundings.monitor)
        measured = measure_stiffness(problem, contact, response)
        if isinstance(equilibrium, AdhesiveEquilibrium):
            acting = equilibrium.attraction
            measured = measure_stiffness(problem, contact, response, acting)
    missed = Caveat(Status.STIFFNESS, {"measure": measured.residual, "tolerance": tolerance})
    unknown = not measured.residual <= tolerance
    step = replace(step, response=(response, measured.value))
    return step.with_measures({}, [missed] if unknown else [])
