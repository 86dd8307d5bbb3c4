"""The symbols of skins and springs against direct solutions of elasticity and their limits."""

import json
import pickle
from typing import Any

import numpy as np
import pytest
from scipy.linalg import null_space

import pellicle as pl
from pellicle.surface import mean_compliance

YOUNGS, TENSION, BENDING, SURFACE = 9e3, 0.5, 2e-10, 1.5
Q = np.geomspace(1.0, 1e9, 60)
LAYER = {
    "type": "bonded_layer",
    "youngs_modulus": YOUNGS,
    "poissons_ratio": 0.45,
    "thickness": 1e-4,
}


def kernel_of(table: dict[str, Any]) -> pl.Kernel:
    """Return the kernel that a table describes."""
    fields = dict(table)
    return pl.kernel(fields.pop("type"), **fields)


def gurtin_murdoch(poissons_ratio: float, **fields: float) -> pl.Kernel:
    """Return surface elasticity with the tension of the module, unless ``fields`` say otherwise."""
    given = {"surface_stiffness": SURFACE, "tension": TENSION} | fields
    return pl.kernel(
        "gurtin_murdoch", youngs_modulus=YOUNGS, poissons_ratio=poissons_ratio, **given
    )


def tensed_membrane(poissons_ratio: float, tension: float = TENSION) -> pl.Kernel:
    """Return the half-space whose surface has a tension only."""
    return pl.kernel(
        "tensed_membrane", youngs_modulus=YOUNGS, poissons_ratio=poissons_ratio, tension=tension
    )


def direct(nu: float, q: float, surface: float, tension: float, bending: float) -> float:
    """Return G(q) of an elastic surface on a half-space by plane elasticity.

    d(U, W, T, S)/dz = A (U, W, T, S) as for a layer; the solutions that fall with depth are those
    that (A + q)² takes to zero. The surface is in equilibrium with what acts on it from both sides:
    T = κ_s q² U along it, p + S = (τ₀ q² + B q⁴) W across it.
    """
    reduced = YOUNGS / (1 - nu**2)
    mu, share = reduced * (1 - nu) / 2, nu / (1 - nu)
    slack = (1 - 2 * nu) / (2 * mu * (1 - nu))
    # Lengths in 1/q and stresses in E*, so that A is divided by q.
    matrix = np.array(
        [
            [0, 1, reduced / mu, 0],
            [-share, 0, 0, slack * reduced],
            [1, 0, 0, share],
            [0, 0, -1, 0],
        ]
    )
    shifted = matrix + np.eye(4)
    falling = null_space(shifted @ shifted, rcond=1e-6)
    assert falling.shape == (4, 2)
    u, w, t, s = falling
    along = t - surface * q / reduced * u
    across = (tension * q + bending * q**3) / reduced * w - s
    a, b = np.linalg.solve([along, across], [0, 1 / reduced])
    return float(w @ [a, b]) / q


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.5])
@pytest.mark.parametrize(
    ("surface", "tension", "bending"),
    [(0.0, 0.0, 0.0), (SURFACE, 0.0, 0.0), (SURFACE, TENSION, 0.0), (SURFACE, TENSION, BENDING)],
)
def test_direct_elasticity(nu: float, surface: float, tension: float, bending: float) -> None:
    """The symbol is the solution of elasticity with the equilibrium of the surface above it."""
    kernel = gurtin_murdoch(nu, surface_stiffness=surface, tension=tension, bending=bending)
    for q in (1e2, 6e3, 4e5):
        expected = direct(nu, q, surface, tension, bending)
        assert kernel.compliance(np.array([q]))[0] == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize(("nu", "surface"), [(0.5, SURFACE), (0.5, 1e6), (0.3, 0.0), (-0.4, 0.0)])
def test_without_sideways_motion_or_stiffness_it_is_a_tensed_membrane(
    nu: float, surface: float
) -> None:
    """With ν = ½, or without surface stiffness, only the tension is left."""
    kernel = gurtin_murdoch(nu, surface_stiffness=surface)
    np.testing.assert_allclose(kernel.compliance(Q), tensed_membrane(nu).compliance(Q), rtol=1e-14)


