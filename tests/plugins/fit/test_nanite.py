"""The model of docs/nanite, in nanite itself."""

import warnings
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl

# The model's package is not one that a framework needs, and neither are the warnings of its own.
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    # The folder docs/nanite alone would pass for a package of that name.
    models: Any = pytest.importorskip(
        "nanite.model", reason="nanite is not installed (pip install 'pellicle[nanite]')"
    )
    nanite: Any = import_module("nanite")

pytestmark = pytest.mark.filterwarnings("ignore")
MODEL = Path(__file__).parents[3] / "docs" / "nanite" / "model_tensed_contact.py"
TRUTH = {"E": 1.5e3, "R": 5e-6, "nu": 0.5, "contact_point": 0.2e-6, "baseline": 1e-10}
TIP = np.linspace(1e-6, -1.3e-6, 400)


@pytest.fixture(scope="module")
def model() -> Any:
    """Return the model as nanite loads it, which checks its parameters."""
    return models.load_model_from_file(MODEL, register=True)


def test_without_tension_it_is_nanites_hertz(model: Any) -> None:
    """Without tension on a thick solid both models give the same force."""
    hertz = models.models_available["hertz_para"].module.model_func(TIP, **TRUTH)
    force = model.module.model_func(TIP, tension=0, thickness=0, **TRUTH)
    assert force == pytest.approx(hertz, abs=2e-6 * np.ptp(hertz))


@pytest.mark.parametrize("tension", [0.0, 5e-3])
def test_layer(model: Any, tension: float) -> None:
    """A thick layer is the half-space, a thin one is stiffer and is that of pellicle."""
    function = model.module.model_func
    thick, whole, thin = (
        function(TIP, tension=tension, thickness=h, **TRUTH) - TRUTH["baseline"]
        for h in (1e-2, 0, 4e-6)
    )
    assert thick == pytest.approx(whole, abs=1e-3 * whole.max())
    assert thin[-1] > 1.3 * whole[-1]
    bead = pl.indenter("paraboloid", radius=TRUTH["R"])
    modulus = TRUTH["E"] / 0.75
    deepest = np.array([TRUTH["contact_point"] - TIP[-1]])
    force = modulus * bead.layer_force_curve(deepest, 2 * tension / modulus, 4e-6, 0.5).force  # type: ignore[attr-defined]
    assert thin[-1] == pytest.approx(force[0], rel=1e-9)


def test_nanite_finds_modulus_and_tension(model: Any) -> None:
    """A fit by nanite gives modulus and tension of a curve, where its Hertz gives neither."""
    force = model.module.model_func(TIP, tension=5e-3, **TRUTH)
    force = force + 0.002 * force.max() * np.random.default_rng(0).standard_normal(TIP.size)
    data = {"tip position": TIP, "force": force, "segment": np.zeros(TIP.size, dtype=np.uint8)}
    metadata = {"path": Path("curve"), "enum": 0, "imaging mode": "force-distance"}
    values = {}
    for key in ("tensed_contact", "hertz_para"):
        start = models.models_available[key].get_parameter_defaults()
        start["R"].value = TRUTH["R"]
        curve = nanite.Indentation(data, metadata)
        curve.fit_model(
            model_key=key, params_initial=start, preprocessing=[], weight_cp=0, segment=0
        )
        assert curve.fit_properties["success"]
        values[key] = curve.fit_properties["params_fitted"]
    assert values["tensed_contact"]["E"].value == pytest.approx(TRUTH["E"], rel=0.05)
    assert values["tensed_contact"]["tension"].value == pytest.approx(5e-3, rel=0.05)
    assert values["hertz_para"]["E"].value > 1.5 * TRUTH["E"]


def test_search_begins_with_the_fit_without_tension(model: Any) -> None:
    """Of a deep curve that drifts, no fit with a tension is worse than that of Hertz, inside it.

    From where nanite looks for the contact, 5 µm above it, the search ended at the bound of the
    tension with 10 Pa for 700 Pa.
    """
    tip = np.linspace(1.8e-6, -4.8e-6, 2000)
    drift = 1.2e-10 * np.minimum((1.8e-6 - tip) / 2e-6, 1)
    hertz = models.models_available["hertz_para"].module.model_func
    force = hertz(tip, E=700.0, R=10e-6, nu=0.5, contact_point=-4.2e-6) + drift
    data = {"tip position": tip, "force": force, "segment": np.zeros(tip.size, dtype=np.uint8)}
    metadata = {"path": Path("curve"), "enum": 0, "imaging mode": "force-distance"}
    chi_squares = {}
    for key in ("hertz_para", "tensed_contact"):
        curve = nanite.Indentation(data, metadata)
        curve.fit_model(model_key=key, preprocessing=[], segment=0)
        chi_squares[key] = curve.fit_properties["chi_sqr"]
    assert chi_squares["tensed_contact"] < 1.0001 * chi_squares["hertz_para"]
