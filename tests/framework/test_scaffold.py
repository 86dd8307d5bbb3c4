"""What ``pellicle new`` writes: examples, and packages of plugins whose names can be used."""

import json
from importlib import import_module
from pathlib import Path

import pytest

import pellicle as pl
from pellicle import ConfigError, StorageError
from pellicle.cli.new import write_plugin
from pellicle.components.installed import FAMILIES
from pellicle.config.study import from_toml
from pellicle.plugins.registry import Registry
from tests.command import call


@pytest.mark.parametrize("family", [*FAMILIES, "effect", "reader"])
def test_writes_a_package(family: str, tmp_path: Path) -> None:
    """A name with a dash is a type, a module and a distribution, each in its own spelling."""
    folder = write_plugin(family, "graded-solid2", tmp_path)
    assert folder == tmp_path / "pellicle-graded-solid2"
    assert {path.name for path in folder.iterdir()} - {"curve.csv", "curve.dat"} == {
        "README.md",
        "graded_solid2.toml",
        "pellicle_graded_solid2.py",
        "pyproject.toml",
        "test_pellicle_graded_solid2.py",
    }
    code = (folder / "pellicle_graded_solid2.py").read_text(encoding="utf-8")
    assert "class GradedSolid2(" in code
    command = "fit" if family in ("effect", "reader") else "run"
    readme = (folder / "README.md").read_text(encoding="utf-8")
    assert f"$ pellicle {command} graded_solid2.toml" in readme
    assert 'type: Literal["graded_solid2"] = "graded_solid2"' in code
    entry = f'"{family}.graded_solid2" = "pellicle_graded_solid2:GradedSolid2"'
    assert entry in (folder / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "name",
    [
        "",
        "2d",
        "Graded",
        "a b",
        "a/b",
        "../up",
        "a.b",
        "a--b",
        "_a",
        "a-",
        "größe",
        "none",
        "class",
    ],
)
def test_name_that_is_none(name: str, tmp_path: Path) -> None:
    """What is no name of a component, a module and a class is refused; nothing is written."""
    with pytest.raises(ConfigError, match="cannot be the name of a component; give lower-case"):
        write_plugin("kernel", name, tmp_path)
    assert not list(tmp_path.iterdir())


def test_name_of_a_component_that_there_is(tmp_path: Path) -> None:
    """A type that is taken in the family, by whom it says; another family may have it."""
    with pytest.raises(ConfigError, match="kernel 'half_space' is there already, from pell"):
        write_plugin("kernel", "half-space", tmp_path)
    folder = write_plugin("indenter", "half-space", tmp_path)
    assert '"indenter.half_space" = ' in (folder / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.parametrize("is_package", [True, False])
def test_family_of_a_plugin(
    is_package: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its template is in the package of its base class; that there is none is said."""
    name = f"stranger_with_templates_{is_package}".lower()
    base = tmp_path / name / "__init__.py" if is_package else tmp_path / f"{name}.py"
    template = tmp_path / name / "templates" / "effect"
    template.mkdir(parents=True)
    for file in ("module", "test", "example"):
        (template / file).write_text(f"{file} of $class_name\n", encoding="utf-8")
    base.write_text(
        "from pellicle.components import Component\n"
        "class Effect(Component): family = 'effect'; place = 'effects[]'\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    families = {"effect": import_module(name).Effect}
    monkeypatch.setattr(
        "pellicle.components.installed.registry", lambda: Registry({"effect": {}}, families)
    )
    if is_package:
        folder = write_plugin("effect", "mine", tmp_path)
        assert (folder / "pellicle_mine.py").read_text(encoding="utf-8") == "module of Mine\n"
        return
    with pytest.raises(ConfigError, match=f"{name} has no template of the family 'effect'"):
        write_plugin("effect", "mine", tmp_path)


def test_folder_that_there_is(tmp_path: Path) -> None:
    """What is there is left alone."""
    kept = write_plugin("kernel", "graded", tmp_path) / "pellicle_graded.py"
    kept.write_text("mine")
    with pytest.raises(StorageError, match="pellicle-graded exists already; give another name"):
        write_plugin("indenter", "graded", tmp_path)
    assert kept.read_text() == "mine"


def test_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command says what to do next, and which argument is missing."""
    monkeypatch.chdir(tmp_path)
    done = call("new", "--plugin", "indenter", "tip")
    assert done.output.startswith("wrote pellicle-tip; next: cd pellicle-tip")
    assert (tmp_path / "pellicle-tip" / "pyproject.toml").is_file()
    done = call("new", "--plugin", "indenter", code=2)
    assert "NAME: is missing; for example: pellicle new --plugin indenter mine" in done.stderr


SMALLER = {
    "rough": ["grid.points=64", "indenter.cutoff_wavelength='125 um'"],
    "gel": ["grid.points=32"],
    "layer": ["grid.points=32"],
}


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", SMALLER)
def test_an_example_runs_as_it_is(name: str) -> None:
    """It is read without a change, and solved (on fewer cells here); every step converges."""
    done = call("new", "--example", name)
    assert done.output == f"wrote {name}.toml; next: pellicle run {name}.toml\n"
    assert isinstance(from_toml(f"{name}.toml"), pl.Study) is (name == "gel")
    smaller = [word for value in SMALLER[name] for word in ("--set", value)]
    call("run", f"{name}.toml", "--quiet", "--threads", "1", *smaller)
    assert list(Path(name).glob("*.h5"))
    assert list(Path(name).glob("*.csv"))


@pytest.mark.slow
def test_the_example_of_a_fit_finds_what_went_in() -> None:
    """The intervals contain the modulus and the tension with which the curve was made."""
    call("new", "--example", "fit", "mine.toml")
    fit = json.loads(call("fit", "mine.toml", "--json").output)
    for name, true in (("reduced_modulus", 2e3), ("tension", 5e-3), ("contact_point", 3e-6)):
        known = fit["parameters"][name]
        assert known["low"] < true < known["high"]
    assert fit["tension_needed"]


def test_an_example_replaces_no_file() -> None:
    """A file of that name stays as it is, and so does a curve; other examples do not exist."""
    Path("fit-curve.csv").write_text("mine", encoding="utf-8")
    assert "exists already" in call("new", "--example", "fit", code=2).output
    assert Path("fit-curve.csv").read_text(encoding="utf-8") == "mine"
    assert not Path("fit.toml").exists()
    told = "give one of fit, droplet, gel, indent, layer, rough"
    assert told in call("new", "--example", "soft", code=2).output
    both = call("new", "--example", "gel", "--plugin", "kernel", "x", code=2).output
    assert "exclude each other" in both
