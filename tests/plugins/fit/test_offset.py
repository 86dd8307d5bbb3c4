"""A constant of the detector changes the fitted offset, and nothing else."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import pellicle as pl
from pellicle_fit.selection.verdict import Verdict
from tests.plugins.fit.conftest import ends_of, holds

MODULUS, RADIUS, DEEPEST = 100e3, 5e-6, 50e-9
SPRING, SENSITIVITY = 0.16, 50e-9
KINDS = {
    "extension [nm],deflection [nm]": ("base", 1 / SPRING),
    "height [um],deflection [V]": ("height", 1 / SPRING / SENSITIVITY),
    "extension [m],force [nN]": ("base", 1.0),
    "position [nm],deflection [nm]": ("tip", 1 / SPRING),
    "position [m],force [N]": ("tip", 1.0),
    "depth [nm],force [N]": ("depth", 1.0),
    "depth [nm],deflection [nm]": ("depth", 1 / SPRING),
}
"""Headers of tables, the place in their first column, and the second one over the force."""


def _fit(header: str, constant: float, folder: Path, **options: Any) -> pl.Fit:
    """Return the fit of a table whose forces are off by a constant, over the largest."""
    depth = np.linspace(-0.7, 1.0, 120) * DEEPEST
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0) ** 1.5
    largest, noise = force.max(), np.random.default_rng(3).standard_normal(depth.size)
    base, told = depth + force / SPRING, force + largest * (0.003 * noise + constant)
    place, over_force = KINDS[header]
    places = {"base": base, "height": 3e-6 - base, "tip": base - told / SPRING, "depth": depth}
    units = {"nm": 1e-9, "um": 1e-6, "nN": 1e-9}
    one, other = (units.get(part.split("[")[1][:-1], 1.0) for part in header.split(","))
    columns = np.column_stack([places[place] / one, told * over_force / other])
    path = folder / "curve.csv"
    np.savetxt(path, columns, fmt="%.15g", delimiter=",", header=header, comments="")
    if "[V]" in header:
        options["sensitivity"] = SENSITIVITY
    of_tip: dict[str, Any] = {"indenter": "paraboloid", "radius": RADIUS, "spring_constant": SPRING}
    return pl.fit(path, baseline="offset", **of_tip, **options)


@settings(max_examples=10, deadline=None, derandomize=True)
@given(header=st.sampled_from([*KINDS]), constant=st.floats(-20.0, 20.0))
def test_it_is_the_offset(
    tmp_path_factory: pytest.TempPathFactory, header: str, constant: float
) -> None:
    """Modulus, contact point, their intervals and checks are those of a detector without it."""
    folder = tmp_path_factory.mktemp("offset")
    plain, moved = (_fit(header, one, folder, model=[], rivals=[]) for one in (0.0, constant))
    before, now = plain.estimates(), moved.estimates()
    assert holds(before["reduced_modulus"], MODULUS)
    largest = 4 / 3 * MODULUS * np.sqrt(RADIUS) * DEEPEST**1.5
    shift = now["offset"].value - before["offset"].value
    assert shift == pytest.approx(constant * largest, abs=1e-4 * largest)
    for name, size in (("reduced_modulus", MODULUS), ("contact_point", DEEPEST)):
        old, new = (np.array([e.value, *ends_of(e)]) for e in (before[name], now[name]))
        assert new == pytest.approx(old, abs=1e-4 * size)
    assert [one.flaws for one in moved.answer.judgements] == [
        one.flaws for one in plain.answer.judgements
    ]


@pytest.mark.slow
@pytest.mark.parametrize("constant", [-5.0, 20.0])
def test_it_is_no_explanation(tmp_path: Path, constant: float) -> None:
    """With all rivals, and one contact point or another that no row reaches, E* is held."""
    header = "extension [nm],deflection [nm]"
    fit = _fit(header, constant, tmp_path)
    assert fit.verdict is Verdict.NO_SIGN
    assert holds(fit.reduced_modulus, MODULUS)


def test_a_relaxing_solid_sees_the_way_without_it() -> None:
    """The path of a memory is that of the tip, whatever the detector reads without a load."""
    time = np.linspace(0.0, 1.0, 300)
    options: dict[str, Any] = {
        "indenter": "paraboloid",
        "radius": RADIUS,
        "spring_constant": SPRING,
    }
    depth = np.linspace(-0.7, 1.0, 300) * DEEPEST
    force = 4 / 3 * MODULUS * np.sqrt(RADIUS) * np.maximum(depth, 0) ** 1.5
    fits = [
        pl.fit(
            depth + (force - told) / SPRING,
            told,
            time=time,
            baseline="offset",
            model=["standard_linear"],
            rivals=[],
            fix={"relaxed_share": 0.3, "relaxation_time": 0.2},
            **options,
        )
        for told in (force, force + 10 * force.max())
    ]
    plain, moved = (fit.reduced_modulus.value for fit in fits)
    assert moved == pytest.approx(plain, rel=1e-4)
