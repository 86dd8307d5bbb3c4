"""Layers: their compliance against decimal arithmetic and published values, and their table."""

import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import pellicle as pl
from pellicle.surface import mean_compliance
from tests.plugins.kernels.elastic_stack import HalfSpace, Layer, stack_compliance

RATIOS = [-0.99, -0.5, 0.0, 0.3, 0.49, 0.4999999, 0.5]
SOFT, THIN = 1e4, 1e-5


def layered(layers: Sequence[Layer], substrate: HalfSpace | None = None) -> pl.Kernel:
    """Return the kernel of layers from the surface down; the base is rigid if not given."""
    return pl.kernel(
        "layered",
        layers=[layer._asdict() for layer in layers],
        substrate="rigid" if substrate is None else substrate._asdict(),
    )


def stack(rng: np.random.Generator) -> tuple[list[Layer], HalfSpace | None]:
    """Return up to five layers of any moduli, Poisson's ratios and thicknesses."""
    moduli = 10 ** rng.uniform(-2, 10, 6)
    ratios = rng.choice(RATIOS, 6)
    heights = 10 ** rng.uniform(-9, -3, 6)
    number = rng.integers(1, 6)
    layers = [Layer(*map(float, row)) for row in zip(moduli, ratios, heights, strict=True)]
    below = HalfSpace(*layers[-1][:2]) if rng.random() < 0.6 else None
    return layers[:number], below


@pytest.mark.parametrize("seed", range(8))
def test_every_digit_agrees_with_decimal_arithmetic(seed: int) -> None:
    """Any stack, contrasts up to 10¹², has the compliance of the transfer matrices to 1e-14."""
    rng = np.random.default_rng(seed)
    for _ in range(20):
        layers, below = stack(rng)
        q = 10 ** rng.uniform(-3, 6, 2)
        expected = [stack_compliance(layers, below, float(wavenumber)) for wavenumber in q]
        np.testing.assert_allclose(layered(layers, below).compliance(q), expected, rtol=1e-14)


@pytest.mark.parametrize("contrast", [1e-2, 0.5, 3.0, 1e3])
@pytest.mark.parametrize("first", RATIOS[1:])
def test_the_formula_of_one_layer_on_a_half_space(first: float, contrast: float) -> None:
    """It is the closed form of Li, Pohrt, Lyashenko & Popov (2020), where that keeps its digits."""
    x = np.geomspace(0.3, 10, 12)
    two, four = np.exp(-2 * x), np.exp(-4 * x)
    for second in RATIOS[1:]:
        up, down = contrast * (1 + first), 1 + second
        k1, k2 = 3 - 4 * first, 3 - 4 * second
        a = (up * k1 - down * k2) * (down - up)
        b = 4 * (up + down * k2) * (down - up)
        c = (
            -(down**2) * k2
            - 2 * up * down * (2 * first - 1) * (2 * second - 1)
            + up**2 * (8 * first**2 - 12 * first + 5)
        )
        d = (up + down * k2) * (up * k1 + down)
        stiffness = (-a * four - b * x**2 * two + 2 * c * two + d) / (a * four + b * x * two + d)
        kernel = layered([Layer(1.0, first, 1.0)], HalfSpace(contrast, second))
        expected = 2 * (1 - first**2) / (x * stiffness)
        np.testing.assert_allclose(kernel.compliance(x), expected, rtol=1e-11)


@pytest.mark.parametrize("nu", RATIOS)
def test_one_layer_on_a_rigid_base_is_a_bonded_layer(nu: float) -> None:
    """From qh = 1e-12 to 1e6 it has the compliance of its closed form, to 1e-13."""
    q = np.geomspace(1e-12, 1e6, 400) / THIN
    layer = Layer(SOFT, nu, THIN)
    bonded = pl.kernel("bonded_layer", **layer._asdict())
    np.testing.assert_allclose(layered([layer]).compliance(q), bonded.compliance(q), rtol=1e-13)
    assert mean_compliance(layered([layer])) == pytest.approx(mean_compliance(bonded), rel=1e-15)


@pytest.mark.parametrize("nu", RATIOS)
def test_layers_of_the_substrate_are_a_half_space(nu: float) -> None:
    """Three layers of the solid on which they lie are that solid, to 1e-13, for any wave."""
    q = np.geomspace(1e-12, 1e6, 400) / THIN
    solid = HalfSpace(SOFT, nu)
    kernel = layered([Layer(*solid, h * THIN) for h in (0.1, 1.0, 7.0)], solid)
    half_space = pl.kernel("half_space", **solid._asdict())
    np.testing.assert_allclose(kernel.compliance(q), half_space.compliance(q), rtol=1e-13)


