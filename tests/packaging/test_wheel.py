"""What is built from the checkout is whole, and what registries read says the same."""

import json
import re
import subprocess
import sys
import tarfile
import tomllib
from importlib import import_module
from inspect import get_annotations
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

from pellicle.components import Component
from tests import durations

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = (
    "framework/pellicle",
    "plugins/pellicle_axisymmetric",
    "plugins/pellicle_plugins",
    "plugins/pellicle_fit",
    "plugins/pellicle_check",
    "plugins/pellicle_explore",
)
DATA = {
    "pellicle/py.typed",
    "pellicle/plugins/applications.pyi",
    "pellicle_axisymmetric/layer_curves.npz",
    "pellicle_axisymmetric/punches.npz",
    "pellicle_axisymmetric/py.typed",
    "pellicle_check/py.typed",
    "pellicle_explore/py.typed",
    "pellicle_explore/start.toml",
    "pellicle_fit/__init__.pyi",
    "pellicle_fit/py.typed",
    "pellicle_plugins/py.typed",
} | {
    path.relative_to((ROOT / package).parent).as_posix()
    for package in PACKAGES
    for folder in ("examples", "templates", "report")
    for path in (ROOT / package / folder).rglob("*")
    if path.is_file() and path.suffix != ".py" and path.parent.name != "__pycache__"
}

pytestmark = pytest.mark.skipif(
    not (ROOT / "pyproject.toml").is_file(), reason="the tests do not run from a checkout"
)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the sdist, and the wheel that was built from it."""
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "build", "--no-isolation", f"--outdir={folder}", str(ROOT)]
    subprocess.run(command, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> set[str]:
    """Return the names of the files in the wheel."""
    (path,) = built.glob("*.whl")
    with ZipFile(path) as archive:
        return set(archive.namelist())


@pytest.fixture(scope="module")
def sdist(built: Path) -> set[str]:
    """Return the names of the files in the sdist, without its one folder."""
    (path,) = built.glob("*.tar.gz")
    with tarfile.open(path) as archive:
        return {name.partition("/")[2] for name in archive.getnames()}


def modules() -> set[str]:
    """Return every module of the checkout, as a wheel names it."""
    return {
        path.relative_to((ROOT / package).parent).as_posix()
        for package in PACKAGES
        for path in (ROOT / package).rglob("*.py")
    }


@pytest.mark.slow
def test_wheel_holds_every_module(wheel: set[str]) -> None:
    """Modules are not dropped by what git or the build ignores."""
    assert modules() - wheel == set()


@pytest.mark.slow
def test_wheel_holds_its_data(wheel: set[str]) -> None:
    """What is no module is installed too: starter file, templates, parts of a page, markers."""
    assert wheel >= DATA


@pytest.mark.slow
def test_wheel_installs_its_packages_and_nothing_else(wheel: set[str]) -> None:
    """Tests and docs do not land in a user's site-packages."""
    tops = {name.partition("/")[0] for name in wheel}
    assert {top for top in tops if not top.endswith(".dist-info")} == {
        Path(package).name for package in PACKAGES
    }


@pytest.mark.slow
def test_entry_points_lead_to_modules(wheel: set[str]) -> None:
    """Each entry point, and the command, names a module in the wheel."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    targets = [*project["entry-points"]["pellicle"].values(), *project["scripts"].values()]
    files = {target: target.partition(":")[0].replace(".", "/") + ".py" for target in targets}
    assert {target: file for target, file in files.items() if file not in wheel} == {}


def test_every_component_has_an_entry_point() -> None:
    """A class with a type of its own, or a module with a hook, is declared and not forgotten."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    made = set()
    for name in modules():
        if name.startswith("pellicle/"):
            continue
        module = name.removesuffix(".py").replace("/", ".")
        source = (ROOT / "plugins" / name).read_text(encoding="utf-8")
        if "@hookimpl" in source:
            made.add(module)
        if "    type: Literal[" not in source:
            continue
        for its in vars(import_module(module)).values():
            is_component = isinstance(its, type) and issubclass(its, Component)
            if is_component and its.__module__ == module and "type" in get_annotations(its):
                made.add(f"{module}:{its.__name__}")
    entries = project["entry-points"]["pellicle"].items()
    assert made == {target for name, target in entries if not name.startswith("command.")}


