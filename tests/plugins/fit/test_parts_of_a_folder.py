"""Parts of a folder of curves: each curve under a lock, the table as by one process."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import pellicle as pl
from pellicle.runs.lock import locked
from tests.command import Cli
from tests.part_runs import run_parts
from tests.plugins.fit.test_many import OPTIONS, curve, save

COUNT = 20
TIMES = ("wall_time", "date", "checksum")


def fill(folder: Path, count: int) -> Path:
    """Write curves that are alike, and one that cannot be read; return their folder."""
    for number in range(count):
        save(folder / f"{number:02}.csv", *curve(number))
    (folder / "zz.csv").write_text("position [um],force [nN]\n1,2\n", encoding="utf-8")
    return folder


def fits_in(folder: Path) -> Any:
    """Return what a folder holds of fits, without times."""

    def kept(value: Any) -> Any:
        if isinstance(value, dict):
            return {name: kept(entry) for name, entry in value.items() if name not in TIMES}
        return [*map(kept, value)] if isinstance(value, list) else value

    return kept(json.loads((folder / "fits.json").read_text(encoding="utf-8")))


def test_parts_are_as_one(cli: Cli, tmp_path: Path) -> None:
    """The last of three parts writes the table; curves that speak for others come first."""
    fill(tmp_path / "day", COUNT)
    cli("day", *OPTIONS, "-o", "whole", code=1)
    assert "curves left:" in cli("day", *OPTIONS, "-o", "out", "--part", "3/3").output
    assert not (tmp_path / "out" / "fits.h5").exists()
    left = json.loads(cli("day", *OPTIONS, "-o", "out", "--part", "2/3", "--json", "-q").stdout)
    assert left["left"]
    assert not left["failed"]
    last = cli("day", *OPTIONS, "-o", "out", "--part", "1/3", code=1)
    assert "1 of 21 curves could not be fitted" in last.stderr
    assert fits_in(tmp_path / "out") == fits_in(tmp_path / "whole")
    assert not list(tmp_path.rglob("*.lock"))


def test_curves_of_another_process_are_left_to_it(cli: Cli, tmp_path: Path) -> None:
    """Any part passes over locked curves; a later call fits those whose holder ended."""
    fill(tmp_path / "day", 3)
    kept = tmp_path / "out" / "curves"
    cli("day/00.csv", "day/02.csv", *OPTIONS, "-o", "out")
    (last, *_) = kept.glob("*.json")
    last.unlink()
    with locked(kept, last.stem):
        held = cli("day", *OPTIONS, "-o", "out", "--part", "any")
    assert "another process fits it" in held.stderr
    assert "curves left: 1" in held.stdout
    cli("day", *OPTIONS, "-o", "out", "--part", "any", code=1)
    assert (tmp_path / "out" / "fits.h5").is_file()


def test_part_is_refused(cli: Cli, tmp_path: Path) -> None:
    """Parts need a folder, and several curves that are fitted on their own."""
    fill(tmp_path / "day", 2)
    assert "name it (-o DIR)" in cli("day", *OPTIONS, "--part", "any", code=2).stderr
    for given in (["day/00.csv"], ["day", "--pool"]):
        refused = cli(*given, *OPTIONS, "-o", "out", "--part", "1/2", code=2)
        assert "has no parts" in refused.stderr


@pytest.mark.slow
def test_parts_with_kills(tmp_path: Path) -> None:
    """Of ten parts on two processes some are killed; the fits are those of one process."""
    fill(tmp_path / "day", COUNT)
    (tmp_path / "day" / "zz.csv").unlink()
    killed = run_parts(["fit", "day", *OPTIONS, "-o", "out", "--quiet"], 10, tmp_path, kills=6)
    assert killed > 1
    pl.fit_many(
        tmp_path / "day",
        directory=tmp_path / "whole",
        indenter="paraboloid",
        radius="10 um",
        rivals=(),
        progress=False,
    )
    own, other = (fits_in(tmp_path / name)["curves"] for name in ("out", "whole"))
    for fit in (*own, *other):
        fit.pop("curve"), fit.pop("curves")
    assert own == other
