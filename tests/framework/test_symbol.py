"""Kernels of a vector: a stranger's symbol that differs along x and y, and who has to say so."""

from typing import Annotated, Literal

import numpy as np
import pytest
from pydantic import Field

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import KernelOf
from pellicle.components.rules import CHEAP, Case, first_violation
from pellicle.contact import measure
from pellicle.surface import along_axes, operator_of
from pellicle.testing.kernels import runs_converge
from pellicle_plugins.solvers.bending.few_cells import solved_on_few_cells


class Grained(pl.Kernel):
    """Half-space under a skin that is tensed along a grain alone."""

    type: Literal["grained"] = "grained"
    tension: Annotated[float, Field(description="tension along the grain [N/m]")] = 0.1
    angle: Annotated[float, Field(description="direction of the grain [rad]")] = 0.0
    odd: Annotated[float, Field(description="what breaks its symmetry")] = 0.0

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return 1/(E*|q|/2 + τ₀ q∥²) [m/Pa], with E* = 10 kPa."""
        along = qx * np.cos(self.angle) + qy * np.sin(self.angle)
        stiffness: Array = 5e3 * np.hypot(qx, qy) + self.tension * along**2
        return (1 + self.odd * (qx > 0)) / stiffness


GRID = pl.Grid(points=[24, 16], size=["1 mm", "0.7 mm"], boundary="periodic")


def test_a_class_of_one_compliance_is_told_its_base() -> None:
    """As soon as the class is made; on other kernels too."""
    for base in (pl.Kernel, KernelOf):
        with pytest.raises(pl.PluginError, match=r"Old has compliance\(q\) .* pellicle\.Isotropic"):
            type(
                "Old",
                (base,),
                {"__module__": __name__, "compliance": lambda self, q: 1 / q},
            )


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2])
def test_each_wave_is_displaced_by_its_symbol(angle: float) -> None:
    """Whatever its direction; mirrored waves by that of their own."""
    kernel = Grained(angle=angle)
    operator = operator_of(kernel, GRID)
    x, y = GRID.coordinates()
    for m, n in ((1, 0), (0, 3), (5, 2), (-5, 2), (3, -4)):
        qx, qy = 2 * np.pi * m / GRID.size[0], 2 * np.pi * n / GRID.size[1]
        wave = np.cos(qx * x + qy * y + 0.3)
        expected = kernel.symbol(np.array([qx]), np.array([qy])) * wave
        np.testing.assert_allclose(operator(wave), expected, atol=1e-9 * np.abs(expected).max())


def test_the_operator_is_symmetric_with_the_shortest_waves() -> None:
    """Waves of two cells have no direction along their axis."""
    operator = operator_of(Grained(angle=0.4), GRID)
    one, two = np.random.default_rng(1).standard_normal((2, *GRID.shape))
    assert (one * operator(two)).sum() == pytest.approx((two * operator(one)).sum(), rel=1e-12)
    turned = operator(one[::-1, ::-1])[::-1, ::-1]
    np.testing.assert_allclose(turned, operator(one), atol=1e-12 * np.abs(turned).max())


def test_it_keeps_the_rules_and_its_runs_converge() -> None:
    """Also inside a skin and a solid that relaxes; a symbol that is not even breaks one."""
    case = Case(GRID)
    for kernel in (
        Grained(),
        pl.kernel("coated", tension="0.1 N/m", bending="1e-12 N*m", substrate=Grained(angle=0.4)),
        pl.kernel("viscoelastic", solid=Grained(), relaxation=[{"fraction": 0.5, "time": "1 s"}]),
    ):
        assert first_violation(CHEAP["kernel"], kernel, case) == ""
        assert not kernel.is_isotropic
        runs_converge(kernel)
    assert "symbol_is_even" in first_violation(CHEAP["kernel"], Grained(odd=0.1), case)


@pytest.mark.parametrize("solver", ["active_set", "conjugate_gradient"])
def test_a_contact_is_longer_across_the_grain(solver: str) -> None:
    """A sphere under a skin that is tense along x: the tension carries where the skin is bent."""
    areas = []
    for angle in (0.0, np.pi / 2):
        result = pl.run(
            pl.Run(
                grid=pl.Grid(points=64, size="0.4 mm", boundary="periodic"),
                kernel=Grained(angle=angle, tension=0.5),
                indenter={"type": "paraboloid", "radius": "1 mm"},
                loading={"force": "20 uN"},
                solver={"type": solver},
            ),
            progress=False,
        )
        areas.append(result.dataset["contact"][0].values)
    assert areas[0].any(axis=0).sum() != areas[0].any(axis=1).sum()
    np.testing.assert_array_equal(areas[0], areas[1].T)


def test_few_cells_under_a_bent_skin_know_only_the_point_mirror() -> None:
    """Their matrix is read from one column of the operator, whose mirrors the grain has broken."""
    kernel = pl.kernel("coated", bending="1e-15 N*m", substrate=Grained(angle=0.4, tension=1.0))
    grid = pl.Grid(points=[12, 10], size=["0.1 mm", "90 um"], boundary="periodic")
    operator, unit = operator_of(kernel, grid), np.zeros(grid.shape)
    unit[0, 0] = 1.0
    random = np.random.default_rng(0)
    profile, contact = -1e-7 * random.random(grid.shape), random.random(grid.shape) < 0.2
    problem = pl.Problem(grid, operator, profile - profile.max(), pl.Force(3e-6))
    gap = np.where(contact, 0.0, 1.0)
    found = solved_on_few_cells(problem, operator(unit), contact, 1.0 - gap, gap, 1e-12)
    assert found is not None
    assert (found > 0).sum() > 20
    assert measure(problem, found).residual_contact < 1e-9


def test_it_has_no_free_boundary_and_no_one_compliance() -> None:
    """Both are said in words, as is a scale that needs no direction."""
    kernel = Grained()
    with pytest.raises(pl.ConfigError, match="yields equally in all directions"):
        operator_of(kernel, pl.Grid(points=8, size=1.0))
    with pytest.raises(pl.ConfigError, match="yields differently along x and y"):
        kernel.compliance(np.ones(3))
    q = np.array([2.0])
    mean = 0.5 * (1 / (1e4 + 0.4) + 1 / 1e4)
    assert along_axes(kernel.symbol, q)[0] == pytest.approx(mean, rel=1e-14)
