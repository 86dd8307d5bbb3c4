"""A kernel that gives its compliance alone is as good as one with a closed form."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
import pytest
from pydantic import Field

import pellicle as pl
from pellicle.operators import Array
from pellicle.units import Modulus, Tension
from tests.physics.tables import paraboloid
from tests.physics.tables import step as solved


class Skin(pl.Kernel):
    """The tensed membrane again, known by its compliance."""

    type: Literal["skin"] = "skin"
    reduced_modulus: Annotated[Modulus, Field(description="E* [Pa]")]
    tension: Annotated[Tension, Field(description="tension [N/m]")]

    def compliance(self, q: Array) -> Array:
        """Return G(q) = 1/(E* q/2 + τ₀ q²) [m/Pa]."""
        return 1.0 / (self.reduced_modulus * q / 2 + self.tension * q**2)


@pytest.mark.parametrize("s_over_a", [0.0, 0.1, 1.0, 10.0])
def test_tensed_paraboloid_is_solved_as_with_the_closed_form(s_over_a: float, solver: str) -> None:
    """Depth, force and pressure of the paraboloid agree with the built-in kernel's to 1e-7."""
    a = 0.1
    results = []
    for kernel in (
        Skin(reduced_modulus=1.0, tension=s_over_a * a / 2),
        pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=s_over_a * a / 2),
    ):
        tables = {"grid": {"points": 80, "size": 2.6 * a}, "loading": {"depth": 0.7 * a**2}}
        results.append(solved(solver, 1e-10, kernel=kernel, indenter=paraboloid(), **tables))
    ours, theirs = results
    assert int(ours["contact"].sum()) > 400
    np.testing.assert_array_equal(ours["contact"], theirs["contact"])
    assert float(ours["force"]) == pytest.approx(float(theirs["force"]), rel=1e-7)
    highest = float(theirs["pressure"].max())
    np.testing.assert_allclose(ours["pressure"], theirs["pressure"], rtol=0, atol=1e-7 * highest)
