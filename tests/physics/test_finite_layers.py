"""Contact on finite layers and on springs, whose limits are known in closed form."""

from typing import Any

import numpy as np
import pytest

import pellicle as pl
from tests import tables_of_runs as tables
from tests.tables_of_runs import half_space, paraboloid, relaxing, step, steps

# The equations are linear, so that loads may be convenient numbers.
pytestmark = pytest.mark.filterwarnings("ignore:.*to its rigid base")

YOUNGS, THICKNESS = 9e3, 5e-5
PERIODIC = {"points": [24, 20], "size": [1e-3, 0.8e-3], "boundary": "periodic"}
ROUGH = {"type": "self_affine", "rms_height": 5e-6, "hurst": 0.8, "cutoff_wavelength": 2e-4}


def layer(base: str, poissons_ratio: float, thickness: float = THICKNESS) -> dict[str, Any]:
    """Return the table of a layer."""
    return tables.layer(base, thickness, poissons_ratio, youngs_modulus=YOUNGS)


def wave_modulus(nu: float) -> float:
    """Return M = E(1 − ν)/((1 + ν)(1 − 2ν)) [Pa]."""
    return YOUNGS * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


@pytest.mark.parametrize("base", ["bonded_layer", "frictionless_layer"])
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_full_contact_compresses_a_layer_by_uniaxial_strain(
    base: str, nu: float, solver: str
) -> None:
    """Beyond full contact each further step of mean pressure sinks the indenter by h/M times it."""
    pressures = np.array([4.0, 5.0, 7.0]) * wave_modulus(nu) * 2e-5 / THICKNESS
    result = steps(
        solver,
        grid=PERIODIC,
        kernel=layer(base, nu),
        indenter=ROUGH,
        loading={"mean_pressure": list(pressures)},
    )
    assert result["contact"].all()
    rise = np.diff(result["depth"].values) / np.diff(pressures)
    np.testing.assert_allclose(rise, THICKNESS / wave_modulus(nu), rtol=1e-6)


@pytest.mark.filterwarnings("ignore:.*too coarse for this contact")
def test_a_depth_on_a_layer_counts_from_first_touch(solver: str) -> None:
    """Prescribed depths start at 0, go past full contact, and belong to the pressures they make."""
    depths, base = [1e-7, 1e-5, 4e-5], {"grid": PERIODIC, "indenter": ROUGH}
    base["kernel"] = layer("bonded_layer", 0.3)
    light, middle, deep = (step(solver, **base, loading={"depth": depth}) for depth in depths)
    # The lightest touch is on one cell or few; the deepest is beyond the mean plane.
    assert light["contact_fraction"] < 0.02
    assert deep["contact"].all()
    again = step(solver, **base, loading={"mean_pressure": float(middle["mean_pressure"])})
    assert float(again["depth"]) == pytest.approx(depths[1], rel=1e-6)


@pytest.mark.parametrize("boundary", ["free", "periodic"])
def test_a_paraboloid_on_springs(boundary: str, solver: str) -> None:
    """The pressure is k times the overlap in each cell, the force π k R δ² (Johnson 1985, 4.3)."""
    k, radius, depth = 1e8, 1e-3, 2e-5
    pressed = step(
        solver,
        grid={"points": 96, "size": 6e-4, "boundary": boundary},
        kernel={"type": "winkler", "foundation": k},
        indenter=paraboloid(radius),
        loading={"depth": depth},
    )
    x, y = pressed["x"].values[:, None], pressed["y"].values[None]
    overlap = np.maximum(depth - (x**2 + y**2) / (2 * radius), 0)
    np.testing.assert_allclose(pressed["pressure"].values, k * overlap, atol=1e-6 * k * depth)
    assert float(pressed["force"]) == pytest.approx(np.pi * k * radius * depth**2, rel=1e-3)


@pytest.mark.parametrize("nu", [0.3, 0.45])
def test_a_thin_layer_under_a_paraboloid_is_springs(nu: float) -> None:
    """Its force is that of springs M/h, less 2c h²/Rδ of it, where G = (h/M)(1 + c(qh)² + …).

    The elastic energy of a given displacement changes by −½ c h² (h/M) ∫ |∇p|² to first order.
    """
    radius, depth, h = 1e-3, 1e-5, 4e-6
    pressed = step(
        grid={"points": 192, "size": 3.6e-4, "boundary": "periodic"},
        kernel=layer("bonded_layer", nu, h),
        indenter=paraboloid(radius),
        loading={"depth": depth},
    )
    springs = np.pi * wave_modulus(nu) / h * radius * depth**2
    c = (3 - 4 * nu) / (3 * (1 - 2 * nu)) - 1 / (1 - nu)
    softer = 2 * c * h**2 / (radius * depth)
    assert 1 - float(pressed["force"]) / springs == pytest.approx(softer, rel=0.1)


