"""Interactions on the way from a run file to a result, and those that make no sense."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import pellicle as pl
from tests.command import call
from tests.framework.bad_input.conftest import says
from tests.tables_of_runs import half_space, paraboloid, pressing

FILE = """
outputs = []
[grid]
points = 64
size = "0.6 mm"
boundary = "free"
[kernel]
type = "half_space"
reduced_modulus = "700 kPa"
[indenter]
type = "paraboloid"
radius = "1 mm"
[interaction]
type = "linear"
work_of_adhesion = "50 mJ/m^2"
strength = "30 kPa"
[loading]
depth = ["5 um", "0 um", "-2 um"]
[solver]
type = "active_set"
tolerance = 1e-6
"""
ADDED = {"wall_pressure", "zone_area", "zone_width", "energy", "residual_traction"}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """Return a run file with an interaction."""
    path = tmp_path / "run.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


@pytest.mark.parametrize("kept", [1, 2])
def test_resumes_where_it_was_killed(file: Path, kept: int) -> None:
    """A run that goes on from its file has the numbers of one that was never interrupted."""
    whole = pl.run(file, progress=False)
    assert whole.converged
    part = pl.Result(whole.dataset.isel(step=slice(0, kept)))
    part.save(file.with_suffix(".h5"))
    before = file.with_suffix(".h5").stat().st_mtime_ns
    resumed = pl.run(file, directory=file.parent, progress=False)
    assert file.with_suffix(".h5").stat().st_mtime_ns > before
    for name in set(whole.dataset.data_vars) - {"wall_time"}:
        one, other = (result.dataset[name].values for result in (whole, resumed))
        if one.dtype.kind == "f":
            scale = float(np.nanmax(np.abs(one)))
            np.testing.assert_allclose(other, one, rtol=1e-12, atol=1e-12 * scale, err_msg=name)
        else:
            np.testing.assert_array_equal(other, one)
    loaded = pl.load(file.with_suffix(".h5"))
    assert loaded.dataset["wall_pressure"].values[-1].max() > 0
    np.testing.assert_array_equal(loaded.dataset["contact"], loaded.dataset["wall_pressure"] > 0)


def test_adds_variables(file: Path) -> None:
    """A result with an interaction has its variables, in the file and the table; others not."""
    run = pl.Run.from_toml(file)
    table = pl.Run.from_mapping(tomllib.loads(FILE) | {"outputs": [{"type": "csv"}]})
    with_law = pl.run(table, directory=file.parent, progress=False)
    assert set(with_law.dataset.data_vars) >= ADDED
    header = next(file.parent.glob("*.csv")).read_text(encoding="utf-8").partition("\n")[0]
    assert {"zone_area [m2]", "zone_width [m]", "energy [J]"} <= {*header.split(",")}
    shown = call("show", file.with_suffix(".h5")).output
    assert "area of the zone [" in shown
    hard = pl.run(
        run.model_copy(update={"interaction": None, "loading": pl.Loading(depth="5 um")}),
        progress=False,
    )
    assert not ADDED & set(hard.dataset.data_vars)
    assert hard.dataset["force"][0] > with_law.dataset["force"][0]


@pytest.mark.parametrize("quiet", [[], ["--quiet"]])
@pytest.mark.filterwarnings("default:.*beyond the theory")
def test_study_with_steep_slopes(tmp_path: Path, quiet: list[str]) -> None:
    """The command says once of how many runs, as `show` does, and counts them as converged."""
    file, out = tmp_path / "steep.toml", str(tmp_path / "out")
    steep = FILE.replace("0.6 mm", "80 um").replace("30 kPa", "100 kPa")
    steep = steep.replace('["5 um", "0 um", "-2 um"]', '"3 um"')
    vary = '[study.vary]\n"indenter.radius" = ["20 um", "100 um"]\n'
    file.write_text(steep + vary, encoding="utf-8")
    for command in (["run", str(file), "-o", out, *quiet], ["show", out]):
        done = call(*command)
        assert done.output.count("of 2 runs, in 1 slopes in contact are beyond the theory") == 1


STICKY = pressing(
    32, "0.6 mm", half_space("700 kPa"), paraboloid("1 mm"), depth=["5 um", "0 um"]
) | {
    "interaction": {"type": "jkr", "work_of_adhesion": "50 mJ/m^2"},
    "solver": {"type": "active_set", "tolerance": 1e-6},
}
PERIODIC = {"points": 32, "size": "0.6 mm", "boundary": "periodic"}


@pytest.mark.parametrize("prescribed", ["depth", "force", "mean_pressure", "base_displacement"])
def test_pulling_takes_an_interaction(prescribed: str) -> None:
    """A load below 0 is refused without an interaction, which is named, and allowed with one."""
    loading: dict[str, Any] = {prescribed: [1e-6, -1e-6]}
    if prescribed == "base_displacement":
        loading["spring_constant"] = "1 N/m"
    grid = PERIODIC if prescribed == "mean_pressure" else STICKY["grid"]
    configuration = STICKY | {"grid": grid, "loading": loading}
    assert pl.Run(**configuration).indentation.loading.values == (1e-6, -1e-6)
    del configuration["interaction"]
    for table in (loading, pl.Loading(**loading)):
        with pytest.raises(pl.ConfigError) as caught:
            pl.Run(**configuration | {"loading": table})
        message = str(caught.value)
        says(message, f"loading.{prescribed}.1: -1e-06 is not allowed; give a value ≥ 0")
        says(message, "with an [interaction] it may be negative")


def test_pull_that_no_contact_carries() -> None:
    """The step says how much the contact carries, the next that there is none; both press again."""
    with pytest.warns(pl.ConvergenceWarning):
        result = pl.run(
            STICKY | {"loading": {"force": ["-10 uN", "10 uN", "-500 uN", "-10 uN", "10 uN"]}},
            progress=False,
        )
    data = result.dataset
    codes = ["NOTHING_TO_PULL", "PULLED_OFF", "NOTHING_TO_PULL"]
    assert [*data["status_code"].values[[0, 2, 3]]] == codes
    assert data["converged"].values[[1, 4]].all()
    says(str(data["status"].values[0]), "no contact", "-10 µN; press before you pull")
    says(str(data["status"].values[2]), "no contact carries a force of -500 µN", "softer holder")
    assert not data["contact"].values[[0, 2, 3]].any()
    np.testing.assert_allclose(data["depth"][4], data["depth"][1], rtol=1e-3)


@pytest.mark.parametrize("strength", ["200 kPa", "2 MPa"])
def test_grid_that_is_too_coarse(strength: str) -> None:
    """A zone narrower than its law takes is told, also where no cell is in it, and what helps."""
    law = {"type": "linear", "work_of_adhesion": "50 mJ/m^2", "strength": strength}
    with pytest.warns(pl.ConvergenceWarning, match="cells wide, where it takes 1.25"):
        result = pl.run(STICKY | {"interaction": law, "loading": {"depth": "5 um"}}, progress=False)
    assert result.dataset["status_code"].item() == "COARSE_ZONE"
    assert float(result.dataset["zone_width"].item()) < 1.25 * 0.6e-3 / 32
    says(str(result.dataset["status"].item()), "use more points")


@pytest.mark.parametrize("work", [1e-30, 1e-12, 1e6, 1e30])
@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_works_of_all_sizes(work: float) -> None:
    """A work of adhesion far from any that exists ends in finite numbers and a status in words."""
    result = pl.run(
        STICKY | {"interaction": {"type": "jkr", "work_of_adhesion": work}}, progress=False
    )
    data = result.dataset
    assert np.isfinite(data["force"].values).all()
    if work < 1:
        # Hertz, 4/3 E* √R δ^(3/2), from which adhesion takes nothing.
        assert float(data["force"][0]) == pytest.approx(
            4 / 3 * 7e5 * 1e-3**0.5 * 5e-6**1.5, rel=0.1
        )
    else:
        assert not result.converged or result.coarse() or result.steep()


def test_steep_slopes() -> None:
    """A slope beyond those of the theory is told; the step counts as converged."""
    with pytest.warns(pl.ConvergenceWarning, match=r"slopes in contact reach 0\.[3-9]"):
        result = pl.run(
            STICKY
            | {
                "grid": {"points": 96, "size": "0.25 mm", "boundary": "free"},
                "indenter": {"type": "paraboloid", "radius": "0.2 mm"},
                "interaction": {
                    "type": "linear",
                    "work_of_adhesion": "50 mJ/m^2",
                    "strength": "60 kPa",
                },
                "loading": {"depth": "20 um"},
            },
            progress=False,
        )
    assert result.converged
    assert result.dataset["status_code"].item() == "STEEP"
