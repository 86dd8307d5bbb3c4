"""What the commands print: words and units, within the terminal, for programs too."""

import errno
import io
import json
import os
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from jsonschema import Draft202012Validator
from rich.cells import cell_len

import pellicle as pl
from pellicle.cli import new
from pellicle.cli.app import app
from pellicle.cli.printing import BAD_INPUT, CRASHED, print_table
from pellicle.components import Case, Column, Table
from pellicle.config.explain import explanations
from pellicle.results.wording import has_meaning
from pellicle.runs.validation import CheckedCase
from pellicle.show.sentences import outcome_of_cases
from pellicle.show.tables import verdicts
from pellicle_fit.config import FitConfig
from tests.command import Cli, call
from tests.tables_of_runs import paraboloid, pressing, tensed

RUN: dict[str, Any] = pressing(
    16, "0.4 mm", tensed("10 kPa", "30 mN/m"), paraboloid("1 mm"), depth=["10 um", "20 um"]
) | {"title": "Δ layer", "corrections": [{"type": "yastrebov"}], "outputs": []}
STUDY = """
grid = { points = 32, size = "0.4 mm" }
kernel = { type = "tensed_membrane", reduced_modulus = "10 kPa" }
indenter = { type = "paraboloid", radius = "1 mm" }
loading = { depth = ["10 um", "20 um"] }
study.vary = { "kernel.tension" = ["30 mN/m", "0.3 N/m"] }
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a run and a study, solved."""
    folder = tmp_path_factory.mktemp("terminal")
    pl.run(RUN, progress=False, threads=1).save(folder / "a.h5")
    study = {**RUN, "study": {"vary": {"kernel.tension": ["30 mN/m", "0.3 N/m"]}}}
    pl.run_study(study, folder / "study", progress=False, threads=1)
    return folder


