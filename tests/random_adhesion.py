"""Random small problems of adhesion, judged by a descent with dense matrices."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

import pellicle as pl
from pellicle.numerics.problem import Depth, Force
from pellicle.runs.compose import compose
from tests.dense_adhesion import DenseContact, DenseState

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
    boundary = str(draw.choice(["free", "periodic"]))
    kernel = draw.choice(
        np.array(
            [
                {"type": "half_space", "reduced_modulus": 1.0},
                {
                    "type": "tensed_membrane",
                    "reduced_modulus": 1.0,
                    "tension": 10 ** draw.uniform(-2, 0.5),
                },
                {
                    "type": "bending_skin",
                    "reduced_modulus": 1.0,
                    "tension": 0.1,
                    "bending": 10 ** draw.uniform(-4, -2),
                },
                {
                    "type": "bonded_layer",
                    "reduced_modulus": 1.0,
                    "poissons_ratio": 0.3,
                    "thickness": 0.5,
                },
            ]
        )
    )
    x = (np.arange(nx) + 0.5) / nx - 0.5
    y = (np.arange(ny) + 0.5) / ny - 0.5
    rough = draw.normal(size=(nx, ny))
    heights = {
        "smooth": -1.5 * (x[:, None] ** 2 + y**2),
        "bumps": 0.1 * np.cos(4 * np.pi * x)[:, None] * np.cos(2 * np.pi * y)
        - 0.5 * (x[:, None] ** 2 + y**2),
        "rough": 0.05 * rough - 1.0 * (x[:, None] ** 2 + y**2),
        "waves": 0.1 * np.cos(2 * np.pi * x)[:, None] * np.cos(2 * np.pi * y) + 0.01 * rough,
    }[str(draw.choice(["smooth", "bumps", "rough", "waves"]))]
    work = float(10 ** draw.uniform(-3.5, -1))
    span = float(np.ptp(heights))
    reach = span * float(draw.uniform(0.05, 0.5))
    law = draw.choice(
        np.array(
            [
                {"type": "jkr", "work_of_adhesion": work},
                {"type": "linear", "work_of_adhesion": work, "range": reach},
                {"type": "dugdale", "work_of_adhesion": work, "range": reach},
                {"type": "exponential", "work_of_adhesion": work, "range": 0.3 * reach},
            ]
        )
    )
    quantity = str(draw.choice(["depth", "force"]))
    if quantity == "depth":
        loads = span * np.array([-0.2, 0.15, 0.3, 0.0, -0.3]) * draw.uniform(0.5, 1.1)
    else:
        loads = span * np.array([0.02, 0.1, 0.2, 0.0, -0.03]) * draw.uniform(0.3, 1.5)
    return {
        "grid": {"points": [nx, ny], "size": [1.0, ny / nx], "boundary": boundary},
        "kernel": dict(kernel),
        "indenter": {
            "type": "heights",
            "values": (heights - heights.max()).tolist(),
            "unit": 1.0,
        },
        "interaction": dict(law),
        "loading": {quantity: loads.tolist()},
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
    nothing = np.zeros(contact.problem.profile.size)
    wall, traction = nothing, nothing
    rows = []
    for index, load in enumerate(loads):
        problem = setting.problem(control(float(load)))
        dense = DenseContact(problem, contact.law, contact.matrix)
        step = dataset.isel(step=index)
        reference = dense.descend(wall, traction, ROUNDS)
        rows.append(_verdict(f"{quantity}, {table['grid']['boundary']}", step, dense, reference))
        rows[-1] = rows[-1]._replace(
            description=f"seed {seed} step {index} {table['kernel']['type']} "
            f"{table['interaction']['type']} {table['grid']['points']} "
            f"contact {int(step['contact'].sum())} descent {int((reference.wall > 0).sum())}"
        )
        wall = step["wall_pressure"].values.ravel()
        traction = step["pressure"].values.ravel() - wall
    return rows


def _verdict(control: str, step: xr.Dataset, dense: DenseContact, reference: DenseState) -> Verdict:
    wall = step["wall_pressure"].values.ravel()
    pressure = step["pressure"].values.ravel()
    depth = float(step["depth"])
    gap = dense.gap(pressure, depth)
    in_contact = wall > 0
    magnitude = float(np.abs(pressure).sum()) or 1.0
    heights = float(np.ptp(dense.problem.profile))
    stationary = (
        float(wall.min()) >= 0
        and float(gap.min()) >= -STATIONARY * heights
        and float(np.abs(gap[in_contact]).max(initial=0.0)) <= STATIONARY * heights
        and float(np.abs(pressure - wall - dense.exerted(gap, in_contact)).sum())
        <= STATIONARY * magnitude
    )
    if dense.problem.prescribed == "force":
        missed = float(pressure.sum()) - dense.problem.value / dense.problem.grid.cell_area
        stationary = stationary and abs(missed) <= STATIONARY * magnitude
    energy = dense.energy(wall, pressure - wall, depth)
    scale = max(
        abs(energy),
        abs(reference.energy),
        float(-dense.law.energy(np.zeros(1))[0]) * dense.problem.grid.cell_area,
    )
    difference = (energy - reference.energy) / scale
    if not reference.in_contact:
        difference = 0.0 if not in_contact.any() else -np.inf
    return Verdict(
        control, str(step["status_code"].item()), bool(stationary), reference.settled,
        reference.in_contact, difference, "",
    )  # fmt: skip
