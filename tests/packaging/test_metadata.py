"""Files that registries and journals read say the same as the package."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from tests import durations

ROOT = Path(__file__).resolve().parents[2]
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
