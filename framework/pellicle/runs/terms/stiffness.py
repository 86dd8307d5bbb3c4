"""The contact stiffness dF/dδ, if it is asked for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pellicle.components import Depth
from pellicle.config.run import Run
from pellicle.contact.caveats import Caveat, Status
from pellicle.contact.equilibrium import Equilibrium
from pellicle.contact.load_step import LoadStep
from pellicle.contact.stiffness import Stiffness, measure_stiffness

from .surroundings import Solve, Surroundings


def stiffness(run: Run, step: LoadStep, here: Surroundings) -> LoadStep:
    """Add the contact stiffness [N/m], δ being the depth of the indenter."""
    measured, tolerance = _measured(step.equilibrium, here.solve), run.solver.tolerance
    missed = Caveat(Status.STIFFNESS, {"measure": measured.residual, "tolerance": tolerance})
    unknown = not measured.residual <= tolerance
    return step.having({"stiffness": measured.value}, [missed] if unknown else [])


def _measured(equilibrium: Equilibrium, solve: Solve) -> Stiffness:
    problem = replace(equilibrium.problem, control=Depth(equilibrium.depth))
    contact = equilibrium.contact
    if problem.has_infinite_stiffness(contact):
        return Stiffness(np.inf, 0.0)
    if not contact.any():
        return Stiffness(0.0, 0.0)
    response = solve.response(problem, equilibrium.state)
    return measure_stiffness(problem, contact, response, equilibrium.attraction)
