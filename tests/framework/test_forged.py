"""What another program wrote under a right checksum is refused in words, by show and by plot."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import pellicle as pl
from pellicle.results import storage
from tests.command import call
from tests.small_run import RUN

TEXT: Any = np.array("x", dtype=object)
STUDY = RUN | {"study": {"vary": {"kernel.tension": [0.1, 0.2]}}}


def put(name: str, value: Any) -> Any:
    """Return a forgery that fills a variable with a value."""

    def forged(data: xr.Dataset) -> xr.Dataset:
        filled = xr.Variable(data[name].dims, np.full(data[name].shape, value))
        if name in data.coords:
            return data.assign_coords({name: filled})
        return data.assign({name: filled})

    return forged


def attribute(name: str, value: Any) -> Any:
    """Return a forgery that says something else in an attribute; None leaves it out."""

    def forged(data: xr.Dataset) -> xr.Dataset:
        rest = {key: old for key, old in data.attrs.items() if key != name}
        return data.drop_attrs(deep=False).assign_attrs(
            rest if value is None else rest | {name: value}
        )

    return forged


def configured(**changed: Any) -> Any:
    """Return a forgery with another configuration."""

    def forged(data: xr.Dataset) -> xr.Dataset:
        own = json.loads(data.attrs["configuration"]) | changed
        return data.assign_attrs(configuration=json.dumps(own))

    return forged


BOTH = {
    "configuration no JSON": attribute("configuration", "{"),
    "configuration deep": attribute("configuration", "[" * 100_000 + "]" * 100_000),
    "configuration a list": attribute("configuration", "[]"),
    "configuration a number": attribute("configuration", 7),
    "no grid": configured(grid=None),
    "steps in words": attribute("planned_steps", "many"),
    "two tolerances": attribute("tolerance", np.array([1.0, 2.0])),
    "no boundary": attribute("boundary", None),
    "force of text": put("force", TEXT),
    "complex depth": put("depth", 1j),
    "converged of numbers": put("converged", 5.0),
    "caveats no JSON": put("caveats", TEXT),
    "caveats of numbers": put("caveats", np.array("[1]", dtype=object)),
    "caveat without values": put("caveats", np.array('[["COARSE", {}]]', dtype=object)),
    "unknown status": put("status_code", TEXT),
    "steps not whole": put("step", np.nan),
    "no steps": lambda data: data.isel(step=slice(0)),
    "one number for all steps": lambda data: data.assign(iterations=3),
}
RESULT = {
    "pressure of text": put("pressure", TEXT),
    "displacement of text": put("displacement", TEXT),
    "contact of numbers": put("contact", 1.0),
    "another grid": configured(grid={"points": 7, "size": 1.0, "boundary": "free"}),
    "fields the other way": lambda data: data.transpose("y", "x", "step"),
    "coordinates of text": put("x", TEXT),
}
TABLE = {
    "axes no JSON": attribute("axes", "{"),
    "derived a number": attribute("derived", "5"),
    "runs of numbers": put("run", 5.0),
    "one run": lambda data: data.assign(run="x"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a result and the folder of a study."""
    folder = tmp_path_factory.mktemp("forged")
    pl.run(RUN, progress=False, threads=1).save(folder / "r.h5")
    pl.run_study(STUDY, directory=folder / "s", progress=False)
    return folder


@pytest.mark.parametrize(
    ("kind", "forged"),
    [
        *(pytest.param("r.h5", forged, id=name) for name, forged in (BOTH | RESULT).items()),
        *(
            pytest.param("s/study.h5", forged, id=f"study: {name}")
            for name, forged in (BOTH | TABLE).items()
            if "configuration" not in name and name != "no grid"
        ),
    ],
)
def test_a_forgery_is_refused_in_words(
    kind: str, forged: Any, folder: Path, tmp_path: Path
) -> None:
    """No traceback and no figure: exit 2, the name of the file, and what to do."""
    path = tmp_path / Path(kind).name
    data = (storage.table if "study" in kind else storage.read)(folder / kind)
    storage.write(forged(data), path)
    for command in (["show"], ["show", "--json"], ["plot"]):
        done = call(*command, path, code=2)
        assert done.output.startswith(f"error: {path}: ")
        assert "Traceback" not in done.output
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.filterwarnings("ignore::pellicle.ConvergenceWarning")
def test_what_is_written_is_sound(folder: Path) -> None:
    """Genuine files are shown, of a path that sticks and of a solid that relaxes too."""
    sticks = RUN | {
        "kernel": {
            "type": "viscoelastic",
            "solid": {"type": "half_space", "reduced_modulus": 1e4},
            "relaxation": [{"fraction": 0.5, "time": 1.0}],
        },
        "interaction": {"type": "linear", "work_of_adhesion": 1e-3, "range": 1e-6},
        "loading": {"depth": [5e-6, 10e-6], "time": [0.0, 1.0], "stiffness": True},
        "corrections": [{"type": "yastrebov"}],
    }
    pl.run(sticks, progress=False, threads=1).save(folder / "sticks.h5")
    for kind in ("r.h5", "s", "sticks.h5"):
        done = call("show", folder / kind)
        assert done.exit_code in (0, 1), done.output
        assert "error: " not in done.output
