"""Files to read: a page names them, with a hash to check, and not their folder."""

from __future__ import annotations

import base64
import hashlib
import json
import pickle
import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest

import pellicle as pl
from pellicle.schema import InputPath, Model

HEIGHTS = 1e-1 * np.add.outer(np.arange(8.0), np.arange(8.0) ** 2)
FILE = """
outputs = [{ type = "html" }]
grid = { points = 8, size = "0.4 mm" }
kernel = { type = "half_space", reduced_modulus = "10 kPa" }
indenter = { type = "heights", path = "../data/a.npy", unit = "1 um" }
loading = { depth = "30 um" }
"""


class InputFile(Model):
    """A model with a file."""

    path: InputPath


VARY = '[study]\nvary = { "indenter.path" = ["../data/a.npy", "../data/b.npy"] }\n'


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return a folder with a run file, a study file, and heights beside them."""
    root = tmp_path / "home-of-somebody" / "project"
    for name in ("data", "runs"):
        (root / name).mkdir(parents=True)
    np.save(root / "data" / "a.npy", HEIGHTS)
    np.save(root / "data" / "b.npy", 2 * HEIGHTS)
    (root / "runs" / "a.toml").write_text(FILE, encoding="utf-8")
    (root / "runs" / "s.toml").write_text(FILE + VARY, encoding="utf-8")
    return root


def _saved(page: Path) -> str:
    """Return the file that a page offers to reproduce it."""
    texts = re.findall(r"data:text/plain;charset=utf-8;base64,([^\"]*)", page.read_text("utf-8"))
    return base64.b64decode(texts[0]).decode()


def test_page_of_a_run_can_be_given_away(project: Path, tmp_path: Path) -> None:
    """It has the name and the hash of the heights, and nothing of the machine."""
    first = pl.Run.from_toml(project / "runs" / "a.toml")
    pl.run(first, directory=tmp_path / "out", progress=False)
    text = (tmp_path / "out" / "run.html").read_text(encoding="utf-8")
    assert "home-of-somebody" not in text
    assert hashlib.sha256(HEIGHTS.tobytes()).hexdigest() in text

    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(project / "data", elsewhere)
    again = elsewhere / "again.toml"
    again.write_text(_saved(tmp_path / "out" / "run.html"), encoding="utf-8")
    assert "home-of-somebody" not in again.read_text(encoding="utf-8")
    assert pl.Run.from_toml(again).identity == first.identity
    np.save(elsewhere / "a.npy", HEIGHTS[::-1])
    with pytest.raises(pl.ConfigError, match=r"^indenter\.sha256: .*they have changed"):
        pl.Run.from_toml(again)


def test_page_of_a_study_can_be_given_away(project: Path, tmp_path: Path) -> None:
    """The values of an axis are as they were given, in the page and in the table."""
    table = pl.run_study(project / "runs" / "s.toml", tmp_path / "out", progress=False)
    given = ["../data/a.npy", "../data/b.npy"]
    assert list(table["indenter.path"].values) == given
    page = tmp_path / "out" / "study.html"
    assert "home-of-somebody" not in page.read_text(encoding="utf-8")
    assert "home-of-somebody" not in (tmp_path / "out" / "study.csv").read_text(encoding="utf-8")
    assert tomllib.loads(_saved(page))["study"]["vary"]["indenter.path"] == given


def test_given_paths_mean_the_same_from_anywhere(
    project: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Objects and copies have the place of the file; only texts to give away do not."""
    monkeypatch.chdir("/")
    run = pl.Run.from_toml(project / "runs" / "a.toml")
    file = project / "runs" / "../data/a.npy"
    (project / "toml.toml").write_text(run.to_toml(), encoding="utf-8")
    copies = pickle.loads(pickle.dumps(run)), pl.Run.from_json(run.to_json())
    for copy in (run, *copies, pl.Run.from_toml(project / "toml.toml")):
        assert copy.indentation.indenter.model_dump()["path"] == file
        assert copy == run
    assert json.loads(run.to_json())["indenter"]["path"] == str(file)
    assert json.loads(run.to_json(portable=True))["indenter"]["path"] == "a.npy"
    assert InputFile(path="a/b.npy").path == Path("a/b.npy")
    study = pl.Study.from_toml(project / "runs" / "s.toml")
    paths = [point.run.indentation.indenter.model_dump()["path"] for point in study.points]
    assert [path.name for path in paths] == ["a.npy", "b.npy"]
    again = pl.Study.from_json(study.to_json())
    assert [point.run for point in again.points] == [point.run for point in study.points]
    assert study.points[0].run.identity != study.points[1].run.identity
