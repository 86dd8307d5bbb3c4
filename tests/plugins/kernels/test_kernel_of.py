"""Kernels made of another one keep all that the other one states."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import Branch, KernelOf


class Stated(pl.Isotropic):
    """A layer of which half relaxes, and which states all that a kernel may."""

    type: Literal["stated"] = "stated"

    def compliance(self, q: Array) -> Array:
        """Return that of springs of 1 MPa/m in series with a half-space, E* = 1 kPa."""
        return 1e-6 / (1 + 5e-4 * q)

    def mean_compliance(self) -> float:
        """Return its limit for long waves."""
        return 1e-6

    def branches(self) -> tuple[Branch, ...]:
        """Return one branch."""
        return (Branch(0.5, 2.0),)

    def time_span(self) -> tuple[float, float]:
        """Return a span around its time."""
        return 0.1, 30.0

    def depth_to_base(self) -> float:
        """Return 3 mm."""
        return 3e-3


class Warm(KernelOf):
    """A kernel of a stranger on any other one, half as stiff, with a field of another name."""

    substrate_field = "body"
    type: Literal["warm"] = "warm"
    body: pl.Kernel

    def symbol(self, qx: Array, qy: Array) -> Array:
        """Return twice that of the body."""
        return 2 * self.body.symbol(qx, qy)


def _stated(kernel: pl.Kernel) -> list[Any]:
    members = "mean_compliance", "branches", "time_span", "depth_to_base"
    return [getattr(kernel, name)() for name in members]


@pytest.mark.parametrize(
    "kernel",
    [
        pl.kernel("coated", tension="1 N/m", substrate=Stated()),
        Warm(body=Stated()),
        pl.kernel("coated", tension="1 N/m", substrate=Warm(body=Stated())),
    ],
)
def test_all_that_the_substrate_states_is_kept(kernel: pl.Kernel) -> None:
    """As it is, and of the elastic solid that is a part as stiff, all but its relaxation."""
    assert _stated(kernel) == _stated(Stated())
    assert kernel.without_skin() == Stated()
    elastic = kernel.scaled(0.5)
    assert elastic.branches() == ()
    assert elastic.depth_to_base() == 3e-3
    assert elastic.mean_compliance() == 2 * kernel.mean_compliance()


def test_base_of_layers_is_below_all_of_them() -> None:
    """Layers on a half-space have none."""
    gel = {"reduced_modulus": 1e3, "poissons_ratio": 0.4}
    layers = [{**gel, "thickness": h} for h in (1e-3, 2e-3)]
    assert pl.kernel("layered", layers=layers, substrate="rigid").depth_to_base() == 3e-3
    assert pl.kernel("layered", layers=layers, substrate=gel).depth_to_base() == np.inf


def test_scaled_needs_no_words_of_a_kernel() -> None:
    """The solid is stiffened and the skin is not, though the solid says nothing of it."""
    q = np.geomspace(1.0, 1e9, 30)
    kernel = pl.kernel("coated", tension="1 N/m", substrate=Stated())
    expected = 1 / kernel.compliance(q) + (0.3 - 1) / Stated().compliance(q)
    np.testing.assert_allclose(1 / kernel.scaled(0.3).compliance(q), expected, rtol=1e-11)
