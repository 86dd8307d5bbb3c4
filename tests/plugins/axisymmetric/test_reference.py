"""The semi-analytic solution of a run is the contact prescribed; radii of cells by stiffness."""

from math import inf, pi
from typing import Any, ClassVar, Literal

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.arrays import Array
from pellicle.results import StoredRuns
from pellicle_axisymmetric.tensed_punch import punch
from pellicle_plugins.validation.adhesive_path import excess_radius
from pellicle_plugins.validation.reference import contact, exact, exact_line
from tests.plugins.outputs.shared import bead
from tests.tables_of_runs import pressing


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
        return -((x**2 + y**2) ** 2) / self.length**3

    def abel_slope(self, x: Array) -> Array:
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


POINTS, SIZE = 64, 4.0
SPACING = SIZE / POINTS


@pytest.mark.parametrize("tension", [0.0, pytest.param(0.5, marks=pytest.mark.slow)])
def test_cells_are_as_stiff_as_a_smaller_punch(tension: float) -> None:
    """The stiffness of punches of cells, over five radii, is that of the corrected radius."""
    kernel = pl.kernel("tensed_membrane", reduced_modulus=1.0, tension=tension)
    excess = []
    for radius in np.linspace(0.8, 1.2, 5):
        run: dict[str, Any] = pressing(
            POINTS, SIZE, kernel, {"type": "flat_punch", "radius": radius}, depth=1.0
        )
        step = pl.run(run, progress=False).dataset.isel(step=0)
        # Under tension some cells beside the rim carry no pressure.
        counted = SPACING * np.sqrt(np.count_nonzero(np.hypot(step["x"], step["y"]) <= radius) / pi)
        force, wider = (punch(counted + h, 1.0, tension, depth=1.0).force for h in (0.0, 1e-3))
        excess.append((force - float(step["force"])) / (wider - force) * 1e-3)
    assert np.mean(excess) == pytest.approx(excess_radius(kernel, SPACING), abs=0.03 * SPACING)


def test_springs_count_their_cells() -> None:
    """Separate springs are as stiff as the area of the cells."""
    assert excess_radius(pl.kernel("winkler", foundation=1.0), SPACING) == 0
