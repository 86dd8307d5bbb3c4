"""Kernels that break their contract at work are refused by name, before a result is wrong."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from tests.framework.broken_contracts.short_run import BOUNDARIES, GRID, base, run

HalfSpace: Any = base("kernel", "half_space")
TensedMembrane: Any = base("kernel", "tensed_membrane")


class Kernel(HalfSpace):
    """Half-space that breaks its contract."""

    type: Literal["liar"] = "liar"


class InPlace(Kernel):
    """Works in the array that it is given."""

    def compliance(self, q: Any) -> Any:
        """Return 2/(E* q)."""
        q *= self.reduced_modulus / 2
        return 1 / q


class Complex(Kernel):
    """Returns complex numbers."""

    def compliance(self, q: Any) -> Any:
        """Return the compliance with an imaginary part."""
        return super().compliance(q) * (1 + 0.1j)


class Whole(Kernel):
    """Returns whole numbers."""

    def compliance(self, q: Any) -> Any:
        """Return 1 m/Pa."""
        return np.ones(q.shape, dtype=int)


class Flat(Kernel):
    """Returns all values in a row, and one too few."""

    def compliance(self, q: Any) -> Any:
        """Return a row."""
        return super().compliance(q).ravel()[:-1]


class Scalar(Kernel):
    """Returns one number for all wavenumbers."""

    def compliance(self, q: Any) -> Any:
        """Return a number [m/Pa]."""
        return 1e-8


class Masked(Kernel):
    """Masks what it does not know."""

    def compliance(self, q: Any) -> Any:
        """Return a masked array."""
        return np.ma.masked_array(super().compliance(q), q > np.median(q))


class Nothing(Kernel):
    """Returns nothing."""

    def compliance(self, q: Any) -> Any:
        """Return None."""


class Growing(Kernel):
    """Yields ever more to shorter waves."""

    def compliance(self, q: Any) -> Any:
        """Return a compliance that grows with q."""
        return q * 1e-12


class Exploding(Kernel):
    """Yields ever more to shorter waves until it overflows."""

    def compliance(self, q: Any) -> Any:
        """Return a compliance that grows exponentially with q."""
        return np.exp(q * 1e-5) * 1e-8


class WrongPrimitive(Kernel):
    """Has a primitive 1 % too large."""

    def radial_primitive(self, r: Any) -> Any:
        """Return 1.01 times the integral."""
        return 1.01 * super().radial_primitive(r)


class WrongGreensFunction(Kernel):
    """Has a Green's function of half the value."""

    def greens_function(self, r: Any) -> Any:
        """Return half the displacement."""
        return 0.5 * super().greens_function(r)


class OtherSolid(Kernel):
    """Has the closed form of a solid twice as stiff, consistent in itself."""

    def greens_function(self, r: Any) -> Any:
        """Return half the displacement."""
        return 0.5 * super().greens_function(r)

    def radial_primitive(self, r: Any) -> Any:
        """Return half the integral."""
        return 0.5 * super().radial_primitive(r)


class SkinForgotten(TensedMembrane):
    """Has the closed form without its skin: right for long waves only."""

    type: Literal["liar"] = "liar"

    def greens_function(self, r: Any) -> Any:
        """Return the displacement of a half-space."""
        return 1 / (np.pi * self.reduced_modulus * r)

    def radial_primitive(self, r: Any) -> Any:
        """Return the integral of a half-space."""
        return r / (np.pi * self.reduced_modulus)


class RadiiInPlace(Kernel):
    """Has a closed form that works in the array that it is given."""

    def greens_function(self, r: Any) -> Any:
        """Return 1/(π E* r)."""
        r *= np.pi * self.reduced_modulus
        return 1 / r


class TextAsMean(Kernel):
    """Says in words how far a uniform pressure sinks it."""

    def mean_compliance(self) -> Any:
        """Return text."""
        return "infinite"


KERNELS = {
    InPlace: (
        BOUNDARIES,
        ["changes what it is given", "work on a copy", "test_kernels.py, line"],
    ),
    Complex: (BOUNDARIES, ["compliance(q) returned an array of complex128", "float64 of shape"]),
    Whole: (BOUNDARIES, ["compliance(q) returned an array of int64", "float64 of shape"]),
    Flat: (BOUNDARIES, ["compliance(q) returned an array of float64 of shape"]),
    Scalar: (BOUNDARIES, ["compliance(q) returned 1e-08"]),
    Masked: (BOUNDARIES, ["compliance(q) returned a masked array"]),
    Nothing: (BOUNDARIES, ["compliance(q) returned None"]),
    Growing: (("periodic",), ["compliance(q) grows with q", "has to fall, or to tend to a const"]),
    Exploding: (("periodic",), ["compliance(q) grows with q"]),
    WrongPrimitive: (("free",), ["radial_primitive(r)", "compliance(q)", "have to agree"]),
    WrongGreensFunction: (("free",), ["greens_function(r)", "have to agree"]),
    OtherSolid: (("free",), ["radial_primitive(r)", "compliance(q)", "have to agree"]),
    SkinForgotten: (("free",), ["radial_primitive(r)", "compliance(q)", "have to agree"]),
    RadiiInPlace: (("free",), ["changes what it is given", "work on a copy"]),
    TextAsMean: (("periodic",), ["mean_compliance() returned 'infinite'", "a real number"]),
}


