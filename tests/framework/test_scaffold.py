"""Packages of plugins: names that can be used, and plain words for those that cannot."""

from importlib import import_module
from pathlib import Path

import pytest

from pellicle import ConfigError, StorageError
from pellicle.cli.new import write_plugin
from pellicle.components.installed import FAMILIES
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
