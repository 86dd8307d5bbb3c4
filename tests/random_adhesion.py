"""Random small problems of adhesion, judged by a descent with dense matrices."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

import pellicle as pl
from pellicle.arrays import Array
from pellicle.contact.problem import Depth, Force
from pellicle.runs.compose import compose
from tests import tables_of_runs
from tests.dense_adhesion import DenseContact

# Rounds of a descent; one that has not settled then is counted as such.
ROUNDS = 20_000
# Relative residual up to which a step is a stationary point.
STATIONARY = 1e-6
# Difference of energies on the same branch, over the work of adhesion of all closed cells or the
# energy itself.
SAME = 1e-6


class Verdict(NamedTuple):
    """What became of one step."""

    control: str
    """"depth" or "force", and the boundary."""
    status: str
    stationary: bool
    """Whether it is a stationary point, by the dense matrix."""
    settled: bool
    """Whether the descent has settled."""
    carried: bool
    """Whether the descent ended in contact, or the depth is prescribed."""
    difference: float
    """Energy of the step minus that of the descent, over the scale of energies."""
    description: str

    @property
    def converged(self) -> bool:
        """Whether the step claims to be solved."""
        return self.status in ("CONVERGED", "STEEP", "COARSE", "COARSE_ZONE", "JUMPED")

    @property
    def honest(self) -> bool:
        """Whether a step that claims to be solved is a stationary point."""
        return self.stationary or not self.converged


def random_run(seed: int) -> dict[str, Any]:
    """Return a path over five loads, all drawn at random; lengths and moduli are near 1."""
    draw = np.random.default_rng(seed)
    nx, ny = (int(n) for n in draw.integers(8, 25, 2))
    boundary = ["free", "periodic"][draw.integers(2)]
    skins = {"tension": 10 ** draw.uniform(-2, 0.5)}, {"bending": 10 ** draw.uniform(-4, -2)}
    kernels: list[dict[str, Any]] = [
        {"type": "half_space"},
        {"type": "tensed_membrane", **skins[0]},
        {"type": "bending_skin", "tension": 0.1, **skins[1]},
        {"type": "bonded_layer", "poissons_ratio": 0.3, "thickness": 0.5},
    ]
    kernel = kernels[draw.integers(4)]
    x = (np.arange(nx)[:, None] + 0.5) / nx - 0.5
    y = (np.arange(ny) + 0.5) / ny - 0.5
    rough, bowl = draw.normal(size=(nx, ny)), x**2 + y**2
    heights = [
        -1.5 * bowl,
        0.1 * np.cos(4 * np.pi * x) * np.cos(2 * np.pi * y) - 0.5 * bowl,
        0.05 * rough - 1.0 * bowl,
        0.1 * np.cos(2 * np.pi * x) * np.cos(2 * np.pi * y) + 0.01 * rough,
    ][draw.integers(4)]
    work = float(10 ** draw.uniform(-3.5, -1))
    span = float(np.ptp(heights))
    reach = span * float(draw.uniform(0.05, 0.5))
    laws: list[dict[str, Any]] = [
        {"type": "jkr"},
        {"type": "linear", "range": reach},
        {"type": "dugdale", "range": reach},
        {"type": "exponential", "range": 0.3 * reach},
    ]
    law = laws[draw.integers(4)]
    quantity = ["depth", "force"][draw.integers(2)]
    if quantity == "depth":
        loads = span * np.array([-0.2, 0.15, 0.3, 0.0, -0.3]) * draw.uniform(0.5, 1.1)
    else:
        loads = span * np.array([0.02, 0.1, 0.2, 0.0, -0.03]) * draw.uniform(0.3, 1.5)
    solid, shape = (
        {"reduced_modulus": 1.0, **kernel},
        tables_of_runs.heights(heights - heights.max()),
    )
    path: dict[str, Any] = {"boundary": boundary, quantity: loads.tolist()}
    return tables_of_runs.pressing([nx, ny], [1.0, ny / nx], solid, shape, **path) | {
        "interaction": {"work_of_adhesion": work, **law},
        "solver": {"type": "active_set", "tolerance": 1e-8},
    }


def verdicts(seed: int) -> list[Verdict]:
    """Return what became of each step of a random path."""
    table = random_run(seed)
    run = pl.Run(**table)
    dataset = pl.run(run, progress=False).dataset
    setting = compose(run)
    ((quantity, loads),) = table["loading"].items()
    control = Depth if quantity == "depth" else Force
    contact = DenseContact.of(setting.problem(control(float(loads[0]))))
    wall = traction = np.zeros(contact.problem.profile.size)
    rows = []
    for index, load in enumerate(loads):
        problem = replace(contact.problem, control=control(float(load)))
        dense = replace(contact, problem=problem)
        step = dataset.isel(step=index)
        reference = dense.descend(wall, traction, ROUNDS)
        wall = step["wall_pressure"].values.ravel()
        traction = step["pressure"].values.ravel() - wall
        difference = dense.energy(wall, traction, float(step["depth"])) - reference.energy
        difference /= max(
            abs(difference + reference.energy),
            abs(reference.energy),
            float(-dense.law.energy(np.zeros(1))[0]) * dense.problem.grid.cell_area,
        )
        if not reference.in_contact:
            difference = 0.0 if not (wall > 0).any() else -np.inf
        verdict = Verdict(
            control=f"{quantity}, {table['grid']['boundary']}",
            status=str(step["status_code"].item()),
            stationary=_is_stationary(dense, wall, traction, float(step["depth"])),
            settled=reference.settled,
            carried=reference.in_contact,
            difference=difference,
            description=f"seed {seed} step {index} {table['kernel']['type']} "
            f"{table['interaction']['type']} {table['grid']['points']} "
            f"contact {int(step['contact'].sum())} descent {int((reference.wall > 0).sum())}",
        )
        rows.append(verdict)
    return rows


def _is_stationary(dense: DenseContact, wall: Array, traction: Array, depth: float) -> bool:
    pressure, problem = wall + traction, dense.problem
    gap, in_contact = dense.gap(pressure, depth), wall > 0
    magnitude, heights = float(np.abs(pressure).sum()) or 1.0, float(np.ptp(problem.profile))
    missed = float(np.abs(traction - dense.exerted(gap, in_contact)).sum())
    if problem.prescribed == "force":
        missed = max(missed, abs(float(pressure.sum()) - problem.value / problem.grid.cell_area))
    opened = max(float(np.abs(gap[in_contact]).max(initial=0.0)), -float(gap.min()))
    return bool(
        wall.min() >= 0 and opened <= STATIONARY * heights and missed <= STATIONARY * magnitude
    )
