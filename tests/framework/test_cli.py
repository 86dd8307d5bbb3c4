"""The command line, from a starter file to figures; commands of plugins that break or clash."""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import entry_points
from pathlib import Path

import pytest
import xarray as xr

import pellicle as pl
from pellicle import results
from pellicle.components.installed import registry
from pellicle.plugins import commands
from pellicle.plugins.origins import GROUP
from tests import command
from tests.command import Cli
from tests.installed import entry_point
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
    says = "several: holds several result files; give one of them: a.h5, b.h5"
    assert says in cli("show", "several", code=2).stderr
    assert says in cli("plot", "several", code=2).stderr


HELLO = '''
from pathlib import Path
import pellicle as pl
from pellicle.cli import echo

def hello(name: str = "you") -> None:
    """Greet someone."""
    echo(f"hello {name}")
'''


def registers(arguments: str) -> str:
    """Return a hook that registers a command."""
    return f"@pl.hookimpl\ndef register_commands(register):\n    register({arguments})\n"


BROKEN = {
    "error at import": ("1 / 0", "ZeroDivisionError: division by zero"),
    "exit at import": ("raise SystemExit(0)", "SystemExit: 0"),
    "no function": ("hello = 3", "3 is neither a function nor a module with hooks"),
    "none": ("@pl.hookimpl\ndef register_commands(register): ...", "registers 0 commands"),
    "no such function": ("del hello", "AttributeError: module"),
    "[brackets] in the error": ("raise ValueError('[/x]')", "ValueError: [/x]"),
}
"""What follows `HELLO`, and what is said."""
UNREADABLE = "hello.__annotations__['name'] = int | bytes"
NO_MODEL = registers("hello, file='nothing.there:Model'")
Install = Callable[..., None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Return a function that installs ``hello`` of a package beside the commands that there are."""
    entries = {*entry_points(group=GROUP)}
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("pellicle.plugins.commands.entry_points", lambda group: entries)
    monkeypatch.chdir(tmp_path)

    def write(more: str = "", name: str = "hello", package: str = "greetings") -> None:
        module = f"{package}_{tmp_path.name.replace('-', '_')}"
        (tmp_path / f"{module}.py").write_text(f"{HELLO}\n{more}\n", encoding="utf-8")
        named = module if "register_commands" in more else f"{module}:hello"
        entries.add(entry_point(f"command.{name}", named, package, "1.5"))
        forget()

    def forget() -> None:
        commands.commands.cache_clear()
        commands.load_command.cache_clear()

    yield write
    monkeypatch.undo()
    forget()


call = partial(command.call, COLUMNS="200")


def test_a_function_is_a_command(install: Install) -> None:
    """Its parameters are options, and what is wrong with them is told by typer."""
    install()
    assert call("hello", "--name", "Ada").stdout == "hello Ada\n"
    assert "--name NAME" in " ".join(call("hello", "--help").stdout.split())
    assert "No such option: --nome" in call("hello", "--nome", code=2).stderr


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_command_costs_itself_alone(case: str, install: Install) -> None:
    """It says its error in the help, in the list of plugins and when it is called."""
    more, reason = BROKEN[case]
    install(more)
    assert f"broken: {reason.partition(':')[0]}" in call("--help").stdout
    (broken,) = json.loads(call("plugins", "--json").stdout)["broken"]
    assert broken["entry_point"] == "command.hello"
    assert reason in broken["error"]
    for words in (["hello"], ["hello", "--name", "Ada"], ["hello", "--help"]):
        (line,) = call(*words, code=2).stderr.splitlines()
        assert line.startswith("error: command 'hello' is broken: greetings 1.5 (entry point")
        assert reason in line
    assert "Usage" in call("run", "--help").stdout


def test_parameters_that_typer_cannot_read_break_a_command(install: Install) -> None:
    """They are read when it is called, so the help still lists it."""
    install(UNREADABLE)
    assert "Greet someone" in call("--help").stdout
    assert "error: command 'hello' is broken" in call("hello", code=2).stderr
    (broken,) = json.loads(call("plugins", "--json").stdout)["broken"]
    assert broken["entry_point"] == "command.hello"


def test_a_model_that_is_missing_breaks_what_asks_for_it(install: Install) -> None:
    """The command runs; explain and schema of it say why they cannot, and those of others do."""
    install(NO_MODEL)
    assert call("hello").stdout == "hello you\n"
    for asked in ("explain", "schema"):
        refusal = call(asked, "hello", code=2).stderr
        assert "file 'nothing.there:Model': ModuleNotFoundError" in refusal
        assert call(asked, "run").stdout
    (broken,) = json.loads(call("plugins", "--json").stdout)["broken"]
    assert broken["entry_point"] == "command.hello"
    Path("a.toml").write_text("kernel = 1\nnonsense = 2\n", encoding="utf-8")
    assert "nonsense: is not a field here" in call("run", "a.toml", code=2).stderr


WRITTEN = """
class Table:
    def __init__(self, path):
        self.path = path
    def show(self, *, si, json):
        echo(f"{self.path.name}, {si}, {json}")
    def plot(self, directory, formats):
        return [directory / f"a.{format}" for format in formats]
"""


def test_what_a_command_wrote_is_shown(install: Install) -> None:
    """The command shows and draws its table; where it cannot, that is told as before."""
    columns = xr.Dataset({"a": ("x", [1.0])})
    for name in ("hello", "nobody"):
        attributes = {"command": name, "configuration": "{}", "versions": ""}
        results.write(columns.assign_attrs(attributes), Path(name) / "table.h5")
    install(WRITTEN + registers("hello, written=f'{__name__}:Table'"))
    assert call("show", "hello", "--si").stdout == "table.h5, True, False\n"
    drawn = call("plot", "hello/table.h5", "--format", "svg", "--format", "pdf").stdout
    assert drawn.splitlines() == [f"wrote {Path('hello') / name}" for name in ("a.svg", "a.pdf")]
    for word in ("show", "plot"):
        assert "a table that pellicle nobody wrote" in call(word, "nobody", code=2).stderr


@pytest.mark.parametrize("more", ["del Table.show", "Table.__init__ = None", "del Table"])
def test_a_command_that_cannot_show_what_it_wrote_is_named(install: Install, more: str) -> None:
    """It is no fault of pellicle."""
    attributes = {"command": "hello", "configuration": "{}", "versions": ""}
    results.write(xr.Dataset({"a": ("x", [1.0])}, attrs=attributes), Path("table.h5"))
    install(f"{WRITTEN}{more}\n" + registers("hello, written=f'{__name__}:Table'"))
    assert "error: command 'hello' of greetings 1.5" in call("show", "table.h5", code=2).stderr


def test_of_two_claimants_none_is_used(install: Install, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both are named, and one of them works when the other is switched off; ours stays in use."""
    install(name="run")
    assert "FILE" in call("run", "--help").stdout
    install()
    install("raise SystemExit", package="salutations")
    refusal = call("hello", code=2).stderr
    assert "claimed by greetings 1.5" in refusal
    assert "and by salutations 1.5" in refusal
    broken = json.loads(call("plugins", "--json").stdout)["broken"]
    clashes = {entry["origin"]: entry["error"] for entry in broken}
    assert clashes.keys() == {"greetings, salutations", "pellicle, greetings"}
    assert "claimed by pellicle" in clashes["pellicle, greetings"]
    monkeypatch.setenv("PELLICLE_DISABLE_PLUGINS", "salutations")
    install(name="other")
    assert call("hello").stdout == "hello you\n"


def test_what_fails_in_a_command_names_its_plugin(install: Install) -> None:
    """It is no fault of pellicle."""
    install("def hello() -> None: 1 / 0")
    origin = "error: command 'hello' of greetings 1.5 (entry point 'command.hello') failed"
    assert call("hello", code=2).stderr == f"{origin}: ZeroDivisionError: division by zero\n"
