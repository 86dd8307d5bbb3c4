"""Paths of files to read: a page shows them as they were given, with a hash to check."""

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

HEIGHTS = 1e-1 * np.add.outer(np.arange(8.0), np.arange(8.0) ** 2)
FILE = """
outputs = [{ type = "html" }]
grid = { points = 8, size = "0.4 mm" }
kernel = { type = "half_space", reduced_modulus = "10 kPa" }
indenter = { type = "heights", path = "../data/a.npy", unit = "1 um" }
loading = { depth = "30 um" }
"""
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
    """It has the path of the run file and the hash of the heights, and nothing of the machine."""
    first = pl.Run.from_toml(project / "runs" / "a.toml")
    pl.run(first, directory=tmp_path / "out", progress=False)
    text = (tmp_path / "out" / "run.html").read_text(encoding="utf-8")
    assert "home-of-somebody" not in text
    assert "../data/a.npy" in text
    assert hashlib.sha256(HEIGHTS.tobytes()).hexdigest() in text

    elsewhere = tmp_path / "elsewhere"
    shutil.copytree(project / "data", elsewhere / "data")
    (elsewhere / "mine").mkdir()
    again = elsewhere / "mine" / "again.toml"
    again.write_text(_saved(tmp_path / "out" / "run.html"), encoding="utf-8")
    assert "home-of-somebody" not in again.read_text(encoding="utf-8")
    assert pl.Run.from_toml(again).identity == first.identity
    np.save(elsewhere / "data" / "a.npy", HEIGHTS[::-1])
    with pytest.raises(pl.ConfigError, match=r"^indenter\.sha256: .*they have changed"):
        pl.Run.from_toml(again)


def test_page_of_a_study_can_be_given_away(project: Path, tmp_path: Path) -> None:
    """So it is with the values of an axis, in the page and in the table."""
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
    """Objects, copies and results have the place of the file; only texts to give away do not."""
    monkeypatch.chdir("/")
    run = pl.Run.from_toml(project / "runs" / "a.toml")
    file = project / "runs" / "../data/a.npy"
    for copy in (run, pickle.loads(pickle.dumps(run)), pl.Run.from_json(run.to_json())):
        assert copy.indenter.model_dump()["path"] == file
        assert copy == run
    assert json.loads(run.to_json())["indenter"]["path"] == str(file)
    for copy in (run, pickle.loads(pickle.dumps(run))):
        configuration = json.loads(copy.to_json(as_given=True))
        assert configuration["indenter"]["path"] == "../data/a.npy"
    study = pl.Study.from_toml(project / "runs" / "s.toml")
    paths = [point.run.indenter.model_dump()["path"] for point in study.points]
    assert [path.name for path in paths] == ["a.npy", "b.npy"]
    varied = pl.Study(run=run, vary={"indenter.unit": ["1 um", "2 um"]}).points[1].run
    assert json.loads(varied.to_json(as_given=True))["indenter"]["path"] == "../data/a.npy"
