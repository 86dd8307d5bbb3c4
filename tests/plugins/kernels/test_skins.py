"""The symbols of skins, springs and finite layers against direct solutions of elasticity."""

import json
import pickle
from decimal import Decimal
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import expm, null_space

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


MODULUS, THICKNESS = 3e4, 2e-4
RATIOS = [-0.5, 0.0, 0.3, 0.49, 0.5]
Base = Literal["bonded_layer", "frictionless_layer"]
LAYERS: list[Base] = ["bonded_layer", "frictionless_layer"]


def layer(base: Base, poissons_ratio: float = 0.3, **fields: Any) -> pl.Kernel:
    """Return a layer of the module's E* and thickness, unless ``fields`` say otherwise."""
    given = {"reduced_modulus": MODULUS, "thickness": THICKNESS} | fields
    return pl.kernel(base, poissons_ratio=poissons_ratio, **given)


def half_space(q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return G(q) of the solid without a base."""
    return pl.kernel("half_space", reduced_modulus=MODULUS).compliance(q)


def direct_of_layer(base: Base, nu: float, x: float) -> float:
    """Return G of a layer by plane elasticity, for the wavenumber q = x/h.

    u_x = U sin qx, u_z = W cos qx, σ_xz = T sin qx, σ_zz = S cos qx, z down into the solid. Hooke's
    law and equilibrium are d(U, W, T, S)/dz = A (U, W, T, S), written in 1/(λ + 2μ) and ν/(1 − ν),
    which are finite for ν = ½. Four conditions: T = 0, S = −1 above, those of the base below.
    """
    q = x / THICKNESS
    mu = MODULUS * (1 - nu) / 2
    share = nu / (1 - nu)
    slack = (1 - 2 * nu) / (2 * mu * (1 - nu))
    matrix = np.array(
        [
            [0, q, 1 / mu, 0],
            [-share * q, 0, 0, slack],
            [MODULUS * q**2, 0, 0, share * q],
            [0, 0, -q, 0],
        ]
    )
    # Lengths in h and stresses in E* make the numbers of one size.
    units = np.diag([THICKNESS, THICKNESS, MODULUS, MODULUS])
    through = expm(np.linalg.inv(units) @ matrix @ units * THICKNESS)
    fixed = [0, 1] if base == "bonded_layer" else [1, 2]
    conditions = np.vstack([[0, 0, 1, 0], [0, 0, 0, 1], through[fixed]])
    surface = units @ np.linalg.solve(conditions, [0, -1 / MODULUS, 0, 0])
    return float(surface[1])


@pytest.mark.parametrize("nu", RATIOS)
@pytest.mark.parametrize("base", LAYERS)
@pytest.mark.parametrize("x", [0.02, 0.3, 0.99, 1.01, 3.0])
def test_direct_elasticity_of_layers(base: Base, nu: float, x: float) -> None:
    """The symbol is the solution of Hooke's law and equilibrium with its four conditions."""
    value = layer(base, nu).compliance(np.array([x / THICKNESS]))[0]
    assert value == pytest.approx(direct_of_layer(base, nu, x), rel=1e-9)


@pytest.mark.parametrize("nu", RATIOS)
@pytest.mark.parametrize("base", LAYERS)
def test_a_thick_layer_is_a_half_space(base: Base, nu: float) -> None:
    """From qh = 20 on the base is not felt to 1e-12, and nothing overflows up to qh = 1e200."""
    q = np.geomspace(20, 1e200, 50) / THICKNESS
    with np.errstate(all="raise"):
        value = layer(base, nu).compliance(q)
    np.testing.assert_allclose(value, half_space(q), rtol=1e-12)


@pytest.mark.parametrize("nu", [-0.5, 0.0, 0.3, 0.49])
def test_a_thin_compressible_bonded_layer_is_springs(nu: float) -> None:
    """For qh → 0 the stiffness is M/h, M the P-wave modulus, with the next term (qh)²."""
    wave_modulus = MODULUS * (1 - nu**2) * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    springs = pl.kernel("winkler", foundation=wave_modulus / THICKNESS)
    x = np.array([1e-8, 1e-3, 2e-3])
    q = x / THICKNESS
    excess = layer("bonded_layer", nu).compliance(q) / springs.compliance(q) - 1
    term = (3 - 4 * nu) / (3 * (1 - 2 * nu)) - 1 / (1 - nu)
    np.testing.assert_allclose(excess, term * x**2, rtol=2e-3, atol=1e-11)


def test_a_thin_incompressible_bonded_layer_is_a_film() -> None:
    """For qh → 0 and ν = ½ it is lubrication: G = h³q²/3μ with μ = E*/4, to every digit."""
    q = np.geomspace(1e-12, 1e-8, 9) / THICKNESS
    film = THICKNESS**3 * q**2 / (3 * MODULUS / 4)
    value = layer("bonded_layer", 0.5).compliance(q)
    np.testing.assert_allclose(value, film, rtol=4e-15)


@pytest.mark.parametrize("nu", RATIOS)
def test_a_thin_frictionless_layer_is_springs(nu: float) -> None:
    """For qh → 0 the stiffness is E*/h whatever ν is, and the next term is (qh)⁴/45."""
    springs = pl.kernel("winkler", foundation=MODULUS / THICKNESS)
    x = np.array([1e-12, 1e-9, 0.05, 0.1])
    q = x / THICKNESS
    deficit = 1 - layer("frictionless_layer", nu).compliance(q) / springs.compliance(q)
    np.testing.assert_allclose(deficit, x**4 / 45, rtol=1e-2, atol=1e-14)


@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_small_wavenumbers_keep_every_digit(nu: float) -> None:
    """Either side of the split of the series the compliance agrees with decimal arithmetic."""
    for x in (1e-5, 0.03, 0.999, 1.0, 1.001, 4.0):
        d, ratio = Decimal(x), Decimal(nu)
        kappa = 3 - 4 * ratio
        up, down = (2 * d).exp(), (-2 * d).exp()
        above = kappa * (up - down) / 2 - 2 * d
        below = kappa * (up + down) / 2 + 2 * d * d + 5 - 12 * ratio + 8 * ratio**2
        expected = float(above / below / d) * 2 * THICKNESS / MODULUS
        value = layer("bonded_layer", nu).compliance(np.array([x / THICKNESS]))[0]
        assert value == pytest.approx(expected, rel=3e-15)


@pytest.mark.parametrize("base", LAYERS)
def test_mean_compliance_is_uniaxial_strain(base: Base) -> None:
    """It is h/M, M = E(1 − ν)/((1 + ν)(1 − 2ν)); nothing compresses an incompressible layer."""
    youngs, nu = 9e3, 0.3
    kernel = pl.kernel(base, youngs_modulus=youngs, poissons_ratio=nu, thickness=THICKNESS)
    wave_modulus = youngs * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    assert mean_compliance(kernel) == pytest.approx(THICKNESS / wave_modulus, rel=1e-14)
    assert mean_compliance(layer(base, 0.5)) == 0


@pytest.mark.parametrize("base", LAYERS)
def test_the_modulus_is_given_once(base: Base) -> None:
    """E and E* say the same with ν."""
    nu, q = 0.2, np.geomspace(1e2, 1e6, 9)
    by_youngs = pl.kernel(
        base, youngs_modulus=MODULUS * (1 - nu**2), poissons_ratio=nu, thickness=THICKNESS
    )
    np.testing.assert_allclose(by_youngs.compliance(q), layer(base, nu).compliance(q), rtol=1e-14)


@pytest.mark.parametrize("ratio", [0.49999999, 0.4999999999, 0.5])
@pytest.mark.parametrize("width", [200, 1e5])
@pytest.mark.parametrize("tension", [0.0, 10.0])
def test_cells_much_wider_than_a_layer_are_what_is_wrong(
    tension: float, width: float, ratio: float
) -> None:
    """Nobody is told to smooth a kernel that is ours."""
    layer = {"type": "bonded_layer", "reduced_modulus": 1e4, "poissons_ratio": ratio}
    coated = pl.kernel("coated", substrate=layer | {"thickness": 1e-3}, tension=tension)
    grid = pl.Grid(points=16, size=16 * width * 1e-3, boundary="free")
    with pytest.raises(pl.ConfigError, match="times as wide as the layer is thick") as raised:
        pl.displacement(np.ones(grid.shape), kernel=coated, grid=grid)
    assert raised.value.problems[0].field == "grid.points"