@pytest.fixture
def cli(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Cli:
    """Return `call` in the folder."""
    monkeypatch.chdir(folder)
    return call


def test_a_table_in_a_pipe_has_a_line_for_each_row(capsys: pytest.CaptureFixture[str]) -> None:
    """It is neither folded nor cut, however long its cells are; heads and numbers are aligned."""
    numbers = Column("depth", [1e-5, np.nan], "m")
    print_table(Table([Column("step", [1, 12]), numbers, Column("why", ["so " * 200, "no"])]))
    first, second, third = capsys.readouterr().out.splitlines()
    assert first == "step  depth [µm]  why"
    assert second == f"   1          10  {('so ' * 200).strip()}"
    assert third == "  12           –  no"


@pytest.mark.parametrize("width", [80, 40])
@pytest.mark.parametrize(
    "words",
    [
        ["show", "a.h5"],
        ["show", "study"],
        ["plugins"],
        ["explain", "layered"],
        ["explain"],
        ["check", "check.toml"],
        ["run", "check.toml", "--dry-run"],
    ],
)
def test_commands_fit_the_terminal(cli: Cli, words: list[str], width: int) -> None:
    """No table runs over the edge of a terminal of 80 columns or of 40; sentences are broken."""
    Path("check.toml").write_text(STUDY, encoding="utf-8")
    shown = cli(*words, FORCE_COLOR="1", NO_COLOR="1", COLUMNS=str(width)).stdout
    rows = [line for line in shown.splitlines() if "  " in line]
    assert max(map(cell_len, rows), default=0) <= width
    assert "\x1b" not in shown


def test_json_has_the_numbers_of_the_file(cli: Cli, folder: Path) -> None:
    """`show --json` prints every number of a step in SI, and what is not a number as null."""
    shown = json.loads(cli("show", "a.h5", "--json").stdout)
    data = pl.load(folder / "a.h5").dataset
    assert shown["title"] == "Δ layer"
    assert shown["converged"] is True
    assert [step["force"] for step in shown["steps"]] == data["force"].values.tolist()
    assert shown["units"]["contact_area_yastrebov"] == "m2"
    runs = json.loads(cli("show", "study", "--json").stdout)["runs"]
    assert [run["parameters"]["kernel.tension"] for run in runs] == [0.03, 0.3]
    assert all(run["converged"] and len(run["steps"]) == 2 for run in runs)
    assert (folder / "study" / runs[0]["file"]).exists()


@pytest.mark.slow
def test_a_run_called_study_is_a_run(cli: Cli) -> None:
    """The result of study.toml has the name of a study's table, and is shown and drawn as it is."""
    Path("study.toml").write_text(pl.Run(**RUN).to_toml(), encoding="utf-8")
    cli("run", "study.toml", "-o", "named", "--quiet", "--threads", "1")
    for results in ("named", "named/study.h5"):
        assert "Δ layer" in cli("show", results).stdout
        drawn = cli("plot", results, "-o", "drawn").stdout
        assert str(Path("drawn/study-pressure.png")) in drawn


@pytest.mark.parametrize(
    "command",
    [
        ["show", "{long}"],
        ["plot", "{long}"],
        ["run", "{run}", "--set", "indenter={ type='heights', unit='m', path='{long}' }"],
    ],
    ids=lambda command: command[0],
)
def test_a_path_that_no_system_takes_is_told(command: list[str], folder: Path, cli: Cli) -> None:
    """As one in a folder that is closed to the user; neither is a fault of pellicle."""
    (folder / "plain.toml").write_text(pl.Run(**RUN).to_toml(), encoding="utf-8")
    words = [word.replace("{long}", "a" * 5000).replace("{run}", "plain.toml") for word in command]
    assert "aaa: no such file; give " in cli(*words, code=2).stderr


class Refusing(io.StringIO):
    """A stream that cannot be written to."""

    def __init__(self, error: OSError) -> None:
        super().__init__()
        self.error = error

    def write(self, text: str) -> int:
        raise self.error


FULL = OSError(errno.ENOSPC, "No space left on device")
UNREAD = BrokenPipeError(errno.EPIPE, "Broken pipe")


@pytest.mark.parametrize("json", [[], ["--json"]], ids=["table", "json"])
@pytest.mark.parametrize(
    ("error", "message"),
    [(FULL, f"error: standard output cannot be written ({FULL.strerror})\n"), (UNREAD, "")],
    ids=["full", "unread"],
)
def test_what_cannot_be_printed_is_neither_a_fault_nor_a_verdict(
    folder: Path,
    error: OSError,
    message: str,
    json: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A full disk is told in a line; `show | head` has not the code of steps that failed."""
    monkeypatch.setattr(sys, "stdout", Refusing(error))
    with pytest.raises(SystemExit) as ended:
        app(["show", str(folder / "a.h5"), *json], prog_name="pellicle")
    assert ended.value.code == BAD_INPUT
    assert capsys.readouterr().err == message


def test_validate_ends_with_what_it_covers() -> None:
    """A sentence counts the cases and names the kernels that none is about; powers are units."""
    case = Case("a", {"kernel": {"type": "winkler"}}, lambda _: 0.0, 2e-7, "m²", 1e-3, "Hertz 1882")
    good, wrong = CheckedCase(case, 2e-7, True), CheckedCase(case, 3e-7, True)
    assert verdicts([good, wrong]).records[1]["computed"] == "0.3 mm²"
    others = "; no case is about the kernels coated, layered"
    kernels = "layered", "winkler", "coated"
    assert outcome_of_cases([good, wrong], kernels) == f"1 of 2 cases failed{others}"
    assert outcome_of_cases([good], kernels) == f"all 1 cases passed{others}"


def test_a_fault_of_pellicle_has_an_exit_code_of_its_own(
    cli: Cli, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A traceback does not end with 1, which means that steps or curves failed."""

    def broken(*_: object) -> None:
        raise RuntimeError("lost")

    monkeypatch.setattr(new, "_write_example", broken)
    done = cli("new", "x.toml", code=CRASHED)
    assert "RuntimeError: lost" in done.stderr
    assert "please report" in done.stderr
    assert done.stdout == ""


@pytest.mark.slow
def test_fit_tells_failed_curves_from_unusable_input(cli: Cli, folder: Path) -> None:
    """1: some curves could not be fitted; 2: nothing could be read; ``--quiet`` prints why only."""
    depth = np.linspace(-0.5, 1.5, 60)
    force = 4 / 3 * 2.0 * np.sqrt(5) * np.maximum(depth, 0) ** 1.5
    rows = np.column_stack([depth, force + 0.01 * np.sin(40 * depth)])
    for name in ("one", "two"):
        header = "position [um],force [nN]"
        np.savetxt(folder / f"{name}.csv", rows, delimiter=",", header=header, comments="")
    (folder / "bad.csv").write_text("position [um],force [V]\n1,2\n", encoding="utf-8")
    options = ["-i", "paraboloid", "--radius", "5 um", "--fix", "tension=0", "--quiet"]
    done = cli("fit", "one.csv", "bad.csv", *options, code=1)
    assert done.stdout == ""
    assert "bad.csv: has 'position [um]', 'force [V]'; missing: the unit of force" in done.stderr
    assert "1 of 2 curves could not be fitted" in done.stderr
    assert cli("fit", "one.csv", "two.csv", *options).stdout == ""
    assert "no such" in cli("fit", "missing.csv", *options, code=2).stderr.lower()


_SESSION = """
import json, sys
from pellicle.cli.app import app
for words in json.loads(sys.argv[1]):
    print("$", *words)
    try:
        app(words, prog_name="pellicle")
    except SystemExit as stop:
        assert stop.code == 0, (words, stop.code)
"""
_WORDS = [
    *("plugins", "explain tensed_membrane", "check c.toml", "run b.toml --dry-run"),
    *("show a.h5", "show study", "plot a.h5 -o drawn"),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("encoding", "others", "signs"),
    [
        (
            "ascii",
            ["new --example fit", "fit fit.toml --details"],
            ["depth [?m]", "[mm?]", "title:    ? layer", "?AIC", "taken as exact"],
        ),
        (
            "cp1252",
            ["new new.toml", "run b.toml -o c"],
            ["depth [µm]", "[mm²]", "title:    ? layer", "wrote c"],
        ),
    ],
)
def test_a_process_prints_in_the_code_page_of_its_environment(
    encoding: str, others: list[str], signs: list[str], folder: Path
) -> None:
    """`PYTHONIOENCODING`, NO_COLOR and 80 columns are followed by the whole program."""
    (folder / "b.toml").write_text(pl.Run(**RUN).to_toml(), encoding="utf-8")
    (folder / "c.toml").write_text(STUDY, encoding="utf-8")
    environment = {
        **os.environ,
        "PYTHONIOENCODING": encoding,
        "NO_COLOR": "1",
        "FORCE_COLOR": "1",
        "COLUMNS": "80",
    }
    commands = [line.split() for line in _WORDS + others]
    done = subprocess.run(
        [sys.executable, "-c", _SESSION, json.dumps(commands)],
        cwd=folder,
        env=environment,
        capture_output=True,
        check=False,
    )
    message = done.stderr.decode(encoding)
    assert done.returncode == 0, message
    shown = done.stdout.decode(encoding)
    for sign in signs:
        assert sign in shown
    assert "\x1b" not in shown
    assert "Traceback" not in message
    # A row of a table has two spaces between its cells; sentences are broken by the terminal.
    wide = [line for line in shown.splitlines() if len(line) > 80]
    assert not [line for line in wide if "  " in line]


def test_explain_has_an_example_for_a_file(cli: Cli) -> None:
    """It lists tables and families with their types; of each the example fits into a file."""
    schema = Draft202012Validator(pl.json_schema())
    words = json.loads(cli("explain", "--json").stdout)
    assert [*words] == ["table", *pl.registry().components]
    assert words["table"].pop() == "fit"
    for family, types in words.items():
        for type_ in types:
            (explained,) = explanations(type_ if family == "table" else f"{family}.{type_}", {})
            table = tomllib.loads(explained.example)
            if family == "effect":
                assert FitConfig(indenter={"type": "cone"}, **table).rivals
            else:
                schema.validate({"study": {}} | table)
    (fit,) = json.loads(cli("explain", "fit", "--json").stdout)
    assert FitConfig(**tomllib.loads(fit["example"])).indenter


def test_the_unit_of_heights_is_a_unit() -> None:
    """A unit is one of it; a number before it still counts."""
    for unit, metres in (("um", 1e-6), ("nm", 1e-9), ("2 um", 2e-6), (1e-3, 1e-3)):
        assert pl.indenter("heights", values=np.eye(4), unit=unit).model_dump()["unit"] == metres
    with pytest.raises(pl.ConfigError, match="is no unit of"):
        pl.indenter("heights", values=np.eye(4), unit="nN")


def test_explain_knows_what_was_meant(cli: Cli) -> None:
    """A type may be written with spaces or hyphens; of another word the nearest is named."""
    assert "half_space (kernel, from pellicle" in cli("explain", "half-space").stdout
    assert "E* [Pa]" in cli("explain", "kernel.half_space").stdout
    assert "tensed_membrane" in cli("explain", "kernels").stdout


def test_show_leaves_out_what_means_nothing() -> None:
    """A round contact has a radius and no axes, one in several parts neither radius nor ellipse."""
    patches, minor = {"round": 1, "long": 1, "rough": 3}, {"round": 2.0, "long": 1.0, "rough": 1.0}
    names = "contact_radius", "semi_major_axis", "major_axis_angle"
    shown = {"round": names[:1], "long": names, "rough": ()}
    for shape, expected in shown.items():
        axes = {"semi_major_axis": 2.0, "semi_minor_axis": minor[shape], "patches": patches[shape]}
        data = xr.Dataset(axes, attrs={"boundary": "periodic"})
        assert tuple(name for name in names if has_meaning(data, name)) == expected
