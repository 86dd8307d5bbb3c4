"""Observed orders of convergence, with and without tension.

Measured slopes of the error against 1/N (root mean square over eight domain sizes, which shift the
contact's edge against the cells): force 1.9 … 2.0, counted area 1.0 … 1.2, corrected area
1.1 … 1.6 with a constant two to four times smaller.
"""

from __future__ import annotations

import numpy as np
import pytest

from pellicle_axisymmetric.indentation import indent
from pellicle_plugins.indenters.of_revolution import Paraboloid
from tests.physics.tables_of_runs import paraboloid, tensed
from tests.physics.tables_of_runs import step as solved

POINTS = np.array([16, 32, 64, 128])
A = 0.1


@pytest.mark.slow
@pytest.mark.parametrize("s_over_a", [0.0, 1.0, 10.0])
def test_force_is_second_order_and_area_first(s_over_a: float, solver: str) -> None:
    """The paraboloid's force, area and corrected area converge at the orders stated above."""
    tension = s_over_a * A / 2
    true = indent(Paraboloid(radius=1.0), 1.0, tension, contact_radius=A)
    errors = []
    for points in POINTS:
        squares = np.zeros(3)
        for size in np.linspace(0.25, 0.30, 8):
            step = solved(
                solver,
                1e-7,
                grid={"points": points, "size": size},
                kernel=tensed(1.0, tension),
                indenter=paraboloid(),
                loading={"depth": true.depth},
                corrections=[{"type": "yastrebov"}],
            )
            squares += [
                (float(step["force"]) / true.force - 1) ** 2,
                (float(step["contact_area"]) / (np.pi * A**2) - 1) ** 2,
                (float(step["contact_area_yastrebov"]) / (np.pi * A**2) - 1) ** 2,
            ]
        errors.append(np.sqrt(squares / 8))
    force, area, corrected = np.transpose(errors)
    order = [-np.polyfit(np.log(POINTS), np.log(e), 1)[0] for e in (force, area, corrected)]
    assert order[0] == pytest.approx(2.0, abs=0.2)
    assert order[1] == pytest.approx(1.1, abs=0.2)
    assert order[2] > 1.0
    assert (corrected < 0.85 * area).all()
