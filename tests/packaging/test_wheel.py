"""What is built from the checkout: nothing is left out, and nothing is put in beside it."""

import subprocess
import sys
import tarfile
import tomllib
from importlib import import_module
from inspect import get_annotations
from pathlib import Path
from zipfile import ZipFile

import pytest

from pellicle.components import Component

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
