"""Texts in other encodings than UTF-8: what is printed, and what is read."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import pellicle as pl
from pellicle.cli.app import app
from pellicle.files import read_text
from pellicle.schema.from_file import read_toml
from pellicle_fit.files.choice import read as read_curves
from tests.command import call

CURVE = "position (µm),force (nN)\n0,0\n1,2\n2,5\n"
HEIGHTS = "# heights, µm\n1 2\n3 4\n"
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
    heights.write_bytes(HEIGHTS.encode(encoding))
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