@pytest.mark.parametrize("nu", RATIOS)
@pytest.mark.parametrize("below", [None, HalfSpace(1e-6 * SOFT, 0.1), HalfSpace(1e6 * SOFT, 0.5)])
def test_equal_layers_merge(nu: float, below: HalfSpace | None) -> None:
    """Cut into three, a layer between others keeps its compliance to 1e-13."""
    q = np.geomspace(1e-9, 1e4, 300) / THIN
    top, bottom = Layer(30 * SOFT, 0.2, THIN / 3), Layer(0.1 * SOFT, 0.5, THIN)
    whole = layered([top, Layer(SOFT, nu, THIN), bottom], below)
    parts = [Layer(SOFT, nu, share * THIN) for share in (0.5, 0.125, 0.375)]
    cut = layered([top, *parts, bottom], below)
    np.testing.assert_allclose(cut.compliance(q), whole.compliance(q), rtol=1e-13)


def test_short_waves_feel_the_uppermost_layer_and_long_ones_the_substrate() -> None:
    """Layers count from the surface down."""
    layers = [Layer(SOFT, 0.5, THIN), Layer(50 * SOFT, 0.3, THIN)]
    kernel = layered(layers, HalfSpace(3 * SOFT, 0.4))
    short, long = 25 / THIN, 1e-12 / THIN
    assert kernel.compliance(np.array([short]))[0] == pytest.approx(2 * 0.75 / (SOFT * short))
    substrate = pl.kernel("half_space", youngs_modulus=3 * SOFT, poissons_ratio=0.4)
    expected = substrate.compliance(np.array([long]))[0]
    assert kernel.compliance(np.array([long]))[0] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("contrast", [1e-6, 1e-2, 1e3, 1e6])
def test_thin_incompressible_layers_on_a_rigid_base_are_films(contrast: float) -> None:
    """For qh → 0 it is lubrication, G = q² ∫ (H − z)²/μ dz, z from the base, to every digit."""
    top, bottom = Layer(SOFT, 0.5, 3 * THIN), Layer(contrast * SOFT, 0.5, THIN)
    softness = (3**3 + (4**3 - 3**3) / contrast) * THIN**3 / (3 * SOFT / 3)
    q = np.geomspace(1e-16, 1e-12, 9) / THIN
    value = layered([top, bottom]).compliance(q)
    np.testing.assert_allclose(value, softness * q**2, rtol=1e-11)
    assert mean_compliance(layered([top, bottom])) == 0


def test_a_thin_stiff_layer_is_a_plate() -> None:
    """A film 10⁹ times as stiff as its substrate adds B q⁴ to it, B = E* h³/12, less O(qh)."""
    film, below = Layer(1e9 * SOFT, 0.3, THIN), HalfSpace(SOFT, 0.5)
    q = np.array([5e-4, 1e-3, 2e-3]) / THIN
    rigidity = 1e9 * SOFT / (1 - 0.3**2) * THIN**3 / 12
    plate = pl.kernel("bending_skin", bending=rigidity, **below._asdict())
    apart = layered([film], below).compliance(q) / plate.compliance(q) - 1
    assert (np.abs(apart) < q * THIN).all()


def test_mean_compliance_adds_up_uniaxial_strains() -> None:
    """On a rigid base it is Σ h/M, the limit of long waves too; on a half-space it is infinite."""
    layers = [Layer(SOFT, 0.3, THIN), Layer(7 * SOFT, 0.5, THIN), Layer(2 * SOFT, -0.4, 2 * THIN)]
    expected = sum(h * (1 + nu) * (1 - 2 * nu) / (modulus * (1 - nu)) for modulus, nu, h in layers)
    assert mean_compliance(layered(layers)) == pytest.approx(expected, rel=1e-14)
    long = layered(layers).compliance(np.array([1e-9 / THIN]))[0]
    assert long == pytest.approx(expected, rel=1e-12)
    assert mean_compliance(layered(layers, HalfSpace(1e6 * SOFT, 0.5))) == np.inf


def test_waves_of_any_length_neither_overflow_nor_vanish() -> None:
    """From qh = 1e-40 to 1e200 every compliance is positive, and falls or tends to its limit."""
    layers = [Layer(SOFT, 0.5, THIN), Layer(1e-6 * SOFT, 0.3, THIN), Layer(1e6 * SOFT, 0.5, THIN)]
    q = np.geomspace(1e-40, 1e200, 500) / THIN
    for below in (None, HalfSpace(1e-6 * SOFT, 0.5), HalfSpace(1e6 * SOFT, 0.0)):
        value = layered(layers, below).compliance(q)
        assert np.isfinite(value).all()
        assert (value > 0).all()
        short = q > 25 / THIN
        np.testing.assert_allclose(value[short], 1.5 / (SOFT * q[short]), rtol=1e-12)


