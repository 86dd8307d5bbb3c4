"""Result files of another program that look like ours: every command refuses them in words."""

from __future__ import annotations

import json
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

import pellicle as pl
from pellicle.cli.app import app
from pellicle.results import checksum

RUN: dict[str, Any] = {
    "grid": {"points": 8, "size": "0.4 mm"},
    "kernel": {"type": "half_space", "reduced_modulus": "10 kPa"},
    "indenter": {"type": "paraboloid", "radius": "1 mm"},
    "loading": {"depth": "20 um"},
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return a result file."""
    path = tmp_path_factory.mktemp("whole") / "a.h5"
    pl.run(RUN, progress=False).save(path)
    return path.read_bytes()


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """Return the table of a study."""
    folder = tmp_path_factory.mktemp("table")
    vary = {"indenter.radius": ["0.9 mm", "1 mm"]}
    pl.run_study({**RUN, "outputs": [], "study": {"vary": vary}}, folder, progress=False)
    return (folder / "study.h5").read_bytes()


def _attribute(name: str, value: object) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        file.attrs[name] = value

    return change


def _configuration(**changes: Any) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        file.attrs["configuration"] = json.dumps(json.loads(file.attrs["configuration"]) | changes)

    return change


def _variable(name: str, values: Any, kind: Any = None) -> Callable[[h5py.File], None]:
    def change(file: h5py.File) -> None:
        old = file[name]
        scales = [next(iter(dim.values())).name for dim in old.dims]
        del file[name]
        changed = file.create_dataset(name, data=np.full(old.shape, values, kind), dtype=kind)
        for dim, scale in zip(changed.dims, scales, strict=True):
            dim.attach_scale(file[scale])

    return change


def write_changed(path: Path, content: bytes, change: Callable[[h5py.File], object]) -> None:
    """Write a result file with a change, whose checksum is that of the changed content."""
    path.write_bytes(content)
    with h5py.File(path, "r+") as file:
        change(file)
    image = BytesIO(path.read_bytes())
    checksum.seal(image)
    path.write_bytes(image.getvalue())


TEXT = h5py.string_dtype()
RESULTS = {
    "configuration a list": (_attribute("configuration", "[]"), "not a table"),
    "configuration a number": (_attribute("configuration", "3"), "not a table"),
    "configuration no text": (_attribute("configuration", 3.0), "not a readable result"),
    "configuration no JSON": (_attribute("configuration", "{"), "not a readable result"),
    "configuration empty": (_attribute("configuration", "{}"), "without a grid or a loading"),
    "grid a list": (_configuration(grid=[]), "without a grid or a loading"),
    "grid of nothing": (_configuration(grid={}), "without a grid or a loading"),
    "loading a text": (_configuration(loading="much"), "without a grid or a loading"),
    "another grid": (
        _configuration(grid={"points": 9, "size": 1.0}),
        r"other shapes than its grid of \(9, 9\)",
    ),
    "pressure a text": (_variable("pressure", "high", TEXT), "has pressure of type"),
    "depth a text": (_variable("depth", "deep", TEXT), "has depth of type"),
    "contact a number": (_variable("contact", 1.5), "has contact of type float64"),
    "status a number": (_variable("status", 1), "has status of type int64"),
    "status_code a number": (_variable("status_code", 1), "has status_code of type int64"),
    "status_code unknown": (_variable("status_code", "SOLVED", TEXT), "status_code 'SOLVED'"),
}


@pytest.mark.parametrize("damage", RESULTS)
def test_result(damage: str, whole: bytes, tmp_path: Path) -> None:
    """``show``, ``plot`` and `pellicle.load` say what is wrong with the file."""
    change, message = RESULTS[damage]
    path = tmp_path / "a.h5"
    write_changed(path, whole, change)
    with pytest.raises(pl.StorageError, match=message):
        pl.load(path)
    for command in ("show", "plot"):
        done = CliRunner().invoke(app, [command, str(path)])
        assert done.exit_code == 2, (done.exception, done.output)
        assert done.stderr.startswith(f"error: {path}: ")


@pytest.mark.parametrize("damage", RESULTS)
def test_run_that_would_go_on(
    damage: str, whole: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run whose file is damaged says so, and how to begin anew; no output is blamed for it."""
    monkeypatch.chdir(tmp_path)
    run = pl.Run(**RUN)
    Path("a.toml").write_text(run.to_toml(), encoding="utf-8")
    Path("a").mkdir()
    Path("a/a.h5").write_bytes(whole)
    with h5py.File("a/a.h5", "r+") as file:
        RESULTS[damage][0](file)
    done = CliRunner().invoke(app, ["run", "a.toml"])
    assert done.exit_code == 2, done.output
    assert done.stderr.startswith("error: a/a.h5: ")
    assert "--overwrite" in done.stderr


TABLES = {
    "configuration a list": _attribute("configuration", "[]"),
    "configuration empty": _attribute("configuration", "{}"),
    "study a list": _configuration(study=[]),
    "axes no JSON": _attribute("axes", "{"),
    "axes a list": _attribute("axes", "[]"),
    "first run a list": _attribute("first_run", "[]"),
    "status a number": _variable("status", 1),
    "status_code unknown": _variable("status_code", "SOLVED", TEXT),
    "force a text": _variable("force", "much", TEXT),
    "run gone": lambda file: file.__delitem__("run"),
    "converged gone": lambda file: file.__delitem__("converged"),
}


@pytest.mark.parametrize("damage", TABLES)
def test_table(damage: str, table: bytes, tmp_path: Path) -> None:
    """``show`` and ``plot`` say that the table of a study is damaged."""
    path = tmp_path / "study.h5"
    write_changed(path, table, TABLES[damage])
    for command in ("show", "plot"):
        done = CliRunner().invoke(app, [command, str(path)])
        assert done.exit_code == 2, (command, done.exception, done.output)
        assert done.stderr.startswith(f"error: {path}: ")


def test_whole_ones(whole: bytes, table: bytes, tmp_path: Path) -> None:
    """What nobody has changed is shown and drawn."""
    for name, content in (("a.h5", whole), ("study.h5", table)):
        (tmp_path / name).write_bytes(content)
        for command in ("show", "plot"):
            done = CliRunner().invoke(app, [command, str(tmp_path / name)])
            assert done.exit_code == 0, done.output
        (tmp_path / name).unlink()
