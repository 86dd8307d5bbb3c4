"""Files to read: a page names them, with a hash to check; texts in other encodings."""

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
from typer.testing import CliRunner

import pellicle as pl
from pellicle.cli.app import app
from pellicle.files import read_text
from pellicle.schema import InputPath, Model
from pellicle.schema.from_file import read_toml
from pellicle_fit.files.choice import read as read_curves
from tests.command import call

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


CURVE = "position (µm),force (nN)\n0,0\n1,2\n2,5\n"
OF_ENCODINGS = "# heights, µm\n1 2\n3 4\n"
CODE_PAGES = ("cp1252", "cp437", "ascii", "utf-8")


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_what_a_code_page_lacks_is_replaced(encoding: str) -> None:
    """Help ends without an error, and so does a message that has a name of other signs."""
    for words in (["--help"], ["run", "--help"]):
        assert CliRunner(charset=encoding).invoke(app, words).exit_code == 0
    refused = CliRunner(charset=encoding).invoke(app, ["run", "Δ接触.toml"])
    assert refused.exit_code == 2
    assert ".toml: No such file" in refused.stderr


@pytest.mark.parametrize("encoding", CODE_PAGES)
@pytest.mark.parametrize("words", [["schema"], ["plugins", "--json"]])
def test_json_is_ascii(encoding: str, words: list[str]) -> None:
    """JSON is printed in ASCII, and so reads the same in whatever code page it went through."""
    printed = CliRunner(charset=encoding).invoke(app, words)
    assert printed.exit_code == 0, printed.exception
    assert printed.stdout_bytes.isascii()
    assert json.loads(printed.stdout_bytes) == json.loads(call(*words).stdout)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_tables_are_read_in_the_encodings_of_instruments(encoding: str, tmp_path: Path) -> None:
    """A curve or heights with µ in them are the same in Unicode and in Windows' code page."""
    curve, heights = tmp_path / "a.csv", tmp_path / "a.txt"
    curve.write_bytes(CURVE.encode(encoding))
    heights.write_bytes(OF_ENCODINGS.encode(encoding))
    (reader,) = read_curves(curve).values()
    np.testing.assert_allclose(reader().position, [0, 1e-6, 2e-6])
    indenter = pl.indenter("heights", path=heights, unit="1 um")
    profile = indenter.profile(*pl.Grid(points=2, size=1.0).coordinates())
    np.testing.assert_allclose(profile, [[-3e-6, -2e-6], [-1e-6, 0]])


def test_bytes_are_not_text(tmp_path: Path) -> None:
    """What has zero bytes, or bytes that no encoding here has, is refused as text."""
    path = tmp_path / "a.txt"
    for content in (b"1 2\0\n", b"\x81\x8d", "1 2".encode("utf-16-le"), b"\xff\xfe1"):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=r"."):
            read_text(path)
        with pytest.raises(pl.ConfigError, match=r"^path: .* cannot be read as text"):
            pl.indenter("heights", path=path, unit=1)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-16"])
def test_toml_in_another_encoding(encoding: str, tmp_path: Path) -> None:
    """TOML is UTF-8: the message says so, and where the file is not."""
    path = tmp_path / "a.toml"
    path.write_bytes("a = 1\ntitle = 'µ'\n".encode(encoding))
    line = 2 if encoding == "cp1252" else 1
    with pytest.raises(pl.ConfigError, match=rf"not a text file in UTF-8 \(see line {line}\)"):
        read_toml(path)
    path.write_bytes("a = 1\ntitle = 'µ'\n".encode("utf-8-sig"))
    assert read_toml(path) == {"a": 1, "title": "µ"}
