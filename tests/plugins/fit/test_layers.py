"""Fits of curves on a layer that is bonded to a rigid base, of known or of free thickness."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import Result
from numpy.typing import NDArray

import pellicle as pl
from pellicle_fit.config import FitConfig
from pellicle_fit.models import simulation
from pellicle_fit.models.layer import LayerModel
from pellicle_fit.models.simulation import Simulation
from pellicle_fit.one_curve import fit_problem
from pellicle_fit.problem import FitProblem, problems
from pellicle_fit.statistics.design import _designs
from tests.plugins.fit.conftest import holds

pytestmark = pytest.mark.usefixtures("no_rivals")

Array = NDArray[np.float64]
Cli = Callable[..., Result]
TRUE_MODULUS, TRUE_TENSION, THICK, RATIO, RADIUS = 3e3, 2e-3, 4e-6, 0.5, 5e-6
BEAD: dict[str, Any] = {"indenter": "sphere", "radius": RADIUS, "poissons_ratio": RATIO}
LAYER = {"type": "bonded_layer", "thickness": THICK, "poissons_ratio": RATIO}


def curve(
    *,
    seed: int = 1,
    thickness: float = THICK,
    tension: float = TRUE_TENSION,
    radius: float = RADIUS,
) -> tuple[Array, Array]:
    """Return position and force of a bead on a layer, with 0.3 % noise."""
    depth = np.linspace(-0.8e-6, 1.2e-6, 250)
    bead = pl.indenter("sphere", radius=radius)
    assert isinstance(bead, pl.HasLayerForceCurve)
    length = 2 * tension / TRUE_MODULUS
    force = TRUE_MODULUS * bead.layer_force_curve(depth, length, thickness, RATIO).force
    noise = np.random.default_rng(seed).standard_normal(depth.size)
    return depth + 7e-6, force + 0.003 * force.max() * noise


@pytest.fixture(autouse=True)
def no_study(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no fit run a study."""
    monkeypatch.setattr(simulation, "run_study", None)


def test_of_given_thickness() -> None:
    """Modulus and tension are recovered, and the result says how thick the layer was."""
    fit = pl.fit(*curve(), thickness=f"{THICK * 1e6} um", **BEAD)
    assert holds(fit.reduced_modulus, TRUE_MODULUS)
    assert holds(fit.tension, TRUE_TENSION)
    assert not fit.failed_checks
    result = fit.to_dict()
    assert result["thickness"] == {
        "value": THICK,
        "low": THICK,
        "high": THICK,
        "unit": "m",
        "bound": 0.0,
        "held": True,
    }
    assert result["configuration"]["thickness"] == THICK
    assert result["model"]["kernel"] == {"type": "coated", "substrate": LAYER}


@pytest.mark.slow
def test_of_free_thickness() -> None:
    """The thickness is a parameter like others; without it the curve tells less of the modulus."""
    fit = pl.fit(*curve(), thickness="free", **BEAD)
    given = pl.fit(*curve(), thickness=THICK, **BEAD)
    assert holds(fit.reduced_modulus, TRUE_MODULUS)
    assert holds(fit.tension, TRUE_TENSION)
    assert holds(fit.thickness, THICK)
    assert fit.thickness is not None
    assert not fit.thickness.held
    assert fit.reduced_modulus.bound > 1.5 * given.reduced_modulus.bound
    again = pl.fit(config=fit.config, position=curve()[0], force=curve()[1])
    assert again.estimates() == fit.estimates()


def test_a_half_space_has_no_upper_bound_of_thickness() -> None:
    """A curve of a half-space gives a least thickness and leaves the upper end open."""
    fit = pl.fit(*curve(thickness=1.0, tension=0.0), thickness="free", fix={"tension": 0}, **BEAD)
    assert fit.thickness is not None
    assert fit.thickness.high is None
    assert fit.thickness.low is not None
    assert fit.thickness.low > THICK


def test_a_kernel_of_a_bonded_layer_is_the_same_fit() -> None:
    """A bonded layer under a skin is fitted at once, with its own Poisson's ratio."""
    options: dict[str, Any] = {"indenter": "sphere", "radius": RADIUS}
    fit = pl.fit(*curve(), kernel={"type": "coated", "substrate": LAYER}, **options)
    given = pl.fit(*curve(), thickness=THICK, **BEAD)
    assert fit.reduced_modulus == given.reduced_modulus
    assert fit.youngs_modulus == given.youngs_modulus


def test_the_layer_is_simulated_where_it_has_no_curve() -> None:
    """Other shapes, negative ratios, and punches too wide for the table need a study."""

    def model(**options: Any) -> object:
        config = FitConfig.merged(None, poissons_ratio=0.3, thickness=THICK, **options)
        return config.force_model({})

    assert isinstance(model(indenter="sphere", radius=RADIUS), LayerModel)
    assert isinstance(model(indenter="flat_punch", radius=9 * THICK), LayerModel)
    for simulated in (
        model(indenter="flat_punch", radius=11 * THICK),
        model(indenter="quadric", radius_x=RADIUS, radius_y=2 * RADIUS),
    ):
        assert isinstance(simulated, Simulation)
        assert simulated.solid.table["substrate"]["thickness"] == THICK
    auxetic = LAYER | {"poissons_ratio": -0.1}
    skin = {"type": "coated", "substrate": auxetic}
    assert isinstance(
        FitConfig.merged(None, indenter="sphere", radius=1.0, kernel=skin).force_model({}),
        Simulation,
    )
    bent = {"type": "coated", "substrate": LAYER, "bending": 1e-18}
    assert isinstance(
        FitConfig.merged(None, indenter="sphere", radius=1.0, kernel=bent).force_model({}),
        Simulation,
    )