class Transposed(Kernel):
    """Returns its values the other way round, which shows where q has two dimensions only."""

    def compliance(self, q: Any) -> Any:
        """Return the compliance transposed."""
        return super().compliance(q).T


class Listed(Kernel):
    """Returns a list."""

    def compliance(self, q: Any) -> Any:
        """Return the compliance as a list."""
        return super().compliance(q).tolist()


def test_the_solver_is_not_blamed_for_a_kernel() -> None:
    """What the preconditioner asks a kernel for is checked as what the operator asks for."""
    grid = pl.Grid(**GRID, boundary="periodic")
    with pytest.raises(pl.PluginError, match=r"^kernel 'liar': compliance\(q\) returned an array"):
        run(kernel=Transposed(reduced_modulus=1e4), grid=grid)
    array, listed = (
        run(kernel=kind(reduced_modulus=1e4), grid=grid, loading={"depth": "2 um"})
        for kind in (Kernel, Listed)
    )
    assert array.dataset["force"].item() == listed.dataset["force"].item() > 0


@pytest.mark.parametrize(
    ("lie", "boundary"), [(lie, b) for lie, (boundaries, _) in KERNELS.items() for b in boundaries]
)
def test_a_kernel_that_lies_is_refused(lie: Any, boundary: str) -> None:
    """Whatever is wrong with its values, a run and one application of its operator name it."""
    kernel = lie(reduced_modulus=1e4, **({"tension": 1.0} if lie is SkinForgotten else {}))
    grid = pl.Grid(**GRID, boundary=boundary)
    for use in (
        lambda: run(kernel=kernel, grid=grid),
        lambda: pl.displacement(np.ones(grid.shape), kernel=kernel, grid=grid),
    ):
        with pytest.raises(pl.PluginError) as error:
            use()
        for part in ["kernel 'liar'", *KERNELS[lie][1]]:
            assert part in str(error.value)


@pytest.mark.parametrize("value", [0.0, -1e-8, np.nan, np.inf])
@pytest.mark.parametrize("boundary", BOUNDARIES)
def test_a_compliance_that_is_not_positive_is_refused(value: float, boundary: str) -> None:
    """One bad value among the grid's wavenumbers is named with its q and the kernel."""

    class Bad(Kernel):
        """Has one bad value."""

        def compliance(self, q: Any) -> Any:
            """Return one bad value between two wavenumbers."""
            return np.where((q > 5e4) & (q < 8e4), value, super().compliance(q))

    grid = pl.Grid(**GRID, boundary=boundary)
    with pytest.raises(pl.ConfigError, match=r"compliance\(q\) of kernel 'liar' is .* m/Pa at q"):
        pl.displacement(np.ones(grid.shape), kernel=Bad(reduced_modulus=1e4), grid=grid)


@pytest.mark.parametrize("thickness", ["1 nm", "1 um", "20 um"])
def test_a_thin_incompressible_layer_may_yield_more_to_shorter_waves(thickness: str) -> None:
    """On cells wider than the layer G(q) grows over all of the grid's waves, and is allowed to."""
    kernel = pl.kernel("bonded_layer", reduced_modulus=1e4, poissons_ratio=0.5, thickness=thickness)
    grid = pl.Grid(points=8, size="4 mm", boundary="periodic")
    values = kernel.compliance(np.linspace(1, 2, 5) * np.pi / 5e-4)
    assert (np.diff(values) > 0).all()
    assert pl.displacement(np.eye(8), kernel=kernel, grid=grid).max() > 0


def test_an_argument_of_a_kernel_is_as_it_was() -> None:
    """A kernel that asks for write access cannot change the wavenumbers of a grid."""
    grid = pl.Grid(**GRID, boundary="periodic")
    before = np.hypot(*grid.wavenumbers())
    with pytest.raises(pl.PluginError):
        pl.displacement(np.ones(grid.shape), kernel=InPlace(reduced_modulus=1e4), grid=grid)
    np.testing.assert_array_equal(np.hypot(*grid.wavenumbers()), before)
