"""The semi-analytic reference solution of a run is the contact that the run prescribes."""

from __future__ import annotations

from math import inf
from typing import ClassVar, Literal

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.arrays import Array
from pellicle.results import StoredRuns
from pellicle_plugins.validation.reference import contact, exact, exact_line
from tests.plugins.outputs.shared import bead


@pytest.mark.parametrize(
    ("prescribed", "value", "what"),
    [
        ("depth", 1e-5, "depth"),
        ("force", 1e-5, "force"),
        ("contact_radius", 1e-4, "contact_radius"),
        ("contact_area", np.pi * 1e-8, "contact_radius"),
    ],
)
def test_reference_of_each_prescription(prescribed: str, value: float, what: str) -> None:
    """The reference has the prescribed value, and there is none at zero."""
    run = pl.Run(**bead(loading={prescribed: [0.0, value]}))
    result = xr.Dataset(attrs={"configuration": run.to_json()})
    assert contact(result, 1) is None
    expected = 1e-4 if prescribed == "contact_area" else value
    assert getattr(contact(result, 2), what) == pytest.approx(expected, rel=1e-9)


class Quartic(pl.Indenter):
    """A stranger's flat-nosed body, f = −r⁴/L³; h = 8x⁴/3L³."""

    type: Literal["quartic"] = "quartic"
    length: float = 1e-3
    contact_radius_limit: ClassVar[float] = inf
    pointed: ClassVar[bool] = False

    def profile(self, x: Array, y: Array) -> Array:
        """Return f [m]."""
        return -((x**2 + y**2) ** 2) / self.length**3

    def abel_slope(self, x: Array) -> Array:
        """Return h'(x)."""
        return 32 / 3 * x**3 / self.length**3


def test_run_with_a_stranger_s_body(monkeypatch: pytest.MonkeyPatch) -> None:
    """An indenter with an Abel transform has a reference in a run, whatever its type is called."""
    run = pl.Run(
        grid={"points": 8, "size": "1 mm"},
        kernel={"type": "half_space", "youngs_modulus": "7.5 kPa", "poissons_ratio": 0.5},
        indenter=Quartic(),
        loading={"contact_radius": ["0.2 mm"]},
    )
    monkeypatch.setattr(pl.Run, "from_json", lambda text: run)
    solution = contact(xr.Dataset(attrs={"configuration": run.to_json()}), 1)
    assert solution is not None
    assert solution.reduced_modulus == pytest.approx(1e4)
    # Those of Sneddon, 8a⁴/3L³ and 64 E* a⁵/15L³.
    a = 2e-4
    assert solution.depth == pytest.approx(8 / 3 * a**4 / 1e-9, rel=1e-9)
    assert solution.force == pytest.approx(2 * 1e4 * 4 / 5 * 8 / 3 * a**5 / 1e-9, rel=1e-9)


@pytest.fixture(scope="module")
def result() -> pl.Result:
    """Return a run without tension."""
    kernel = {"type": "half_space", "reduced_modulus": "10 kPa"}
    return pl.run(bead(kernel=kernel, loading={"depth": "10 um"}), progress=False)


def test_only_what_the_equation_gives_is_its_solution(result: pl.Result) -> None:
    """No simulated number passes for the semi-analytic one, and those it has are the equation's."""
    table = exact(StoredRuns.of_run(result.dataset)).table
    radius = table["contact_radius"].item()
    assert radius == pytest.approx(1e-4, rel=1e-9)
    assert radius != result.dataset["contact_radius"].item()
    assert table["perimeter"].item() == pytest.approx(2 * np.pi * radius)
    mean = table["force"].item() / (np.pi * radius**2)
    assert table["mean_contact_pressure"].item() == pytest.approx(mean)
    assert not {"patches", "major_axis_angle", "iterations"} & {*map(str, table.data_vars)}


def test_numbers_along_a_line_are_the_equation_s(result: pl.Result) -> None:
    """An expression over a semi-analytic line has the equation's numbers, no simulated ones."""
    line = exact_line(result.dataset.isel(step=0, y=8))
    assert line["contact_radius"].item() == pytest.approx(1e-4, rel=1e-9)
    share = line["contact_area"].item() / result.grid.area
    assert line["contact_fraction"].item() == pytest.approx(share)
    assert "patches" not in line