def test_a_stiff_surface_holds_the_solid() -> None:
    """κ_s → ∞ is a surface that cannot move sideways: E* is 4(1 − ν)²/(3 − 4ν) times itself."""
    nu = 0.2
    stiff = gurtin_murdoch(nu, surface_stiffness=1e15, tension=0).compliance(Q)
    free = tensed_membrane(nu, tension=0).compliance(Q)
    np.testing.assert_allclose(free / stiff, 4 * (1 - nu) ** 2 / (3 - 4 * nu), rtol=1e-8)


def test_bending_carries_short_waves() -> None:
    """Far above q = (E*/2B)^⅓ it is the plate alone, G = 1/B q⁴; far below the solid."""
    skin = pl.kernel("bending_skin", reduced_modulus=1e4, bending=BENDING)
    crossover = (1e4 / (2 * BENDING)) ** (1 / 3)
    short, long = np.array([3e4 * crossover]), np.array([crossover / 3e4])
    assert skin.compliance(short)[0] == pytest.approx(1 / (BENDING * short[0] ** 4), rel=1e-13)
    assert skin.compliance(long)[0] == pytest.approx(2 / (1e4 * long[0]), rel=1e-13)


def test_coated_half_space_is_what_it_is_called() -> None:
    """On a half-space, a tension makes a tensed membrane, and bending a bending skin."""
    substrate = {"type": "half_space", "reduced_modulus": 1e4}
    for tension, bending in ((0.0, 0.0), (TENSION, 0.0), (TENSION, BENDING), (0.0, BENDING)):
        coated = pl.kernel("coated", tension=tension, bending=bending, substrate=substrate)
        skin = pl.kernel("bending_skin", reduced_modulus=1e4, tension=tension, bending=bending)
        np.testing.assert_allclose(coated.compliance(Q), skin.compliance(Q), rtol=1e-13)
        if not bending:
            membrane = pl.kernel("tensed_membrane", reduced_modulus=1e4, tension=tension)
            np.testing.assert_allclose(skin.compliance(Q), membrane.compliance(Q), rtol=1e-14)


def test_coats_add_up() -> None:
    """A skin on a skin has the sum of their stiffnesses; no skin changes nothing."""
    bare = kernel_of(LAYER)
    one = pl.kernel("coated", tension=0.3, bending=BENDING, substrate=LAYER)
    two = pl.kernel(
        "coated",
        tension=0.1,
        substrate={"type": "coated", "tension": 0.2, "bending": BENDING, "substrate": LAYER},
    )
    np.testing.assert_allclose(two.compliance(Q), one.compliance(Q), rtol=1e-13)
    none = pl.kernel("coated", substrate=LAYER)
    np.testing.assert_array_equal(none.compliance(Q), bare.compliance(Q))
    added = 1 / one.compliance(Q) - 1 / bare.compliance(Q)
    resolved = Q < 1e6
    np.testing.assert_allclose(
        added[resolved],
        (0.3 * Q**2 + BENDING * Q**4)[resolved],
        rtol=1e-6,
        atol=1e-6 * YOUNGS / 1e-4,
    )


def test_a_coat_is_not_felt_by_a_uniform_pressure() -> None:
    """The mean compliance is the substrate's, finite or not."""
    layer = kernel_of(LAYER)
    coated = pl.kernel("coated", tension=TENSION, substrate=LAYER)
    assert mean_compliance(coated) == mean_compliance(layer) > 0
    half_space = {"type": "half_space", "reduced_modulus": 1.0}
    membrane = pl.kernel("coated", tension=TENSION, substrate=half_space)
    assert mean_compliance(membrane) == np.inf


def test_coated_takes_its_substrate_in_any_form() -> None:
    """A table, a component or what was written into a result: one kernel, also for a worker."""
    by_table = pl.kernel("coated", tension="0.5 N/m", substrate=LAYER | {"thickness": "0.1 mm"})
    by_component = pl.kernel("coated", tension=0.5, substrate=kernel_of(LAYER))
    written = json.loads(by_table.model_dump_json(exclude_none=True))
    assert written["substrate"] == LAYER
    assert by_table == by_component == kernel_of(written)
    assert hash(by_table) == hash(pickle.loads(pickle.dumps(by_component)))