@pytest.mark.slow
def test_sdist_can_be_tested(sdist: set[str]) -> None:
    """A packager gets the sources, the tests with their data, and the licence."""
    assert {f"framework/{name}" for name in DATA if name.startswith("pellicle/")} <= sdist
    assert {f"framework/{name}" for name in modules() if name.startswith("pellicle/")} <= sdist
    tests = {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "tests").rglob("*.*")
        if path.suffix in {".py", ".csv", ".txt", ".toml", ".md"}
    }
    read_by_tests = {".ci/run", ".conda/recipe.yaml", ".github/workflows/tests.yml", "CITATION.cff"}
    assert tests | read_by_tests | {"LICENSE", "README.md", "pyproject.toml"} <= sdist


CONDA_NAMES = {"matplotlib": "matplotlib-base"}


@pytest.fixture(scope="module")
def project() -> dict[str, Any]:
    """Return the table ``project`` of pyproject.toml."""
    data = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    return dict(data["project"])


def text(name: str) -> str:
    """Return the content of a file of the repository."""
    return (ROOT / name).read_text(encoding="utf-8")


def test_versions_agree(project: dict[str, Any]) -> None:
    """The citation, codemeta.json and the conda recipe have the version of the package."""
    version = project["version"]
    assert re.search(rf"^version: {re.escape(version)}$", text("CITATION.cff"), re.MULTILINE)
    assert json.loads(text("codemeta.json"))["version"] == version
    assert f'  version: "{version}"\n' in text(".conda/recipe.yaml")


def test_keywords_licence_and_requirements_agree(project: dict[str, Any]) -> None:
    """Licence, keywords and requirements are those of the package."""
    meta = json.loads(text("codemeta.json"))
    assert meta["license"].endswith(f"/{project['license']}")
    assert f"\nlicense: {project['license']}\n" in text("CITATION.cff")
    assert {*project["keywords"]} <= {*meta["keywords"]}
    required = [re.match(r"[\w-]+", dependency) for dependency in project["dependencies"]]
    assert meta["softwareRequirements"] == [name[0] for name in required if name]


def test_conda_recipe_has_the_dependencies(project: dict[str, Any]) -> None:
    """The recipe runs with exactly what the package needs."""
    run = text(".conda/recipe.yaml").partition("  run:\n")[2].partition("\n\n")[0]
    recipe = {line.strip().removeprefix("- ").replace(" ", "") for line in run.splitlines()}
    expected = {f"python{project['requires-python']}"}
    for dependency in project["dependencies"]:
        name, limit = re.fullmatch(r"([\w-]+)(.*)", dependency).groups()  # type: ignore[union-attr]
        expected.add(CONDA_NAMES.get(name, name) + limit)
    assert recipe == expected


def test_all_packages_are_imported_by_the_recipe() -> None:
    """The recipe tries each package of the wheel."""
    targets = tomllib.loads(text("pyproject.toml"))["tool"]["hatch"]["build"]["targets"]
    packages = [Path(package).name for package in targets["wheel"]["packages"]]
    assert f"imports: [{', '.join(packages)}]" in text(".conda/recipe.yaml")


def test_workflows_do_what_the_script_does(project: dict[str, Any]) -> None:
    """All that lands runs ``.ci/run``, and the README's tests on each Python that is announced."""
    workflow = text(".github/workflows/tests.yml")
    assert "- run: bash .ci/run\n" in workflow
    pythons = re.findall(r"Python :: (3\.\d+)", "\n".join(project["classifiers"]))
    assert f"python: {json.dumps(pythons)}\n" in workflow
    (command,) = re.findall(r"python -m pytest .*", text("README.md"))
    assert f"- run: {command}\n" in workflow


def test_stored_durations_are_of_files_that_exist() -> None:
    """A file that is renamed keeps its durations, or they are stored anew."""
    files = {test.partition("::")[0] for test in durations.stored()}
    assert len(files) > 9
    assert [name for name in sorted(files) if not (ROOT / name).exists()] == []


def test_a_test_that_has_moved_keeps_its_duration() -> None:
    """A row is found by the name of the test if no row has its file too."""
    rows = {"tests/a.py::test_x": 0.01, "tests/b.py::test_y": 0.2}
    functions = ["tests/a.py::test_x", "tests/new/c.py::test_y", "tests/a.py::test_z"]
    assert durations.with_moved(rows, functions) == dict(
        zip(functions, rows.values(), strict=False)
    )
