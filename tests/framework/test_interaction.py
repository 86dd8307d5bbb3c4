"""Interactions on the way from a run file to a result file."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import pellicle as pl
from tests.command import call

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
