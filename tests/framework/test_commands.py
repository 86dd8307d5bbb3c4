"""Commands of plugins that break, clash or are for others: each costs itself alone."""

import json
from collections.abc import Callable, Iterator
from functools import partial
from importlib.metadata import entry_points
from pathlib import Path

import pytest
import xarray as xr

from pellicle import results
from pellicle.plugins import commands
from pellicle.plugins.origins import GROUP
from tests import command
from tests.installed import entry_point

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


def test_of_two_claimants_none_is_used(install: Install) -> None:
    """Both are named, and one of them works when the other is switched off."""
    install()
    install(package="salutations")
    refusal = call("hello", code=2).stderr
    assert "claimed by greetings 1.5" in refusal
    assert "and by salutations 1.5" in refusal
    (clash,) = json.loads(call("plugins", "--json").stdout)["broken"]
    assert clash["origin"] == "greetings, salutations"


def test_a_command_of_a_name_of_ours_is_not_used(install: Install) -> None:
    """Or a plugin could take `run` away."""
    install(name="run")
    assert "FILE" in call("run", "--help").stdout
    (broken,) = json.loads(call("plugins", "--json").stdout)["broken"]
    assert broken["origin"] == "pellicle, greetings"
    assert "claimed by pellicle" in broken["error"]


def test_one_of_two_claimants_is_switched_off(
    install: Install, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one is then the command."""
    monkeypatch.setenv("PELLICLE_DISABLE_PLUGINS", "salutations")
    install()
    install("raise SystemExit", package="salutations")
    assert call("hello").stdout == "hello you\n"


def test_what_fails_in_a_command_names_its_plugin(install: Install) -> None:
    """It is no fault of pellicle."""
    install("def hello() -> None: 1 / 0")
    origin = "error: command 'hello' of greetings 1.5 (entry point 'command.hello') failed"
    assert call("hello", code=2).stderr == f"{origin}: ZeroDivisionError: division by zero\n"