@pytest.mark.slow
def test_several_curves_share_the_thickness() -> None:
    """A pool of beads of two radii determines the thickness better than either."""
    radii = [RADIUS, 3 * RADIUS]
    curves = {str(n): curve(seed=n, radius=radius) for n, radius in enumerate(radii)}
    fit = pl.fit_pooled(
        curves, indenter="sphere", radius=radii, poissons_ratio=RATIO, thickness="free"
    )
    assert holds(fit.thickness, THICK)
    assert holds(fit.reduced_modulus, TRUE_MODULUS)
    single = pl.fit(*curves["0"], thickness="free", **BEAD)
    assert fit.thickness is not None
    assert single.thickness is not None
    assert fit.thickness.bound < single.thickness.bound


@pytest.mark.slow
def test_on_the_command_line(cli: Cli) -> None:
    """``--thickness`` is all it takes; tables and the page have the thickness."""
    position, force = curve()
    columns = np.column_stack([position * 1e6, force * 1e9])
    for name in ("one.csv", "two.csv"):
        np.savetxt(name, columns, delimiter=",", header="position [um],force [nN]", comments="")
    options = ("-i", "sphere", "--radius", "5 um", "--poissons-ratio", "0.5")
    output = cli("one.csv", *options, "--thickness", "4 um").output
    assert re.search(r"thickness\s+4(\.0*)?\s+fixed\s+µm", output)
    arguments = "--thickness", "free", "-o", "many", "--report"
    assert "thickness" in cli("one.csv", "two.csv", *options, *arguments).output
    assert "thickness" in Path("many/fits.html").read_text(encoding="utf-8")
    rows = json.loads(Path("many/fits.json").read_text(encoding="utf-8"))["curves"]
    assert rows[0]["thickness"]["low"] < THICK < rows[0]["thickness"]["high"]
    with Path("many/fits.csv").open(encoding="utf-8") as file:
        row = next(csv.DictReader(file))
    for column, key in (("thickness [m]", "value"), ("thickness_low [m]", "low")):
        assert float(row[column]) == rows[0]["thickness"][key]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"poissons_ratio": None}, "poissons_ratio: is missing"),
        ({"thickness": "4 um", "kernel": "tensed_membrane"}, "thickness: cannot be given with a"),
        ({"thickness": "4 Pa"}, "thickness: "),
        ({"thickness": "-4 um"}, "thickness: "),
        ({"thickness": "thick"}, 'or "free"'),
        ({"thickness": 0}, "thickness: "),
        ({"poissons_ratio": -0.2}, "thickness: cannot be free with the indenter 'sphere'"),
        ({"thickness": "0.9 um"}, "thickness: the depth reaches"),
    ],
)
def test_bad_options(options: dict[str, Any], words: str) -> None:
    """What cannot be is said in words, with what is allowed."""
    given = {**BEAD, "thickness": "free", **options}
    with pytest.raises(pl.ConfigError) as caught:
        pl.fit(*curve(), **{name: value for name, value in given.items() if value is not None})
    assert words in str(caught.value)


def test_a_contact_far_wider_than_the_layer_is_refused() -> None:
    """Beyond the table the fit says where it ends, for a free thickness too."""
    position, force = curve(radius=1.0, thickness=4e-6)
    with pytest.raises(pl.ConfigError, match="ten times as wide as the layer is thick"):
        pl.fit(position, force, indenter="sphere", radius=1.0, thickness=THICK, poissons_ratio=0.5)


def test_a_layer_thinner_than_the_depth_is_refused_at_once() -> None:
    """No interval and no rival is sought beyond the limit, which took a hundred times as long."""
    config = FitConfig.merged(None, thickness=THICK / 8, **BEAD)
    (problem,) = problems(config, config.sources({"": curve(thickness=1.0)}))
    assert isinstance(problem, FitProblem)
    stages: list[str] = []
    with pytest.raises(pl.ConfigError, match="the depth reaches"):
        fit_problem(problem, stages.append)
    assert stages == ["least squares"]


def test_advice_stays_within_the_layer() -> None:
    """No experiment is recommended that reaches the base, and other radii are compared."""
    fit = pl.fit(*curve(tension=1e-4), thickness=THICK, fix={"contact_point": 7e-6}, **BEAD)
    _, designs = _designs(fit.likelihood, fit.parameters)
    words = [design.words for design in designs]
    assert not any("deeper" in text for text in words)
    assert any("shallower" in text for text in words)
    assert any("a larger radius" in text for text in words)