@pytest.mark.parametrize("base", ["bonded_layer", "frictionless_layer"])
@pytest.mark.parametrize("nu", [0.3, 0.5])
def test_a_thick_layer_on_a_free_boundary_is_a_half_space(base: str, nu: float) -> None:
    """The base is felt as a uniform shift that falls as 1/h, less than 1e-6 from h = 1000 L on."""
    grid = pl.Grid(points=[32, 24], size=1e-3)
    pressure = np.random.default_rng(0).uniform(size=grid.shape)
    bare = pl.kernel("half_space", reduced_modulus=1e4)
    known = pl.displacement(pressure, kernel=bare, grid=grid)
    apart = []
    for h in (1.0, 10.0):
        kernel = pl.kernel(base, reduced_modulus=1e4, poissons_ratio=nu, thickness=h)
        result = pl.displacement(pressure, kernel=kernel, grid=grid)
        apart.append(np.abs(result - known) / known.max())
    np.testing.assert_allclose(apart[0], apart[0].mean(), rtol=1e-3)
    assert apart[0].max() / apart[1].max() == pytest.approx(10, rel=1e-3)
    far = pl.kernel(base, reduced_modulus=1e4, poissons_ratio=nu, thickness=1e3)
    np.testing.assert_allclose(
        pl.displacement(pressure, kernel=far, grid=grid), known, rtol=0, atol=1e-6 * known.max()
    )


@pytest.mark.parametrize(("nu", "slope"), [(0.3, 0.8806), (0.5, 1.1329)])
def test_a_paraboloid_feels_a_distant_base_as_published(nu: float, slope: float) -> None:
    """F over that on the half-space grows as 1 + 2|α₀|χ/π, χ = √(Rδ)/h (Dimitriadis et al. 2002).

    Their α₀ = −(1.2876 − 1.4678ν + 1.3442ν²)/(1 − ν) of a bonded layer is a fit in ν.
    """
    radius, depth = 1e-3, 1e-5
    problem = {
        "grid": {"points": 96, "size": 2.4e-4},
        "indenter": paraboloid(radius),
        "loading": {"depth": depth},
    }
    bare = float(step(kernel=half_space(YOUNGS / (1 - nu**2)), **problem)["force"])
    excess = []
    for chi in (0.01, 0.02):
        kernel = layer("bonded_layer", nu, np.sqrt(radius * depth) / chi)
        excess.append((float(step(kernel=kernel, **problem)["force"]) / bare - 1) / chi)
    assert 2 * excess[0] - excess[1] == pytest.approx(slope, rel=0.01)


def test_a_paraboloid_on_a_thin_incompressible_layer_is_on_a_film() -> None:
    """As h falls F comes near 2πμR²δ³/h³ and a near 2 √(Rδ), twice Hertz's (lubrication)."""
    radius, depth = 1e-3, 1e-5
    reach = np.sqrt(radius * depth)
    ratios, radii = [], []
    for h in (0.1 * reach, 0.2 * reach):
        pressed = step(
            grid={"points": 128, "size": 4.8 * reach},
            kernel=layer("bonded_layer", 0.5, h),
            indenter=paraboloid(radius),
            loading={"depth": depth},
        )
        film = 2 * np.pi * YOUNGS / 3 * radius**2 * depth**3 / h**3
        ratios.append(float(pressed["force"]) / film)
        radii.append(float(pressed["contact_radius"]) / (2 * reach))
    # Measured: the force is off by the order of (h/a)², the radius by that of h/a.
    assert (4 * ratios[0] - ratios[1]) / 3 == pytest.approx(1, abs=0.01)
    assert 2 * radii[0] - radii[1] == pytest.approx(1, abs=0.02)
    assert abs(ratios[0] - 1) < 0.05


@pytest.mark.parametrize("relaxes", [False, True])
def test_a_layer_far_thicker_than_the_period_is_a_half_space(relaxes: bool, solver: str) -> None:
    """Its mean plane sinks by 1e4 times the heights, which must not make their gaps negligible."""
    nu, time = 0.2, {"time": [0.0, 1.0]} if relaxes else {}
    pressures = []
    for solid in (half_space(YOUNGS / (1 - nu**2)), layer("bonded_layer", nu, 10.0)):
        result = steps(
            solver,
            grid=PERIODIC,
            kernel=relaxing(solid, 0.5, 1.0) if relaxes else solid,
            indenter=ROUGH,
            loading={"mean_pressure": [50.0, 50.0] if relaxes else 50.0, **time},
        )
        pressures.append(result["pressure"].values)
    np.testing.assert_allclose(pressures[1], pressures[0], atol=3e-5 * pressures[0].max())
