"""Kernels of others: a pair is each body alone where the other is rigid, and all is kept."""

from typing import Any, Literal

import numpy as np
import pytest

import pellicle as pl
from pellicle.arrays import Array
from pellicle.components import Branch, KernelOf
from pellicle.surface import mean_compliance, operator_of
from pellicle.surface.from_kernel import closed_form_of
from tests.tables_of_runs import half_space, layer, pressing, relaxing

SKIN: dict[str, Any] = {"type": "tensed_membrane", "reduced_modulus": 1e4, "tension": 0.04}
LAYER: dict[str, Any] = layer("bonded_layer", 1e-4, 0.4, youngs_modulus=5e3)
BALL = {"type": "paraboloid", "radius": 1e-3}


def pair(first: Any, second: Any) -> Any:
    """Return the kernel of two bodies."""
    return pl.kernel("pair", first=first, second=second)


def force(kernel: Any, boundary: str = "free", **loading: Any) -> Any:
    """Return the last step of a paraboloid that is pressed in."""
    return pl.run(
        pl.Run(
            grid={"points": 64, "size": "0.4 mm", "boundary": boundary},
            kernel=kernel,
            indenter=BALL,
            loading=loading or {"depth": ["10 um"]},
        ),
        progress=False,
    ).dataset.isel(step=-1)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_two_equal_bodies_are_a_rigid_one_on_half_of_both(boundary: Any) -> None:
    """Half the modulus and half the tension, with the same length s; in every cell."""
    both, half = pair(SKIN, SKIN), pl.kernel("tensed_membrane", reduced_modulus=5e3, tension=0.02)
    grid = pl.Grid(points=[32, 24], size=[4e-4, 3e-4], boundary=boundary)
    pressure = np.random.default_rng(0).random(grid.shape)
    expected = operator_of(half, grid)(pressure)
    np.testing.assert_allclose(operator_of(both, grid)(pressure), expected, rtol=1e-12)
    assert force(both, boundary)["force"].item() == pytest.approx(
        force(half, boundary)["force"].item(), rel=1e-8
    )


def test_a_skin_of_infinite_tension_is_a_rigid_body() -> None:
    """So is a body of a very large modulus."""
    alone = force(SKIN)["force"].item()
    for rigid in (SKIN | {"tension": 1e9}, {"type": "half_space", "reduced_modulus": 1e16}):
        assert force(pair(SKIN, rigid))["force"].item() == pytest.approx(alone, rel=1e-6)
        assert force(pair(rigid, SKIN))["force"].item() == pytest.approx(alone, rel=1e-6)


def test_hertz_of_two_bodies() -> None:
    """The reduced moduli add as compliances, 1/E* = 1/E₁* + 1/E₂*."""
    bodies = [{"type": "half_space", "reduced_modulus": e} for e in (1e4, 3e4)]
    one = {"type": "half_space", "reduced_modulus": 7.5e3}
    assert force(pair(*bodies))["force"].item() == pytest.approx(
        force(one)["force"].item(), rel=1e-9
    )
    hertz = 4 / 3 * 7.5e3 * np.sqrt(1e-3) * 1e-5**1.5
    assert force(pair(*bodies))["force"].item() == pytest.approx(hertz, rel=3e-3)


def test_closed_forms_add_where_both_have_one() -> None:
    """Otherwise the sum is tabulated, and is that of its parts."""
    assert closed_form_of(pair(SKIN, SKIN))
    mixed = pair(SKIN, LAYER)
    assert closed_form_of(mixed) is None
    grid = pl.Grid(points=32, size=4e-4)
    pressure = np.random.default_rng(0).random(grid.shape)
    parts = [operator_of(pl.kernel(k["type"], **_fields(k)), grid) for k in (SKIN, LAYER)]
    expected = sum(part(pressure) for part in parts)
    np.testing.assert_allclose(operator_of(mixed, grid)(pressure), expected, rtol=1e-7)


def _fields(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if key != "type"}


def test_what_bodies_state_of_themselves() -> None:
    """The nearer base, and the sum of what a uniform pressure does."""
    thin, thick = LAYER, LAYER | {"thickness": 3e-4}
    layers = pair(thin, thick)
    assert layers.depth_to_base() == 1e-4
    assert mean_compliance(layers) == pytest.approx(
        sum(mean_compliance(pl.kernel("bonded_layer", **_fields(k))) for k in (thin, thick))
    )
    assert mean_compliance(pair(thin, SKIN)) == np.inf
    assert pair(thin, SKIN).depth_to_base() == 1e-4


def test_two_bodies_that_relax_alike_are_one() -> None:
    """Of the sum of their compliances, whatever the path."""
    loading: Any = {"depth": ["5 um", "10 um", "10 um"], "time": [0.0, 0.5, 3.0]}
    first, second, one = (relaxing(half_space(e), 0.5, 1.0) for e in (1e4, 3e4, 7.5e3))
    both = pair(first, second)
    expected = force(one, **loading)["force"].item()
    assert force(both, **loading)["force"].item() == pytest.approx(expected, rel=1e-8)


def test_derivatives_by_both_bodies() -> None:
    """Two equal bodies share the derivative of one of half."""
    paths = ["kernel.first.tension", "kernel.second.tension"]
    run = pressing(
        32, "0.4 mm", {"type": "pair", "first": SKIN, "second": SKIN}, BALL, depth=["10 um"]
    ) | {"gradient": paths}
    data = pl.run(run, progress=False).dataset
    one = run | {
        "kernel": SKIN | {"reduced_modulus": 5e3, "tension": 0.02},
        "gradient": ["kernel.tension"],
    }
    whole = pl.run(one, progress=False).dataset["force_by_kernel_tension"].item()
    for path in paths:
        value = data[f"force_by_{path.replace('.', '_')}"].item()
        assert value == pytest.approx(whole / 4, rel=1e-6)


class Stated(pl.Isotropic):
    """A layer of which half relaxes, and which states all that a kernel may."""

    type: Literal["stated"] = "stated"

    def compliance(self, q: Array) -> Array:
        """Return that of springs of 1 MPa/m in series with a half-space, E* = 1 kPa."""
        return 1e-6 / (1 + 5e-4 * q)

    def mean_compliance(self) -> float:
        return 1e-6

    def branches(self) -> tuple[Branch, ...]:
        return (Branch(0.5, 2.0),)

    def time_span(self) -> tuple[float, float]:
        return 0.1, 30.0

    def depth_to_base(self) -> float:
        return 3e-3


class Warm(KernelOf):
    """A kernel of a stranger on any other one, half as stiff, with a field of another name."""

    substrate_field = "body"
    type: Literal["warm"] = "warm"
    body: pl.Kernel

    def symbol(self, qx: Array, qy: Array) -> Array:
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
