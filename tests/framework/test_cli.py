"""The command line, from a starter file to figures."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import pellicle as pl
from pellicle.components.installed import registry
from tests.command import Cli
from tests.pictures import drawn_width

SMALL = ["--set", "grid.points=32", "--set", "loading.depth=['10 um', '20 um']"]


def _files_named(stdout: str) -> list[Path]:
    return [Path(line[6:]) for line in stdout.splitlines() if line.startswith("wrote ")]


@pytest.mark.slow
def test_from_starter_file_to_figures(cli: Cli) -> None:
    """`new`, `run`, `show` and `plot` work one after the other, and name files that exist."""
    assert "pellicle run indent.toml" in cli("new").stdout
    ran = cli("run", "indent.toml", *SMALL)
    files = _files_named(ran.stdout)
    assert {file.suffix for file in files} == {".h5", ".csv", ".png"}
    assert {file.parent for file in files} == {Path("indent")}
    assert pl.load("indent/indent.h5").dataset.sizes["step"] == 2
    assert len(Path("indent/indent.csv").read_text(encoding="utf-8").splitlines()) == 3
    assert all(drawn_width(file) > 0.2 for file in files if file.suffix == ".png")
    assert ran.stdout.count("converged") == 2
    shown = cli("show", "indent/indent.h5").stdout
    assert "Paraboloid on a tensed skin" in shown
    assert f"pellicle {pl.__version__}" in shown
    assert "depth [µm]" in shown
    assert "force [µN]" in shown
    assert "contact area, Yastrebov correction [mm²]" in shown
    assert shown.count("converged") == 2
    assert "contact:\nstep  mean contact pressure [kPa]  contact radius [µm]" in shown
    assert cli("show", "indent").stdout == shown
    assert {*_files_named(cli("plot", "indent").stdout)} < {*files}
    drawn = cli("plot", "indent/indent.h5", "-o", "drawn", "--format", "svg", "--format", "pdf")
    figures = _files_named(drawn.stdout)
    assert {figure.suffix for figure in figures} == {".svg", ".pdf"}
    assert {figure.parent for figure in figures} == {Path("drawn")}
    for figure in figures:
        content = figure.read_text(encoding="utf-8", errors="replace").rstrip()
        assert content.endswith({".svg": "</svg>", ".pdf": "%%EOF"}[figure.suffix])


def test_numbers_shown_are_the_result_s(cli: Cli) -> None:
    """The table shows what is in the file, with four digits and a prefix or, on request, in SI."""
    cli("new", "a.toml")
    ran = cli("run", "a.toml", *SMALL, "--set", "outputs=[]")
    data, shown = pl.load("a/a.h5").dataset, cli("show", "a/a.h5").stdout
    in_si = cli("show", "a/a.h5", "--si").stdout
    assert "depth [m]" in in_si
    assert "contact area [m²]" in in_si
    for name in ("depth", "force", "contact_area", "contact_area_yastrebov"):
        for value in data[name].values:
            prefixed = f"{value * 1e6:.4g}"
            assert prefixed in ran.stdout
            assert prefixed in shown
            assert f"{value:.6g}" in in_si


def test_new_does_not_overwrite(cli: Cli) -> None:
    """`pellicle new` leaves a file that is there alone."""
    Path("mine.toml").write_text("mine", encoding="utf-8")
    assert "mine.toml exists already" in cli("new", "mine.toml", code=2).stderr
    assert "mine.toml exists already" in cli("new", "mine", code=2).stderr
    assert Path("mine.toml").read_text(encoding="utf-8") == "mine"
    assert "no/mine.toml: cannot be written" in cli("new", "no/mine.toml", code=2).stderr


@pytest.mark.slow
def test_not_converged(cli: Cli) -> None:
    """A run that does not converge is kept and marked, says what to try, and exits with 1."""
    cli("new", "a.toml")
    result = cli("run", "a.toml", *SMALL, "--set", "solver.max_iterations=3", code=1)
    assert result.stdout.count("NOT CONVERGED") == 2
    assert result.stderr.count("steps 1 and 2 did not converge: step 1: the surface misses") == 1
    assert "over the tolerance 1.0e-08" in result.stderr
    assert "raise solver.max_iterations" in result.stderr
    assert all(file.exists() for file in _files_named(result.stdout))
    kept = pl.load("a/a.h5").dataset
    assert not kept["converged"].values.any()
    assert all("raise solver.max_iterations" in status for status in kept["status"].values)
    assert (kept["iterations"].values == 3).all()
    again = cli("show", "a/a.h5", code=1)
    assert "NOT CONVERGED" in again.stdout
    assert "raise solver.max_iterations" in again.stderr
    cli("plot", "a/a.h5")


def test_not_converged_is_said_even_when_quiet(cli: Cli) -> None:
    """`--quiet` silences no problem."""
    cli("new", "a.toml")
    bad = ["--set", "solver.max_iterations=3", "--set", "outputs=[]"]
    three = ["--set", "grid.points=32", "--set", "loading.depth=[1e-5, 1.5e-5, 2e-5]"]
    result = cli("run", "a.toml", *three, *bad, "--quiet", code=1)
    assert result.stdout == ""
    assert result.stderr.count("steps 1 to 3 did not converge: step 1: the surface misses") == 1


def test_plugins_are_checked_over_their_examples(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """`pellicle plugins --check` names the rule that an example breaks, and ends with 1 then."""
    kept = json.loads(cli("plugins", "--check", "correction.yastrebov", "--json").stdout)
    assert [(row["type"], row["verdict"]) for row in kept] == [("yastrebov", "keeps its contract")]
    (component,) = (entry.component for entry in registry().components["correction"].values())
    monkeypatch.setattr(component, "area", lambda self, contact, spacing: -1.0)
    broken = cli("plugins", "--check", "yastrebov", code=1).stdout
    assert "Yastrebov breaks the rule no_contact_has_no_area" in broken
    assert "'springs' is neither a type" in cli("plugins", "--check", "springs", code=2).stderr


def test_module_is_the_command(tmp_path: Path) -> None:
    """`python -m pellicle` is the command line, and its exit code reaches the shell."""
    command = [sys.executable, "-m", "pellicle", "run", "none.toml"]
    environment = os.environ | {"NO_COLOR": "1"}
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=tmp_path, env=environment, check=False
    )
    assert done.returncode == 2
    assert done.stderr.startswith("error: none.toml: ")
    assert done.stdout == ""


def test_a_folder_of_several_results_is_refused(cli: Cli) -> None:
    """`show` and `plot` of a folder take its one result file, and name several."""
    folder = Path("several")
    folder.mkdir()
    for name in ("b.h5", "a.h5"):
        (folder / name).touch()
    for command in ("show", "plot"):
        assert (
            "several: holds several result files; give one of them: a.h5, b.h5"
            in cli(command, "several", code=2).stderr
        )
