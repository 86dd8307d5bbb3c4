"""A kernel that gives its compliance alone is as good as one with a closed form."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
import pytest
from pydantic import Field

import pellicle as pl
from pellicle.operators import Array
from pellicle.units import Modulus, Tension


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
        run = pl.Run(
            grid={"points": 80, "size": 2.6 * a},
            kernel=kernel,
            indenter={"type": "paraboloid", "radius": 1.0},
            loading={"depth": 0.7 * a**2},
            solver={"type": solver, "tolerance": 1e-10},
        )
        result = pl.run(run, progress=False)
        assert result.converged
        results.append(result.dataset.isel(step=0))
    ours, theirs = results
    assert int(ours["contact"].sum()) > 400
    np.testing.assert_array_equal(ours["contact"], theirs["contact"])
    assert float(ours["force"]) == pytest.approx(float(theirs["force"]), rel=1e-7)
    highest = float(theirs["pressure"].max())
    np.testing.assert_allclose(ours["pressure"], theirs["pressure"], rtol=0, atol=1e-7 * highest)


def test_a_thin_layer_is_a_winkler_foundation(solver: str) -> None:
    """A layer much thinner than the contact yields by h/E* under a unit pressure, cell by cell."""
    h, modulus, a = 0.01, 3.0, 1.0

    class Layer(pl.Kernel):
        """Layer on a frictionless rigid base."""

        type: Literal["thin"] = "thin"

        def compliance(self, q: Array) -> Array:
            """Return G(q) [m/Pa]; Johnson 1985, section 5.8."""
            t = np.minimum(2 * q * h, 700)
            decay = np.exp(-t)
            # (cosh t − 1)/(sinh t + t), over eᵗ/2.
            shape = np.expm1(-t) ** 2 / (2 * t * decay - np.expm1(-2 * t))
            return np.asarray(2 / (modulus * q) * shape)

    run = pl.Run(
        grid={"points": 96, "size": 2.4 * a},
        kernel=Layer(),
        indenter={"type": "paraboloid", "radius": 100.0},
        loading={"depth": a**2 / 200},
        solver={"type": solver},
    )
    step = pl.run(run, progress=False).dataset.isel(step=0)
    assert step["converged"]
    # P = π k a⁴/4R with k = E*/h and a² = 2Rδ; cells of a width 2.5 h tell them apart by 1 %.
    assert float(step["force"]) == pytest.approx(np.pi * modulus / h * a**4 / 400, rel=0.02)