def test_blocks_of_wavenumbers_do_not_show() -> None:
    """A large array, of any shape and order of memory, has the values of its elements."""
    kernel = layered([Layer(SOFT, 0.5, THIN), Layer(3 * SOFT, 0.3, THIN)])
    q = np.geomspace(1e-3, 1e3, 30_000).reshape(100, 300).T / THIN
    value = kernel.compliance(q)
    assert value.shape == q.shape
    np.testing.assert_allclose(value[7], kernel.compliance(q[7]), rtol=1e-15)


def test_moduli_at_the_end_of_the_range_scale() -> None:
    """On a rigid base only the product G E matters, also where powers of E overflow."""
    q = np.geomspace(1e-3, 1e3, 30) / THIN
    soft, stiff = (
        layered([Layer(2 * modulus, 0.5, THIN), Layer(modulus, 0.3, THIN)]).compliance(q) * modulus
        for modulus in (1.0, 1e99)
    )
    np.testing.assert_allclose(stiff, soft, rtol=1e-13)


TOML = """
[grid]
points = 16
size = "0.4 mm"
[kernel]
type = "layered"
layers = [
    { youngs_modulus = "1 MPa", poissons_ratio = 0.3, thickness = "5 um" },
    { reduced_modulus = "10 kPa", poissons_ratio = 0.5, thickness = "0.1 mm" },
]
substrate = { youngs_modulus = "3 kPa", poissons_ratio = 0.4 }
[indenter]
type = "paraboloid"
radius = "1 mm"
[loading]
depth = "10 um"
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Return the file of a run on two layers."""
    path = tmp_path / "layers.toml"
    path.write_text(TOML, encoding="utf-8")
    return path


def changed(file: Path, *changes: str) -> dict[str, Any]:
    """Return the table of the kernel after changes as by ``--set``."""
    table: dict[str, Any] = pl.Run.from_toml(file, changes).kernel.model_dump(exclude_none=True)
    return table


def test_nested_values_are_in_si(file: Path) -> None:
    """Units are converted in layers and substrate; either modulus may be given."""
    first, second = changed(file)["layers"]
    assert first == {"youngs_modulus": 1e6, "poissons_ratio": 0.3, "thickness": 5e-6}
    assert second == {"reduced_modulus": 1e4, "poissons_ratio": 0.5, "thickness": 1e-4}
    assert changed(file)["substrate"] == {"youngs_modulus": 3e3, "poissons_ratio": 0.4}


def test_nested_fields_can_be_set(file: Path) -> None:
    """Layers count from 0, and the substrate can be replaced as a whole."""
    assert changed(file, 'kernel.layers.1.thickness="2 mm"')["layers"][1]["thickness"] == 2e-3
    assert changed(file, 'kernel.substrate.youngs_modulus="1 GPa"')["substrate"] == {
        "youngs_modulus": 1e9,
        "poissons_ratio": 0.4,
    }
    assert changed(file, "kernel.substrate=rigid")["substrate"] == "rigid"


def test_a_study_varies_a_nested_field(file: Path) -> None:
    """An axis may be a field of one layer, which the run then may leave out."""
    data = tomllib.loads(TOML)
    del data["kernel"]["layers"][0]["thickness"]
    axis = {"kernel.layers.0.thickness": ["1 um", "10 um"]}
    study = data | {"study": {"vary": axis}}
    tables = [point.run.kernel.model_dump() for point in pl.Study.from_mapping(study).points]
    assert [table["layers"][0]["thickness"] for table in tables] == [1e-6, 1e-5]
    schema = Draft202012Validator(pl.json_schema())
    schema.validate(study)
    assert not schema.is_valid(data)


@pytest.mark.parametrize(
    ("path", "value", "valid"),
    [
        ("substrate", "rigid", True),
        ("substrate", "stiff", False),
        ("substrate", {"reduced_modulus": "1 kPa", "poissons_ratio": 0.2}, True),
        ("substrate", {"reduced_modulus": "1 kPa"}, False),
        ("layers", [], False),
        ("layers", [{"youngs_modulus": 1, "poissons_ratio": 0.1, "thickness": 0}], False),
        ("layers", [{"youngs_modulus": 1, "poissons_ratio": 0.1, "thickness": 1}], True),
    ],
)
def test_the_schema_knows_the_nested_table(path: str, value: Any, valid: bool) -> None:
    """An editor marks what a run refuses."""
    data = tomllib.loads(TOML)
    data["kernel"][path] = value
    assert Draft202012Validator(pl.json_schema()).is_valid(data) == valid
